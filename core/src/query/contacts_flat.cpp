#include "voxshell/contacts_flat.h"

#include <algorithm>

#include "query/posed.h"

namespace voxshell {

std::vector<Contact> find_contacts_flat(const Field& field, const PointShell& shell,
                                        const Pose& field_from_shell,
                                        const ContactOptions& options) {
  std::vector<Contact> contacts;
  const auto points = shell.points();
  with_posed(field, shell, field_from_shell, [&](const auto& posed) {
    for (std::uint32_t id = 0; id < points.size(); ++id) {
      const simd::portable::Triple<float> p{points[id].x, points[id].y, points[id].z};
      const float distance = posed_distance(posed, p);
      if (!(distance < options.margin)) continue;
      const auto n = posed_normal(posed, p);
      Vec3f normal{n.x, n.y, n.z};
      // Where the field has no gradient (a ridge inside it), the shell's own normal says which way
      // is out.
      if (normal == Vec3f{}) normal = -shell.normals()[id];
      contacts.push_back({id, -distance, points[id], normal});
    }
  });
  if (contacts.size() > options.max_points) {
    // Stable, so that of equally deep contacts those with smaller ids come first.
    std::stable_sort(contacts.begin(), contacts.end(),
                     [](const Contact& a, const Contact& b) { return a.depth > b.depth; });
    contacts.resize(options.max_points);
    std::sort(contacts.begin(), contacts.end(),
              [](const Contact& a, const Contact& b) { return a.id < b.id; });
  }
  return contacts;
}

}  // namespace voxshell
