#include "simd/winding.h"

#include "simd/isa.h"

namespace voxshell::simd {

const WindingKernels& winding_kernels() {
#ifdef VOXSHELL_HAS_AVX2
  if (active_isa() == Isa::kAvx2) return kAvx2Winding;
#endif
  return kPortableWinding;
}

}  // namespace voxshell::simd
