#define VOXSHELL_ISA avx2
#include "simd/winding_body.h"

namespace voxshell::simd {

const WindingKernels kAvx2Winding{avx2::compute_winding_numbers};

}  // namespace voxshell::simd
