#include "flat_elements.h"

#include <variant>

#include "contact_constants.h"
#include "flatness.h"

namespace voxshell::bullet {
void FlatElements::align(std::vector<Contact>& contacts, const Field& field,
                         const PointShell& shell, const GridField& own,
                         const Pose& field_from_shell, const TouchScale& scale) {
  if (!(scale.margin > 0.0) || std::holds_alternative<PlaneField>(field)) return;
  if (shell_ != &shell) bends_.clear();
  shell_ = &shell;
  next_.clear();
  auto known = bends_.begin();
  const auto bend_at = [&](const Contact& contact, const Vec3& normal) {
    while (known != bends_.end() && known->id < contact.id) ++known;
    const std::size_t from =
        known != bends_.end() && known->id == contact.id
            ? known->from
            : bends_from(own, static_cast<Vec3>(contact.point), normal, scale.radius);
    next_.push_back({contact.id, from});
    return from;
  };
  /// Whether the contact is one.
  const auto align = [&](const auto& typed, Contact& contact) {
    if (!shell.is_point(contact.id)) return true;
    const double gap = -static_cast<double>(contact.depth) - scale.thickness;
    const Vec3f& outwards = shell.normals()[contact.id];
    if (gap > scale.margin || dot(outwards, contact.normal) <= kAlignedCosine) return true;
    const auto place = static_cast<Vec3>(contact.point);
    const auto normal = static_cast<Vec3>(outwards);
    const std::size_t bends = bend_at(contact, normal);
    if (bends == 0) return true;
    const Vec3 field_normal = field_from_shell.rotate(static_cast<Vec3>(contact.normal));
    const Vec3 in_field = field_from_shell.transform_point(place);
    const Vec3 on_field = in_field + static_cast<double>(contact.depth) * field_normal;
    if (!bends_before(typed, on_field, field_normal, scale.radius, bends)) return true;
    const Vec3 out_of_field = -field_from_shell.rotate(normal);
    const auto depth = depth_along(typed, in_field, out_of_field, scale.thickness, scale.margin);
    if (!depth) {
      if (gap >= 0.0) return false;
      // Along the rim, a place with a depth by face_elements() may lie a little beside the field.
      const auto distance = static_cast<double>(typed.distance(static_cast<Vec3f>(in_field)));
      if (distance > scale.thickness) contact.normal = -outwards;
      return true;
    }
    // At that depth the nearest surface of the shell's body must still be this one, as far as its
    // field tells: at its points, the field is not quite 0.
    if (*depth > kDepthPrecision * scale.margin) {
      const auto inside = static_cast<Vec3f>(place - *depth * normal);
      const float deeper = own.distance(contact.point) - own.distance(inside);
      if (static_cast<double>(deeper) < kOwnDepth * *depth) return true;
    }
    contact.normal = -outwards;
    contact.depth = static_cast<float>(*depth - scale.thickness);
    return true;
  };
  std::visit(
      [&](const auto& typed) {
        std::erase_if(contacts, [&](Contact& contact) { return !align(typed, contact); });
      },
      field);
  bends_.swap(next_);
}

}  // namespace voxshell::bullet
