#pragma once

#include <stdint.h>

namespace voxshell::simd {

/// A group of triangles, in a binary tree of which the first node is the root.
struct WindingNode {
  double center[3];  ///< of the triangles' area
  double area[3];    ///< sum of the triangles' normals, as long as their areas
  double radius;     ///< no triangle reaches farther from the center
  uint32_t first;    ///< a leaf's first triangle; an inner node's right child
  uint32_t count;    ///< a leaf's triangles; 0 for an inner node, whose left child is next
};

/// Numbers that one triangle is described by: x, y and z of its three corners.
inline constexpr int kWindingTriangleDoubles = 9;

/// Groups of triangles and, leaf by leaf, the triangles. One unit for all lengths.
struct WindingView {
  const WindingNode* nodes;
  const double* triangles;  ///< kWindingTriangleDoubles each
};

struct WindingKernels {
  /// The generalised winding numbers of `count` places (x, y, z of each). Places near one another
  /// cost less than others.
  void (*compute)(const WindingView& tree, const double* places, int64_t count, double* numbers);
};

/// For the active instruction set; all give the same bits.
const WindingKernels& winding_kernels();

extern const WindingKernels kPortableWinding;
extern const WindingKernels kAvx2Winding;

}  // namespace voxshell::simd
