#pragma once

#include <stdint.h>

namespace voxshell::simd {

/// Clusters lie in blocks of eight siblings. Of their spheres: eight x, eight y, eight z, eight
/// radii; where there is no cluster, the radius is kNoSphere. Then of the slabs about their mean
/// normals: eight x, eight y, eight z of the normals, which may be zero, and eight
/// half-thicknesses: no point is farther than that from the plane through the sphere's center.
inline constexpr int kClusterBlockFloats = 64;
inline constexpr int kSlabFloats = 32;  ///< where the slabs begin
inline constexpr float kNoSphere = -1e30f;

/// Points lie in buckets of eight: eight x, eight y, eight z. Where there is no point, they are not
/// a number, which is in no field.
inline constexpr int kBucketFloats = 24;

inline constexpr int kMostWalkLevels = 9;

/// A point-sphere tree as kernels see it. The walk starts at block 0 of level 0; the children of
/// sphere i of a level are block i of the next. Spheres of the last level are called slots: slot i
/// of 2^depth covers the buckets [floor(b i / 2^depth), floor(b (i + 1) / 2^depth)), two at most.
/// Meters, the shell's frame.
struct TreeView {
  uint64_t serial;  ///< of the tree; see base/serial.h
  const float* blocks;
  const float* buckets;
  const float* normals;  ///< of the points, three each
  uint32_t first_block[kMostWalkLevels];
  int32_t level_count;  ///< of the walk
  int32_t depth;
  uint32_t point_count;
  uint32_t bucket_count;
};

}  // namespace voxshell::simd
