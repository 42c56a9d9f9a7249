#define VOXSHELL_ISA avx2
#include "simd/grid_sampling_body.h"

namespace voxshell::simd {

const GridSampling<GridView> kAvx2GridSampling{avx2::measure_distances<GridView>,
                                               avx2::bound_balls<GridView>};
const GridSampling<ExactGridView> kAvx2ExactGridSampling{avx2::measure_distances<ExactGridView>,
                                                         avx2::bound_balls<ExactGridView>};

}  // namespace voxshell::simd
