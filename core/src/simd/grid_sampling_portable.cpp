#define VOXSHELL_ISA portable
#include "simd/grid_sampling_body.h"

namespace voxshell::simd {

const GridSampling kPortableGridSampling{portable::measure_distances, portable::bound_balls};

}  // namespace voxshell::simd
