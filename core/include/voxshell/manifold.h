#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "voxshell/contacts.h"
#include "voxshell/point_shell.h"

namespace voxshell {

/// Largest number of points that represent all contacts of a pair: the size of Bullet's manifold.
inline constexpr std::size_t kManifoldSize = 4;

/// Indices into a contact set, in the order chosen.
struct ManifoldPoints {
  std::array<std::uint32_t, kManifoldSize> indices{};
  std::size_t count = 0;

  std::span<const std::uint32_t> chosen() const { return std::span(indices).first(count); }
};

/// Selects at most `max_points` (1 to 4) contacts (thesis, section 5.3): the deepest first, then
/// those that give the manifold the largest area. Points that would add no area are left out; ties
/// go to the smaller id.
ManifoldPoints select_manifold(std::span<const Contact> contacts,
                               std::size_t max_points = kManifoldSize);

/// The deepest contact of each segment of a level (thesis, section 5.3, segmented traverse):
/// indices into `contacts`, ascending; ties go to the smaller id. Overwrites `deepest`.
void select_deepest_per_segment(std::span<const Contact> contacts, const PointShell& shell,
                                int level, std::vector<std::uint32_t>& deepest);

/// The contacts that select_manifold() would select from those of find_contacts(), bit for bit, by
/// branch and bound and without listing the others. The result lives in `scratch` until its next
/// use.
std::span<const Contact> find_manifold(const Field& field, const PointShell& shell,
                                       const Pose& field_from_shell, float margin,
                                       QueryScratch& scratch,
                                       std::size_t max_points = kManifoldSize);

/// A pose at which a shell may arrive, and how near the field its elements are then to be.
struct Arrival {
  Pose field_from_shell;
  float margin;  ///< meters
};
inline constexpr std::size_t kMostArrivals = 4;

/// The contacts that select_deepest_per_segment() would select, found in the same way. With
/// `arrivals`, of which there are at most kMostArrivals, only elements are considered whose
/// distance is below the margin of one of them, too. Of an edge segment, that is the distance of
/// its middle, less EdgeSegments::reach().
std::span<const Contact> find_deepest_per_segment(const Field& field, const PointShell& shell,
                                                  const Pose& field_from_shell, int level,
                                                  float margin, QueryScratch& scratch,
                                                  std::span<const Arrival> arrivals = {});

}  // namespace voxshell
