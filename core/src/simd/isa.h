#pragma once

namespace voxshell::simd {

/// Instruction sets that kernels are compiled for. All give the same bits.
enum class Isa { kPortable, kAvx2 };

/// The best that this processor has, or the one that the environment variable VOXSHELL_FORCE_ISA
/// names (portable, avx2), where the processor has that. Read once.
Isa active_isa();

const char* name(Isa isa);

}  // namespace voxshell::simd
