#include "supporting_places.h"

#include <algorithm>
#include <optional>
#include <span>

#include "contact_constants.h"

namespace voxshell::bullet {
namespace {

/// The point of the line between two places that is nearest to the origin.
Vec3 nearest_between(const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double squared = squared_length(along);
  const double t = squared > 0.0 ? std::clamp(-dot(a, along) / squared, 0.0, 1.0) : 0.0;
  return a + t * along;
}

/// Whether a triangle in a plane through the origin holds it.
bool holds_origin(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& normal) {
  const double of_ab = dot(cross(a, b), normal);
  const double of_bc = dot(cross(b, c), normal);
  const double of_ca = dot(cross(c, a), normal);
  return (of_ab >= 0.0 && of_bc >= 0.0 && of_ca >= 0.0) ||
         (of_ab <= 0.0 && of_bc <= 0.0 && of_ca <= 0.0);
}

/// The place, as seen from `middle` along its normal, that is farthest against `direction` of those
/// whose normals are near that of `middle`.
std::optional<Vec3> find_farthest(std::span<const SupportingPlace> places,
                                  const SupportingPlace& middle, const Vec3& direction) {
  std::optional<Vec3> farthest;
  for (const SupportingPlace& place : places) {
    if (dot(place.normal, middle.normal) < static_cast<double>(kDoubleCosine)) continue;
    const Vec3 offset = place.place - middle.place;
    const Vec3 beside = offset - dot(offset, middle.normal) * middle.normal;
    if (!farthest || dot(beside, direction) < dot(*farthest, direction)) farthest = beside;
  }
  return farthest;
}

/// Whether the convex hull of these places comes within `aside` of the middle. A line between two
/// of its corners moves toward the middle, as in the algorithm of Gilbert, Johnson and Keerthi.
bool spans(std::span<const SupportingPlace> places, const SupportingPlace& middle, double aside) {
  std::optional<Vec3> a = find_farthest(places, middle, {});
  if (!a) return false;
  Vec3 b = *a;
  constexpr int kMostRounds = 32;
  for (int round = 0; round < kMostRounds; ++round) {
    const Vec3 nearest = nearest_between(*a, b);
    const double distance = length(nearest);
    if (distance <= aside) return true;
    const std::optional<Vec3> corner = find_farthest(places, middle, nearest);
    if (!corner) return false;
    // All of the hull is beyond the line through it.
    if (dot(*corner, nearest) > aside * distance) return false;
    if (holds_origin(*a, b, *corner, middle.normal)) return true;
    const bool is_beside_a =
        squared_length(nearest_between(*a, *corner)) <= squared_length(nearest_between(b, *corner));
    (is_beside_a ? b : *a) = *corner;
  }
  return true;
}

}  // namespace

bool SupportingPlaces::can_support(double aside) {
  double all = 0.0;
  for (const SupportingPlace& place : before) all += place.impulse;
  while (!before.empty()) {
    SupportingPlace middle{{}, before.back().normal, 0.0};
    std::erase_if(before, [&](const SupportingPlace& place) {
      if (dot(place.normal, middle.normal) < static_cast<double>(kDoubleCosine)) return false;
      middle.place = middle.place + place.impulse * place.place;
      middle.impulse += place.impulse;
      return true;
    });
    if (!(middle.impulse > kSupportedWithin * all)) continue;
    middle.place = (1.0 / middle.impulse) * middle.place;
    if (!spans(now, middle, aside)) return false;
  }
  return true;
}

}  // namespace voxshell::bullet
