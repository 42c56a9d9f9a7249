#include "simd/isa.h"

#include <cstdlib>
#include <cstring>

namespace voxshell::simd {
namespace {

Isa choose_isa() {
#ifdef VOXSHELL_HAS_AVX2
  // NOLINTNEXTLINE(concurrency-mt-unsafe): read once, and nothing here writes the environment
  const char* forced = std::getenv("VOXSHELL_FORCE_ISA");
  const bool may_be_wide = forced == nullptr || std::strcmp(forced, name(Isa::kPortable)) != 0;
  if (may_be_wide && __builtin_cpu_supports("avx2")) return Isa::kAvx2;
#endif
  return Isa::kPortable;
}

}  // namespace

Isa active_isa() {
  static const Isa isa = choose_isa();
  return isa;
}

const char* name(Isa isa) { return isa == Isa::kAvx2 ? "avx2" : "portable"; }

}  // namespace voxshell::simd
