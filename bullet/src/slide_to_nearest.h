#pragma once

#include <limits>
#include <optional>

#include "contact_constants.h"
#include "face_field.h"
#include "find_zero.h"
#include "round_side.h"

namespace voxshell::bullet {

/// Slides a place of a round surface to where the other body is nearest, along lines on which that
/// comes nearer. Beside an edge the field has another normal at each place, and turning toward it,
/// as face_field() does, leads to and fro. The surface's frame.
template <class Nearest, class Feel>
class SlideToNearest {
 public:
  /// @param nearest  The place of the surface that is nearest to a point, near another place of it;
  /// or none.
  /// @param feel     What the field says of a point, as a Facing.
  /// @param radius   Of the smaller body, meters.
  /// @param within   Sine by which the normals of the two may miss each other there.
  SlideToNearest(double radius, double within, const Nearest& nearest, const Feel& feel)
      : within_(within),
        first_step_(within * radius),
        least_curvature_(kFlatBend / radius),
        nearest_(nearest),
        feel_(feel) {}

  /// Moves the place. Its own normal is what the two have in common there. None where there is no
  /// such place near by.
  std::optional<Facing> slide(RoundSide::Place& place) const {
    for (int i = 0; i < kMostSlides; ++i) {
      const Facing there = feel_(place.position);
      if (there.outwards == Vec3{}) return std::nullopt;
      const Vec3 lean = there.outwards - dot(there.outwards, place.normal) * place.normal;
      bool is_there = squared_length(lean) <= within_ * within_;
      if (!is_there) {
        const auto ends = slide_along(-normalized(lean), place);
        if (!ends) return std::nullopt;
        is_there = *ends;
      }
      if (is_there) return Facing{place.position, -place.normal, feel_(place.position).distance};
    }
    return std::nullopt;
  }

 private:
  /// To where the field's normal does not lean, or turns over, as beside an edge and where coarse
  /// cells of a field meet. Whether it turns over; none where it does neither.
  std::optional<bool> slide_along(const Vec3& along, RoundSide::Place& place) const {
    const Vec3 start = place.position;
    double nearer = 0.0;
    double farther = std::numeric_limits<double>::infinity();
    const auto turns_over = [&] { return farther - nearer <= within_ * first_step_; };
    const auto zero = find_zero(
        [&](double way) -> std::optional<double> {
          const auto there = nearest_(start + way * along, place);
          if (!there) return std::nullopt;
          place = *there;
          const Vec3 tangent = normalized(along - dot(along, place.normal) * place.normal);
          const double leans = dot(feel_(place.position).outwards, tangent);
          (leans < 0.0 ? nearer : farther) = way;
          if (turns_over()) return std::nullopt;
          return leans;
        },
        first_step_, least_curvature_, 0.5 * within_);
    if (zero) return false;
    if (turns_over()) return true;
    return std::nullopt;
  }

  double within_;
  double first_step_;
  double least_curvature_;  ///< 1/meters
  const Nearest& nearest_;
  const Feel& feel_;
};

}  // namespace voxshell::bullet
