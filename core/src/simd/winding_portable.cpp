#define VOXSHELL_ISA portable
#include "simd/winding_body.h"

namespace voxshell::simd {

const WindingKernels kPortableWinding{portable::compute_winding_numbers};

}  // namespace voxshell::simd
