#pragma once

// The kernels of simd/grid_sampling.h, for whatever instruction set the including source is
// compiled for.

#include "simd/grid_formula.h"
#include "simd/grid_sampling.h"

namespace voxshell::simd::VOXSHELL_ISA {

VOXSHELL_INLINE Triple<F8> load_points(const float (*p)[8]) {
  return {load<F8>(p[0]), load<F8>(p[1]), load<F8>(p[2])};
}

template <class G>
float measure_distance(const G& grid, const float* p) {
  return evaluate_distance(grid, Triple<float>{p[0], p[1], p[2]});
}

template <class G>
void measure_gradient(const G& grid, const float* p, float* gradient) {
  const Triple<float> found = evaluate_gradient(grid, Triple<float>{p[0], p[1], p[2]});
  gradient[0] = found.x;
  gradient[1] = found.y;
  gradient[2] = found.z;
}

template <class G>
void measure_distances(const G& grid, const float (*p)[8], float* distances) {
  store(distances, evaluate_distance(grid, load_points(p)));
}

template <class G>
void bound_balls(const G& grid, const float (*centers)[8], const float* radii, float* distances,
                 float* lower_bounds) {
  const Triple<F8> p = load_points(centers);
  const auto place = locate(grid, p);
  const auto value = evaluate_in_grid<Wanted::kDistance>(grid, p, place);
  store(lower_bounds, find_lower_bound(grid, place, value, load<F8>(radii)));
  store(distances, any(is_beyond(place.outside)) ? evaluate_distance(grid, p) : value.distance);
}

template <class G>
inline constexpr GridSampling<G> kGridSamplingOf{&measure_distance<G>, &measure_gradient<G>,
                                                 &measure_distances<G>, &bound_balls<G>};

}  // namespace voxshell::simd::VOXSHELL_ISA
