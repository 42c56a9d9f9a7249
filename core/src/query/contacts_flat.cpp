#include "voxshell/contacts_flat.h"

#include <algorithm>

#include "query/posed.h"
#include "simd/edge_formula.h"

namespace voxshell {

std::vector<Contact> find_contacts_flat(const Field& field, const PointShell& shell,
                                        const Pose& field_from_shell,
                                        const ContactOptions& options) {
  std::vector<Contact> contacts;
  const auto points = shell.points();
  const EdgeSegments* edges = shell.edges();
  using Triple = simd::portable::Triple<float>;
  with_posed(field, shell, field_from_shell, [&](const auto& posed) {
    const auto consider = [&](std::uint32_t id, const Triple& p) {
      const float distance = posed_distance(posed, p);
      if (!(distance < options.margin)) return;
      const auto n = posed_normal(posed, p);
      Vec3f normal{n.x, n.y, n.z};
      // Where the field has no gradient (a ridge inside it), the shell's own normal says which way
      // is out.
      if (normal == Vec3f{}) normal = -shell.normal_of(id);
      contacts.push_back({id, -distance, {p.x, p.y, p.z}, normal});
    };
    for (std::uint32_t id = 0; id < points.size(); ++id) {
      consider(id, {points[id].x, points[id].y, points[id].z});
    }
    if (edges == nullptr) return;
    for (std::uint32_t i = 0; i < edges->size(); ++i) {
      const Vec3f m = edges->middles()[i];
      const Vec3f h = edges->halves()[i];
      const Triple middle{m.x, m.y, m.z};
      const Triple half{h.x, h.y, h.z};
      const float t = find_place_on_edge(posed, middle, half, edges->tie());
      consider(shell.tree().point_count() + i, place_on_edge(middle, half, t));
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

bool arrives_flat(const Field& field, const PointShell& shell, std::uint32_t id,
                  std::span<const Arrival> arrivals) {
  const bool is_point = shell.is_point(id);
  const Vec3f place =
      is_point ? shell.points()[id] : shell.edges()->middles()[id - shell.tree().point_count()];
  const float reach = is_point ? 0.0f : shell.edges()->reach();
  return std::ranges::any_of(arrivals, [&](const Arrival& arrival) {
    float distance = 0.0f;
    with_posed(field, shell, arrival.field_from_shell, [&](const auto& posed) {
      distance = posed_distance(posed, simd::portable::Triple<float>{place.x, place.y, place.z});
    });
    return distance < arrival.margin + reach;
  });
}

}  // namespace voxshell
