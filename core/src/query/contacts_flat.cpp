#include "voxshell/contacts_flat.h"

#include "query/traverse.h"

namespace voxshell {

std::vector<Contact> find_contacts_flat(const Field& field, const PointShell& shell,
                                        const Pose& field_from_shell,
                                        const ContactOptions& options) {
  std::vector<Contact> contacts;
  const auto points = shell.points();
  with_posed_field(field, shell, field_from_shell, [&](const auto& posed) {
    for (std::uint32_t id = 0; id < points.size(); ++id) {
      const float distance = posed.distance(points[id]);
      if (distance < options.margin) {
        contacts.push_back(make_contact(posed, shell, id, distance));
      }
    }
  });
  return contacts;
}

}  // namespace voxshell
