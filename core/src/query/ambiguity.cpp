#include "voxshell/ambiguity.h"

#include <variant>

namespace voxshell {

bool is_ambiguous(const Contact& contact, const Field& field, const Pose& field_from_shell) {
  constexpr double kStep = 0.4;       // depths, straight in
  constexpr double kLost = 0.5;       // steps: where the middle is nearer than a quarter of one
  constexpr double kRounding = 1e-6;  // of the place's coordinates
  const auto depth = static_cast<double>(contact.depth);
  if (!(depth > 0.0)) return false;
  const Vec3 place = field_from_shell.transform_point(static_cast<Vec3>(contact.point));
  const Vec3 outwards = field_from_shell.rotate(static_cast<Vec3>(contact.normal));
  const double step = kStep * depth;
  const double least = depth - kLost * step - kRounding * length(place);
  return std::visit(
      [&](const auto& typed) {
        const auto further = static_cast<Vec3f>(place - step * outwards);
        return -static_cast<double>(typed.distance(further)) < least;
      },
      field);
}

}  // namespace voxshell
