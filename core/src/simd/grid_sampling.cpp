#include "simd/grid_sampling.h"

#include "simd/isa.h"

namespace voxshell::simd {

const GridSampling& grid_sampling() {
#ifdef VOXSHELL_HAS_AVX2
  if (active_isa() == Isa::kAvx2) return kAvx2GridSampling;
#endif
  return kPortableGridSampling;
}

}  // namespace voxshell::simd
