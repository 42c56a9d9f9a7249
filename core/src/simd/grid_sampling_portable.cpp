#define VOXSHELL_ISA portable
#include "simd/grid_sampling_body.h"

namespace voxshell::simd {

const GridSampling<GridView> kPortableGridSampling{portable::measure_distances<GridView>,
                                                   portable::bound_balls<GridView>};
const GridSampling<ExactGridView> kPortableExactGridSampling{
    portable::measure_distances<ExactGridView>, portable::bound_balls<ExactGridView>};

}  // namespace voxshell::simd
