#include "simd/grid_sampling.h"

#include "simd/isa.h"

namespace voxshell::simd {

template <>
const GridSampling<GridView>& grid_sampling<GridView>() {
#ifdef VOXSHELL_HAS_AVX2
  if (active_isa() == Isa::kAvx2) return kAvx2GridSampling;
#endif
  return kPortableGridSampling;
}

template <>
const GridSampling<ExactGridView>& grid_sampling<ExactGridView>() {
#ifdef VOXSHELL_HAS_AVX2
  if (active_isa() == Isa::kAvx2) return kAvx2ExactGridSampling;
#endif
  return kPortableExactGridSampling;
}

}  // namespace voxshell::simd
