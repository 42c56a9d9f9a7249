#include "simd/query_body.h"
#include "simd/query_tables.h"

namespace voxshell::simd {

#define VOXSHELL_DEFINE(V)                             \
  template <>                                          \
  const QueryKernels<V>& portable_query_kernels<V>() { \
    return portable::kQueryKernels<V>;                 \
  }
VOXSHELL_FOR_EACH_VIEW(VOXSHELL_DEFINE)
#undef VOXSHELL_DEFINE

}  // namespace voxshell::simd
