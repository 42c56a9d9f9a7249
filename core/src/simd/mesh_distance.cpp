#include "simd/mesh_distance.h"

#include "simd/isa.h"

namespace voxshell::simd {

const MeshDistanceKernels& mesh_distance_kernels() {
#ifdef VOXSHELL_HAS_AVX2
  if (active_isa() == Isa::kAvx2) return kAvx2MeshDistance;
#endif
  return kPortableMeshDistance;
}

}  // namespace voxshell::simd
