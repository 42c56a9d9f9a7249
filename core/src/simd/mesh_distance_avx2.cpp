#define VOXSHELL_ISA avx2
#include "simd/mesh_distance_body.h"

namespace voxshell::simd {

const MeshDistanceKernels kAvx2MeshDistance{avx2::find_nearest,   avx2::find_blocks,
                                            avx2::measure_brick,  avx2::measure_listed,
                                            avx2::compare_listed, avx2::evaluate_listed};

}  // namespace voxshell::simd
