#include "facing_normals.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "contact_constants.h"
#include "contact_list.h"

namespace voxshell::bullet {

void face_elements(std::span<Contact> contacts, const Field& field, const PointShell& shell,
                   const Pose& field_from_shell, double reach, double thickness) {
  if (!(reach > 0.0) || shell.edges() == nullptr) return;
  const auto face = [&](const auto& typed, Contact& contact) {
    const Vec3f& outwards = shell.normal_of(contact.id);
    if (dot(outwards, contact.normal) <= kFacingCosine) return;
    const auto facing = static_cast<Vec3>(outwards);
    double inwards = 0.5 * reach;
    for (int doubled = 0; doubled <= kFacingDoublings; ++doubled) {
      inwards *= 2.0;
      const auto inside = static_cast<Vec3f>(
          field_from_shell.transform_point(static_cast<Vec3>(contact.point) - inwards * facing));
      const auto distance = static_cast<double>(typed.distance(inside));
      if (!(distance > thickness)) continue;
      const Vec3 slope =
          field_from_shell.inverse().rotate(static_cast<Vec3>(typed.gradient(inside)));
      const double rise = -dot(facing, slope);
      if (!(rise > 0.0)) return;
      // The field is taken to be linear from there on.
      contact.depth = static_cast<float>(rise * inwards - distance);
      contact.normal = static_cast<Vec3f>(normalized(slope));
      return;
    }
  };
  std::visit(
      [&](const auto& typed) {
        for (Contact& contact : contacts) {
          const double gap = -static_cast<double>(contact.depth) - thickness;
          if (gap <= kFacingOutside * reach && gap >= -kFacingInside * reach) face(typed, contact);
        }
      },
      field);
}

void drop_from_behind(std::vector<Contact>& contacts, const PointShell& shell, float reach,
                      float deep, Opposition& opposition) {
  float buried = opposition.buried;
  bool is_opposed = opposition.is_opposed;
  keep_if(contacts, [&](const Contact& contact) {
    const float cosine = dot(shell.normal_of(contact.id), contact.normal);
    const float most = contact.depth > deep ? -kAside : kAside;
    const bool is_near = contact.depth > -reach;
    const bool is_dropped = is_near & (cosine > most);
    buried = is_dropped ? std::max(buried, contact.depth) : buried;
    is_opposed |= is_near & (cosine <= -kAside);
    return !is_dropped;
  });
  opposition = {buried, is_opposed};
}

}  // namespace voxshell::bullet
