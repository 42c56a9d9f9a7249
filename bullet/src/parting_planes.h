#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "contact_constants.h"
#include "neighbor.h"
#include "seam_touch.h"

namespace voxshell::bullet {

/// The plane of contacts that touch.
struct Plane {
  Vec3 normal;  ///< toward the body
  Vec3 place;
  int count;  ///< of the contacts

  double height(const Vec3& at) const { return dot(at - place, normal); }
  bool is_of(const Touch& touch, double step) const {
    return dot(normal, touch.normal) >= kSeamAligned &&
           std::abs(height(touch.on_other())) <= kSeamBeside * step;
  }
};

/// Counts a touch among the planes.
void add_plane(const Touch& touch, double step, std::vector<Plane>& planes);

/// Where a plane that carries the body parts it from another one, a contact of these two has that
/// plane's normal alone: edges of two flush faces that cross touch with any normal, as each of them
/// sees it (docs/decisions/0062-planes-that-part-bodies.md).
/// @param planes  What the body touches, those of most contacts first.
std::optional<Seam> find_parting(const Touch& touch, const Arrival& arrival,
                                 std::span<const Plane> planes, double radius, Neighbor& body,
                                 Neighbor& other);

}  // namespace voxshell::bullet
