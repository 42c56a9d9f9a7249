#pragma once

#include "simd/grid_view.h"

namespace voxshell::simd {

/// Triangles lie in blocks of eight: eight x, y, z of a corner a, of b - a, of c - a and of the
/// unit normal, then eight indices of triangles. The last block of a list is filled up with copies
/// of its last triangle.
inline constexpr int kTriangleBlockFloats = 104;
inline constexpr int kTriangleIndices = 96;  ///< where the indices begin

/// The outward normals of a triangle's features, three floats each: face, edges ab, bc, ca, corners
/// a, b, c. Those of edges and corners are angle-weighted means (Baerentzen and Aanaes 2005), which
/// tell inside from outside and need not have unit length.
inline constexpr int kFeatureNormalFloats = 21;

/// A list of triangles in 32 bits: the number of its blocks less one, then the index of the first.
inline constexpr int kBlockCountBits = 5;
inline constexpr int kMostBlocksInList = 1 << kBlockCountBits;

/// Of a brick with exact cells: kMaskWords words with a bit for each cell, x fastest, then as many
/// indices of the lists of the first exact cells that the words say.
inline constexpr int kMaskWords = 16;

/// A grid field some of whose fine cells are exact: the distance there is that to the nearest of a
/// few triangles, which the grid's samples cannot follow (creases, thin walls). Metres, the field's
/// frame.
struct ExactGridView : GridView {
  const uint32_t* exact_bricks;  ///< one a brick: 0, or 1 + its index among those with exact cells
  const uint32_t* exact_masks;   ///< 2 * kMaskWords for each of these
  const uint32_t* exact_lists;   ///< one for each exact cell
  const float* triangle_blocks;  ///< kTriangleBlockFloats each
  const float* feature_normals;  ///< kFeatureNormalFloats for each triangle
};

}  // namespace voxshell::simd
