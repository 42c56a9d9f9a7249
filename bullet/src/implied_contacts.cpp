#include "implied_contacts.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "contact_constants.h"
#include "impact.h"
#include "of_this_thread.h"
#include "turning_contacts.h"

namespace voxshell::bullet {
namespace {

struct Plane {
  Vec3 place;
  Vec3 normal;
  double gap;
  std::uint32_t index;
  bool is_ahead;
};

/// Kept from step to step, as settled ones take no memory.
struct Lists {
  std::vector<Plane> planes;
  std::vector<Plane> left;
  std::vector<std::uint8_t> is_left;
};

}  // namespace

void drop_implied(const PairStep& step, const TurningContacts& turning,
                  std::vector<Contact>& contacts, std::vector<Contact>& places) {
  if (!step.uses_ccd || step.is_segmented || contacts.size() < 2) return;
  auto& [planes, left, is_left] = of_this_thread<Lists>();
  planes.clear();
  for (std::uint32_t i = 0; i < contacts.size(); ++i) {
    const Contact& contact = contacts[i];
    const Impact impact = impact_of(step, contact);
    const bool is_ahead = impact.gap > step.rest_margin && closing_of(step, impact) < impact.gap &&
                          !(turning.speed_of(contact.id) > 0.0);
    planes.push_back({static_cast<Vec3>(contact.point), static_cast<Vec3>(contact.normal),
                      std::max(impact.gap, 0.0), i, is_ahead});
  }
  std::ranges::stable_sort(planes, {}, &Plane::gap);
  const double farthest = kCcdReach * step.farthest_displacement;
  const double turn = farthest / step.ball.radius;
  left.clear();
  is_left.assign(contacts.size(), 0);
  for (const Plane& plane : planes) {
    const auto keeps_from_it = [&](const Plane& nearer) {
      const double by_bend = farthest * length(plane.normal - nearer.normal);
      const double by_turn = turn * length(cross(plane.place - nearer.place, plane.normal));
      return nearer.gap + by_bend + by_turn <= plane.gap;
    };
    if (plane.is_ahead && std::ranges::any_of(left, keeps_from_it)) continue;
    left.push_back(plane);
    is_left[plane.index] = 1;
  }
  std::size_t count = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    contacts[count] = contacts[i];
    places[count] = places[i];
    count += is_left[i];
  }
  contacts.resize(count);
  places.resize(count);
}

}  // namespace voxshell::bullet
