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
constexpr std::uint64_t kOrdinary = 0;  // of FPCR
constexpr std::uint64_t kFlags = 0;     // they are in FPSR

std::uint64_t read_state() {
  std::uint64_t state = 0;
  asm volatile("mrs %0, fpcr" : "=r"(state));
  return state;
}
void write_state(std::uint64_t state) { asm volatile("msr fpcr, %0" : : "r"(state) : "memory"); }
#else
constexpr std::uint64_t kOrdinary = FE_TONEAREST;
constexpr std::uint64_t kFlags = 0;

std::uint64_t read_state() { return static_cast<std::uint64_t>(std::fegetround()); }
void write_state(std::uint64_t state) { std::fesetround(static_cast<int>(state)); }
#endif

}  // namespace

OrdinaryFloats::OrdinaryFloats() : found_(read_state()) {
  if ((found_ & ~kFlags) != kOrdinary) write_state(kOrdinary);
}

OrdinaryFloats::~OrdinaryFloats() {
  if (read_state() != found_) write_state(found_);
}

}  // namespace voxshell
