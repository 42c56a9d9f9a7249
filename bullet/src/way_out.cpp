#include "way_out.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "contact_constants.h"
#include "core_segment.h"
#include "voxshell/bullet/convert.h"
#include "voxshell/contacts.h"

namespace voxshell::bullet {
namespace {

/// A pair's overlap as its two bodies are displaced along each other.
class Overlap {
 public:
  Overlap(const PosedPair& pair, float tolerance)
      : pair_(pair), tolerance_(tolerance), field_from_shell_(pair.field_from_shell()) {}

  /// No displacement of less than this ends it, meters; 0 where nothing is known.
  double least_displacement() const {
    double least = 0.0;
    look(field_from_shell_, [&](const Participant& body, const Field& field, const Pose& pose) {
      const auto inner = find_inner_contact(body, field, pose, -tolerance_);
      if (inner) least = std::max(least, static_cast<double>(inner->depth));
      return false;
    });
    return least;
  }

  /// Whether the bodies overlap after the shell's is moved by a displacement of its own frame.
  bool is_there_after(const Vec3& displacement) const {
    Pose moved = field_from_shell_;
    moved.translation += field_from_shell_.rotate(displacement);
    const auto overlaps = [&](const Participant& body, const Field& field, const Pose& pose) {
      return collides(field, *body.shell, pose, -tolerance_) ||
             find_inner_contact(body, field, pose, -tolerance_).has_value();
    };
    return look(moved, overlaps) ||
           find_piercing(pair_, moved, static_cast<double>(tolerance_)).has_value();
  }

 private:
  /// Looks at each model in the other body's field, until `visit` returns true.
  template <class Visit>
  bool look(const Pose& field_from_shell, const Visit& visit) const {
    return visit(pair_.shell_side().participant(), pair_.field(), field_from_shell) ||
           (pair_.field_side().model() != nullptr &&
            visit(pair_.field_side().participant(), pair_.second_field(),
                  field_from_shell.inverse()));
  }

  const PosedPair& pair_;
  float tolerance_;
  Pose field_from_shell_;
};

/// Appends those of the 26 directions along a body's axes, the diagonals of its faces and of its
/// box that are not there yet.
void append_directions(const Pose& shell_from_body, std::vector<Vec3>& directions) {
  constexpr std::array kSigns{-1.0, 0.0, 1.0};
  for (const double x : kSigns) {
    for (const double y : kSigns) {
      for (const double z : kSigns) {
        const Vec3 direction = normalized(shell_from_body.rotate({x, y, z}));
        const bool is_there = std::ranges::any_of(
            directions, [&](const Vec3& other) { return dot(direction, other) > kSameWayOut; });
        if (!is_there && direction != Vec3{}) directions.push_back(direction);
      }
    }
  }
}

}  // namespace

std::optional<WayOut> find_way_out(const PosedPair& pair, double tolerance) {
  const Overlap overlap(pair, static_cast<float>(tolerance));
  if (!overlap.is_there_after({})) return std::nullopt;
  const Pose shell_from_world = pair.shell_side().world_from_geometry().inverse();
  const Ball of_shell = pair.shell_side().bounding_ball();
  const Ball of_field = pair.field_side().bounding_ball();
  const Vec3 between = shell_from_world.rotate(of_shell.center - of_field.center);
  std::vector<Vec3> directions;
  if (length(between) > tolerance) directions.push_back(normalized(between));
  for (const Side* side : {&pair.shell_side(), &pair.field_side()}) {
    append_directions(shell_from_world * from_bullet(side->wrap().getWorldTransform()), directions);
  }
  // Then the balls are apart.
  const double farthest = of_shell.radius + of_field.radius + length(between);
  double inside = overlap.least_displacement();
  double distance = std::max(inside, tolerance);
  while (inside < farthest) {
    distance *= kWayOutGrowth;
    for (const Vec3& direction : directions) {
      if (overlap.is_there_after(distance * direction)) continue;
      while (distance - inside > tolerance) {
        const double middle = 0.5 * (inside + distance);
        (overlap.is_there_after(middle * direction) ? inside : distance) = middle;
      }
      return WayOut{direction, distance};
    }
    inside = distance;
  }
  return std::nullopt;
}

}  // namespace voxshell::bullet
