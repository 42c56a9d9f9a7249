#define VOXSHELL_ISA portable
#include "simd/grid_sampling_body.h"

namespace voxshell::simd {

const GridSampling<GridView> kPortableGridSampling = portable::kGridSamplingOf<GridView>;
const GridSampling<ExactGridView> kPortableExactGridSampling =
    portable::kGridSamplingOf<ExactGridView>;

}  // namespace voxshell::simd
