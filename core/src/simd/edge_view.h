#pragma once

#include "simd/tree_view.h"

namespace voxshell::simd {

/// Straight pieces of edges as kernels see them; the tree's points are their middles. Meters, the
/// shell's frame.
struct EdgeView {
  TreeView tree;
  const float* halves;  ///< from the middle to an end, three each, by the tree's ids
  float reach;          ///< no end is farther from its middle
  float tie;            ///< places that differ by less are equally deep
};

}  // namespace voxshell::simd
