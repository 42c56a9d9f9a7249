#include "voxshell/contacts.h"

#include "query/traverse.h"

namespace voxshell {

std::span<const Contact> find_contacts(const Field& field, const PointShell& shell,
                                       const Pose& field_from_shell, const ContactOptions& options,
                                       QueryScratch& scratch) {
  scratch.contacts.clear();
  const auto points = shell.points();
  with_posed_field(field, shell, field_from_shell, [&](const auto& posed) {
    visit_points_below(posed, shell, options.margin, [&](std::uint32_t id) {
      const float distance = posed.distance(points[id]);
      if (distance < options.margin) {
        scratch.contacts.push_back(make_contact(posed, shell, id, distance));
      }
      return true;
    });
  });
  return scratch.contacts;
}

}  // namespace voxshell
