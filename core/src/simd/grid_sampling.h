#pragma once

#include "simd/exact_view.h"

namespace voxshell::simd {

/// Values of a grid field at one point, or at eight points, whose coordinates are p[0], p[1], p[2].
/// Meters, the field's frame.
template <class G>
struct GridSampling {
  float (*measure_distance)(const G& grid, const float* p);
  void (*measure_gradient)(const G& grid, const float* p, float* gradient);

  void (*measure_distances)(const G& grid, const float (*p)[8], float* distances);

  /// Of balls: the distances of their centers, and what no point within has a smaller one than.
  void (*bound_balls)(const G& grid, const float (*centers)[8], const float* radii,
                      float* distances, float* lower_bounds);
};

/// For the active instruction set; all give the same bits.
template <class G>
const GridSampling<G>& grid_sampling();

extern const GridSampling<GridView> kPortableGridSampling;
extern const GridSampling<GridView> kAvx2GridSampling;
extern const GridSampling<ExactGridView> kPortableExactGridSampling;
extern const GridSampling<ExactGridView> kAvx2ExactGridSampling;

}  // namespace voxshell::simd
