#pragma once

#include "simd/grid_view.h"

namespace voxshell::simd {

/// Values of a grid field at eight points, whose coordinates are p[0], p[1], p[2]. Metres, the
/// field's frame.
struct GridSampling {
  void (*measure_distances)(const GridView& grid, const float (*p)[8], float* distances);

  /// Of balls: the distances of their centres, and what no point within has a smaller one than.
  void (*bound_balls)(const GridView& grid, const float (*centres)[8], const float* radii,
                      float* distances, float* lower_bounds);
};

/// For the active instruction set; all give the same bits.
const GridSampling& grid_sampling();

extern const GridSampling kPortableGridSampling;
extern const GridSampling kAvx2GridSampling;

}  // namespace voxshell::simd
