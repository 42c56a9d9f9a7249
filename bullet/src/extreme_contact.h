#pragma once

#include <optional>

#include "posed_pair.h"

namespace voxshell::bullet {

/// The id of the contact that find_extreme_contact() finds: no shell has so many points.
inline constexpr std::uint32_t kExtremeContact = UINT32_MAX;

/// Where a convex shape of Bullet's reaches deepest into a model with one of its own extreme
/// points, if nearer than `margin`: apexes and corners that lie between the points of the model's
/// shell, and shapes that are wholly inside the model, where that has no points at all. By steps
/// from extreme point to extreme point down the model's field (Frank and Wolfe 1956).
std::optional<Contact> find_extreme_contact(const PosedPair& pair, float margin);

}  // namespace voxshell::bullet
