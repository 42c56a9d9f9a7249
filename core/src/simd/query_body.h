#pragma once

// The kernels of simd/query_kernels.h, for whatever instruction set the including source is
// compiled for.

#include "simd/edge_body.h"
#include "simd/list_body.h"
#include "simd/search_body.h"
#include "simd/sweep_body.h"

namespace voxshell::simd::VOXSHELL_ISA {

template <class V>
inline constexpr QueryKernels<V> kQueryKernels = {&expand<V>,
                                                  &sift<V>,
                                                  &evaluate<V>,
                                                  &evaluate_sifted<V>,
                                                  &complete<V>,
                                                  &differentiate<V>,
                                                  &keep_arriving_spheres<V>,
                                                  &keep_arriving_points<V>,
                                                  &find_deepest<V>,
                                                  &find_any<V>,
                                                  &find_widest<V>,
                                                  &choose_widest,
                                                  &refine_edges<V>,
                                                  &find_deepest_edges<V>,
                                                  &find_any_edge<V>,
                                                  &find_deepest_edge<V>,
                                                  &may_come_below<V>,
                                                  &may_edges_come_below<V>};

}  // namespace voxshell::simd::VOXSHELL_ISA
