#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <type_traits>

#include "conservative_advancement.h"
#include "contact_constants.h"
#include "eight_directions.h"
#include "voxshell/field.h"

namespace voxshell::bullet {

/// Two unit vectors at right angles to `normal` and each other.
inline std::array<Vec3, 2> tangents_of(const Vec3& normal) {
  const Vec3 other = std::abs(normal.z) < 0.7 ? Vec3{0, 0, 1} : Vec3{1, 0, 0};
  const Vec3 first = normalized(cross(normal, other));
  return {first, cross(normal, first)};
}

/// How far a surface is from its tangent plane at `place`, all around it at a distance, as a
/// fraction of that distance: 0 where it is flat, up to 1 at edges.
template <class F>
double bend_of(const F& field, const Vec3& place, const Vec3& normal, double distance) {
  if constexpr (std::is_same_v<F, PlaneField>) return 0.0;
  constexpr std::size_t kAround = kEightDirections.size();
  const auto tangents = tangents_of(normal);
  const auto at = [&](std::size_t i) {
    const auto& [u, v] = kEightDirections[i];
    return static_cast<Vec3f>(place + distance * (u * tangents[0] + v * tangents[1]));
  };
  float farthest = 0.0f;
  if constexpr (std::is_same_v<F, GridField>) {
    EightPoints places;
    for (std::size_t i = 0; i < kAround; ++i) places.set(i, at(i));
    for (const float d : field.distances(places)) farthest = std::max(farthest, std::abs(d));
  } else {
    for (std::size_t i = 0; i < kAround; ++i) {
      farthest = std::max(farthest, std::abs(field.distance(at(i))));
    }
  }
  return static_cast<double>(farthest) / distance;
}

/// From which of kFlatScales on a surface bends along a tangent, either way; how many there are
/// where it is straight at all.
template <class F>
std::size_t bends_along_from(const F& field, const Vec3& place, const Vec3& tangent,
                             double radius) {
  if constexpr (std::is_same_v<F, PlaneField>) return kFlatScales.size();
  const auto bends = [&](double distance) {
    const auto off = [&](double along) {
      return std::abs(
          static_cast<double>(field.distance(static_cast<Vec3f>(place + along * tangent))));
    };
    return std::max(off(distance), off(-distance)) > kFlatBend * distance;
  };
  std::size_t scale = 0;
  while (scale < kFlatScales.size() && !bends(kFlatScales[scale] * radius)) ++scale;
  return scale;
}

/// From which of kFlatScales on a surface bends; how many there are where it is flat at all.
template <class F>
std::size_t bends_from(const F& field, const Vec3& place, const Vec3& normal, double radius) {
  std::size_t scale = 0;
  while (scale < kFlatScales.size() &&
         bend_of(field, place, normal, kFlatScales[scale] * radius) <= kFlatBend) {
    ++scale;
  }
  return scale;
}

/// Whether a surface bends before one that bends from a scale on.
template <class F>
bool bends_before(const F& field, const Vec3& place, const Vec3& normal, double radius,
                  std::size_t other) {
  for (std::size_t scale = 0; scale < other; ++scale) {
    if (bend_of(field, place, normal, kFlatScales[scale] * radius) > kFlatBend) return true;
  }
  return false;
}

/// How deep a place is in a field along a direction that leads out of it, meters; negative where
/// the field lies against the direction, by at most `reach`. None where it does not.
template <class F>
std::optional<double> depth_along(const F& field, const Vec3& place, const Vec3& outwards,
                                  double offset, double reach) {
  const auto at = [&](double along) { return static_cast<Vec3f>(place + along * outwards); };
  const double precision = kDepthPrecision * reach;
  const bool is_inside = static_cast<double>(field.distance(at(0.0))) < offset;
  const double sign = is_inside ? 1.0 : -1.0;
  const double length = is_inside ? kDeepestColumn * reach : reach;
  const auto reached = advance(length, precision, 1.0, [&](double fraction) {
    const double gap =
        -sign * (static_cast<double>(field.distance(at(sign * fraction * length))) - offset);
    return Clearance{gap, kSafeOfGap * gap};
  });
  if (!reached || reached->gap > precision) return std::nullopt;
  const double along = sign * reached->fraction * length;
  const double slope = dot(static_cast<Vec3>(field.gradient(at(along))), outwards);
  if (!(slope > 0.0)) return std::nullopt;
  return along + sign * reached->gap / std::max(slope, kLeastSlope);
}

}  // namespace voxshell::bullet
