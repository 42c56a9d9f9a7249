#include "core_segment.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <variant>

#include "contact_constants.h"
#include "hull.h"
#include "shape_features.h"

namespace voxshell::bullet {
namespace {

CoreSegment along_axis(double half_length, double radius) {
  const double half = std::max(half_length - radius, 0.0);
  return {{0, 0, -half}, {0, 0, half}, radius};
}

CoreSegment along_longest_side(const Vec3& half) {
  const double radius = std::min({half.x, half.y, half.z});
  const double longest = std::max({half.x, half.y, half.z});
  const auto end = [&](double side) { return side == longest ? side - radius : 0.0; };
  const Vec3 to = half.x == longest   ? Vec3{end(half.x), 0, 0}
                  : half.y == longest ? Vec3{0, end(half.y), 0}
                                      : Vec3{0, 0, end(half.z)};
  return {-to, to, radius};
}

CoreSegment between_corners(const Hull& hull) {
  const auto farthest_from = [&](const Vec3& place) {
    return *std::ranges::max_element(
        hull.corners(), {}, [&](const Vec3& corner) { return squared_length(corner - place); });
  };
  const Vec3 from = farthest_from(hull.middle());
  return {from, farthest_from(from), 0.0};
}

/// The deepest place of a segment in a field, by halves that the field's bound leaves.
class Deepest {
 public:
  Deepest(const GridField& field, const Vec3& from, const Vec3& to, double least_depth)
      : field_(field), from_(from), to_(to), length_(length(to - from)), least_(-least_depth) {}

  void look(double begin, double end) {
    const double middle = 0.5 * (begin + end);
    const auto place = static_cast<Vec3f>(from_ + middle * (to_ - from_));
    const double radius = 0.5 * (end - begin) * length_;
    if (!(static_cast<double>(field_.lower_bound(place, static_cast<float>(radius))) < least_)) {
      return;
    }
    const auto distance = static_cast<double>(field_.distance(place));
    if (distance < least_) {
      least_ = distance;
      place_ = place;
    }
    if (end - begin < kCorePrecision) return;
    look(begin, middle);
    look(middle, end);
  }
  double distance() const { return least_; }
  const std::optional<Vec3f>& place() const { return place_; }

 private:
  const GridField& field_;
  Vec3 from_;
  Vec3 to_;
  double length_;
  double least_;
  std::optional<Vec3f> place_;
};

}  // namespace

std::optional<CoreSegment> core_segment_of(const Side& side) {
  const Field* const field = side.participant().field;
  if (side.model() != nullptr || field == nullptr) return std::nullopt;
  if (side.hull() != nullptr) return between_corners(*side.hull());
  return std::visit(
      [&](const auto& typed) -> std::optional<CoreSegment> {
        using T = std::decay_t<decltype(typed)>;
        if constexpr (std::is_same_v<T, BoxField>) {
          return along_longest_side(typed.half_extents);
        } else if constexpr (std::is_same_v<T, CapsuleField>) {
          return CoreSegment{{0, 0, -0.5 * typed.length}, {0, 0, 0.5 * typed.length}, typed.radius};
        } else if constexpr (std::is_same_v<T, CylinderField>) {
          return along_axis(0.5 * typed.length, typed.radius);
        } else if constexpr (std::is_same_v<T, ConeField>) {
          return along_axis(0.5 * typed.height, 0.0);
        } else {
          return std::nullopt;
        }
      },
      *field);
}

std::optional<Contact> find_piercing(const PosedPair& pair, const Pose& field_from_shell,
                                     double tolerance) {
  const Model* const model = pair.shell_side().model();
  if (model == nullptr) return std::nullopt;
  const auto core = core_segment_of(pair.field_side());
  if (!core) return std::nullopt;
  const Pose model_from_shape = field_from_shell.inverse();
  const GridField& field = model->grid();
  Deepest deepest(field, model_from_shape.transform_point(core->from),
                  model_from_shape.transform_point(core->to), tolerance);
  deepest.look(0.0, 1.0);
  if (!deepest.place()) return std::nullopt;
  const Vec3f outwards = normalized(field.gradient(*deepest.place()));
  return contact_of({static_cast<Vec3>(*deepest.place()), core->radius}, 0, outwards,
                    core->radius - deepest.distance());
}

}  // namespace voxshell::bullet
