#define VOXSHELL_ISA avx2
#include "simd/grid_sampling_body.h"

namespace voxshell::simd {

const GridSampling<GridView> kAvx2GridSampling = avx2::kGridSamplingOf<GridView>;
const GridSampling<ExactGridView> kAvx2ExactGridSampling = avx2::kGridSamplingOf<ExactGridView>;

}  // namespace voxshell::simd
