#include "voxshell/ordinary_floats.h"

#if !defined(__x86_64__) && !defined(__aarch64__)
#include <cfenv>
#endif

namespace voxshell {
namespace {

#if defined(__x86_64__)
// Of MXCSR: all exceptions masked, to nearest, neither flush-to-zero nor denormals-are-zero.
constexpr std::uint64_t kOrdinary = 0x1f80;
constexpr std::uint64_t kFlags = 0x3f;  // of what has happened; they change no result

std::uint64_t read_state() { return __builtin_ia32_stmxcsr(); }
void write_state(std::uint64_t state) { __builtin_ia32_ldmxcsr(static_cast<unsigned>(state)); }
#elif defined(__aarch64__)
// FPCR in the lower half, FPSR, which holds flags alone, in the upper one.
constexpr std::uint64_t kOrdinary = 0;
constexpr std::uint64_t kFlags = 0xffff'ffff'0000'0000;

std::uint64_t read_state() {
  std::uint64_t control = 0;
  std::uint64_t status = 0;
  asm volatile("mrs %0, fpcr\n\tmrs %1, fpsr" : "=r"(control), "=r"(status) : : "memory");
  return status << 32 | (control & 0xffff'ffff);
}
void write_state(std::uint64_t state) {
  asm volatile("msr fpcr, %0\n\tmsr fpsr, %1"
               :
               : "r"(state & 0xffff'ffff), "r"(state >> 32)
               : "memory");
}
#else
// The rounding mode in the lower half, exceptions that have happened in the upper one.
constexpr std::uint64_t kOrdinary = FE_TONEAREST;
constexpr std::uint64_t kFlags = 0xffff'ffff'0000'0000;

std::uint64_t read_state() {
  return static_cast<std::uint64_t>(std::fetestexcept(FE_ALL_EXCEPT)) << 32 |
         static_cast<std::uint32_t>(std::fegetround());
}
void write_state(std::uint64_t state) {
  std::fesetround(static_cast<int>(state & 0xffff'ffff));
  // Exceptions only ever come in while the object lives.
  std::feclearexcept(FE_ALL_EXCEPT & ~static_cast<int>(state >> 32));
}
#endif

}  // namespace

OrdinaryFloats::OrdinaryFloats() : found_(read_state()) {
  if ((found_ & ~kFlags) != kOrdinary) write_state(kOrdinary | (found_ & kFlags));
}

OrdinaryFloats::~OrdinaryFloats() {
  if (read_state() != found_) write_state(found_);
}

}  // namespace voxshell
