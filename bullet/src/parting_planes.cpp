#include "parting_planes.h"

#include <algorithm>
#include <array>

namespace voxshell::bullet {

namespace {

/// A body beside a place of a plane, on both sides along the plane.
struct Beside {
  bool is_flat;  ///< the body is not round there
  bool is_face;  ///< the plane is that of a flat face of the body
};
/// None where the body comes nearer than `least` to places in front of the plane.
std::optional<Beside> look_beside(const Vec3& place, const Vec3& normal, const Vec3& aside,
                                  double reach, double least, Neighbor& body) {
  const std::array<Vec3, 2> ways{aside, -aside};
  const auto beyond = [&](const Vec3& way) { return place + reach * (normal + way); };
  for (const Vec3& way : ways) {
    if (body.distance(beyond(way)) < least) return std::nullopt;
  }
  Beside beside{false, false};
  for (const Vec3& way : ways) {
    const Vec3 there = beyond(way);
    const PlacedField& field = *body.nearest(there);
    if (field.is_flat(there, place + kFaceOfReach * reach * (normal + way))) {
      beside.is_flat = true;
      beside.is_face = beside.is_face || dot(field.outwards(there), normal) >= kPartingFace;
      continue;
    }
    // Along a rim, a face is on neither side, but behind the rim.
    const Vec3 out = field.outwards(there);
    const Vec3 behind = -normalized(out - dot(out, normal) * normal);
    const Vec3 over = place + reach * (normal + kBehindRimOfReach * behind);
    const bool is_over_face = field.is_flat(over, over + kFaceOfReach * reach * behind) &&
                              dot(field.outwards(over), normal) >= kPartingFace;
    if (behind != Vec3{} && is_over_face) beside.is_flat = beside.is_face = true;
  }
  return beside;
}

}  // namespace

void add_plane(const Touch& touch, double step, std::vector<Plane>& planes) {
  if (touch.gap > step) return;
  const auto known =
      std::ranges::find_if(planes, [&](const Plane& each) { return each.is_of(touch, step); });
  if (known != planes.end()) {
    ++known->count;
  } else {
    planes.push_back({touch.normal, touch.on_other(), 1});
  }
}

std::optional<Seam> find_parting(const Touch& touch, const Arrival& arrival,
                                 std::span<const Plane> planes, double radius, Neighbor& body,
                                 Neighbor& other) {
  const double reach = kSeamReach * radius;
  const double step = kSeamStep * radius;
  if (!arrival.is_in_time && touch.gap > step) return std::nullopt;
  const auto count_of_own = [&] {
    const auto own =
        std::ranges::find_if(planes, [&](const Plane& plane) { return plane.is_of(touch, step); });
    return own != planes.end() ? own->count : 0;
  };
  for (const Plane& plane : planes) {
    // What the plane carries does not fall to it.
    const double fall = std::max(-dot(arrival.fall, plane.normal), 0.0);
    const double height = plane.height(arrival.place);
    if (height < -reach || height > reach + fall) continue;
    const double along = dot(touch.normal, plane.normal);
    if (along >= kOwnOfPlane) return std::nullopt;
    if (along < -kSeamOpposed) continue;
    const Vec3 down = -std::clamp(height, 0.0, fall) * plane.normal;
    // Of two planes that part the bodies, it is the one of more contacts, unless they are farther
    // apart along the other one.
    const double apart = plane.height(touch.on_body) - std::min(touch.gap, 0.0);
    if (apart < -kSeamBeside * step || plane.count <= count_of_own()) continue;
    if (!body.has_field() || !other.has_field()) return std::nullopt;
    const Vec3 aside = leaning_over(touch.normal, plane.normal);
    const auto on_other =
        look_beside(arrival.place + down, plane.normal, aside, reach, kRoomOfReach * reach, other);
    if (!on_other || !on_other->is_flat) continue;
    const auto on_body = look_beside(touch.on_body + down, -plane.normal, aside, reach,
                                     kPartedOfReach * reach, body);
    if (!on_body || !on_body->is_flat || (!on_other->is_face && !on_body->is_face)) continue;
    return Seam{plane.normal, plane.height(touch.on_body), along >= kTurnedCosine};
  }
  return std::nullopt;
}

}  // namespace voxshell::bullet
