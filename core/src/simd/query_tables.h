#pragma once

#include "simd/query_kernels.h"

namespace voxshell::simd {

/// One table for each instruction set, defined in the source compiled for it.
template <class V>
const QueryKernels<V>& portable_query_kernels();
template <class V>
const QueryKernels<V>& avx2_query_kernels();

#define VOXSHELL_DECLARE(V)                           \
  template <>                                         \
  const QueryKernels<V>& portable_query_kernels<V>(); \
  template <>                                         \
  const QueryKernels<V>& avx2_query_kernels<V>();
VOXSHELL_FOR_EACH_VIEW(VOXSHELL_DECLARE)
#undef VOXSHELL_DECLARE

}  // namespace voxshell::simd
