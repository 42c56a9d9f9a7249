#define VOXSHELL_ISA avx2
#include "simd/query_body.h"
#include "simd/query_tables.h"

namespace voxshell::simd {

#define VOXSHELL_DEFINE(V)                         \
  template <>                                      \
  const QueryKernels<V>& avx2_query_kernels<V>() { \
    return avx2::kQueryKernels<V>;                 \
  }
VOXSHELL_FOR_EACH_VIEW(VOXSHELL_DEFINE)
#undef VOXSHELL_DEFINE

}  // namespace voxshell::simd
