#define VOXSHELL_ISA avx2
#include "simd/grid_sampling_body.h"

namespace voxshell::simd {

const GridSampling kAvx2GridSampling{avx2::measure_distances, avx2::bound_balls};

}  // namespace voxshell::simd
