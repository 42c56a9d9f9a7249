#include "simd/query_kernels.h"

#include "simd/query_tables.h"

namespace voxshell::simd {

template <class V>
const QueryKernels<V>& query_kernels([[maybe_unused]] Isa isa) {
#ifdef VOXSHELL_HAS_AVX2
  if (isa == Isa::kAvx2) return avx2_query_kernels<V>();
#endif
  return portable_query_kernels<V>();
}

#define VOXSHELL_INSTANTIATE(V) template const QueryKernels<V>& query_kernels<V>(Isa);
VOXSHELL_FOR_EACH_VIEW(VOXSHELL_INSTANTIATE)
#undef VOXSHELL_INSTANTIATE

}  // namespace voxshell::simd
