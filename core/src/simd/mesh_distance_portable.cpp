#define VOXSHELL_ISA portable
#include "simd/mesh_distance_body.h"

namespace voxshell::simd {

const MeshDistanceKernels kPortableMeshDistance{
    portable::find_nearest,   portable::find_blocks,    portable::measure_brick,
    portable::measure_listed, portable::compare_listed, portable::evaluate_listed};

}  // namespace voxshell::simd
