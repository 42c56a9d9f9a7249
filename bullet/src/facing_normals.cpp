#include "facing_normals.h"

#include <cmath>
#include <variant>

namespace voxshell::bullet {

void face_elements(std::span<Contact> contacts, const Field& field, const PointShell& shell,
                   const Pose& field_from_shell, double reach, double thickness) {
  constexpr float kOpposed = -0.99f;  // cosine between the normals of surfaces that touch
  // Of reaches. What is farther out lies beside the field's body, not along its rim.
  constexpr double kFarthest = 0.1;
  constexpr double kDeepest = 8.0;
  constexpr int kDoubled = 3;  // up to there
  if (!(reach > 0.0) || shell.edges() == nullptr) return;
  const auto face = [&](const auto& typed, Contact& contact) {
    const Vec3f& outwards = shell.normal_of(contact.id);
    if (dot(outwards, contact.normal) <= kOpposed) return;
    const auto facing = static_cast<Vec3>(outwards);
    double way = 0.5 * reach;
    for (int doubled = 0; doubled <= kDoubled; ++doubled) {
      way *= 2.0;
      const auto inside = static_cast<Vec3f>(
          field_from_shell.transform_point(static_cast<Vec3>(contact.point) - way * facing));
      const auto distance = static_cast<double>(typed.distance(inside));
      if (!(distance > thickness)) continue;
      const Vec3 slope =
          field_from_shell.inverse().rotate(static_cast<Vec3>(typed.gradient(inside)));
      const double rise = -dot(facing, slope);
      if (!(rise > 0.0)) return;
      // The field is taken to be linear from there on.
      contact.depth = static_cast<float>(rise * way - distance);
      contact.normal = static_cast<Vec3f>(normalized(slope));
      return;
    }
  };
  std::visit(
      [&](const auto& typed) {
        for (Contact& contact : contacts) {
          const double gap = -static_cast<double>(contact.depth) - thickness;
          if (gap <= kFarthest * reach && gap >= -kDeepest * reach) face(typed, contact);
        }
      },
      field);
}

}  // namespace voxshell::bullet
