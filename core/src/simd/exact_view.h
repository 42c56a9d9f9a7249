#pragma once

#include "simd/grid_view.h"

namespace voxshell::simd {

/// Numbers that one triangle is described by: a corner a, b - a, c - a and the unit normal, filled
/// up to a cache line.
inline constexpr int kTriangleFloats = 16;
inline constexpr int kRecordNormal = 9;

/// The outward normals of a triangle's features, three floats each: face, edges ab, bc, ca, corners
/// a, b, c. Those of edges and corners are angle-weighted means (Baerentzen and Aanaes 2005), which
/// tell inside from outside and need not have unit length.
inline constexpr int kFeatureNormalFloats = 21;

/// A list of triangles in 32 bits: where its first index is, then how many there are.
inline constexpr int kListCountBits = 8;
inline constexpr uint32_t kMostInList = (1u << kListCountBits) - 1;
inline constexpr uint32_t kMostListed = 1u << (32 - kListCountBits);

/// Of a brick with exact cells: kMaskWords words with a bit for each cell, x fastest, then as many
/// indices of the lists of the first exact cells that the words say.
inline constexpr int kMaskWords = 16;

/// A grid field some of whose fine cells are exact: the distance there is that to the nearest of a
/// few triangles, which the grid's samples cannot follow (creases, thin walls). Meters, the field's
/// frame.
struct ExactGridView : GridView {
  const uint32_t* exact_bricks;  ///< one a brick: 0, or 1 + its index among those with exact cells
  const uint32_t* exact_masks;   ///< 2 * kMaskWords for each of these
  const uint32_t* exact_lists;   ///< one for each exact cell
  const uint32_t* listed;        ///< triangles, list by list
  const float* triangles;        ///< kTriangleFloats each
  const float* feature_normals;  ///< kFeatureNormalFloats each
};

}  // namespace voxshell::simd
