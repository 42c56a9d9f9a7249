#include "voxshell/ordinary_floats.h"

#include <cfenv>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "voxshell/parallel.h"

namespace voxshell::ordinary_floats_test {
namespace {

/// Read anew at each use: not worked out by the compiler.
volatile float third_of = 1.0f;

float third() { return third_of / 3.0f; }

TEST(OrdinaryFloats, RoundToNearestAndLeaveTheModeAsFound) {
  const float to_nearest = third();
  for (const int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
    ASSERT_EQ(std::fesetround(mode), 0);
    {
      const OrdinaryFloats floats;
      EXPECT_EQ(third(), to_nearest);
    }
    EXPECT_EQ(std::fegetround(), mode);
  }
  std::fesetround(FE_TONEAREST);
}

TEST(OrdinaryFloats, LeaveFlagsAsFound) {
  std::feclearexcept(FE_ALL_EXCEPT);
  {
    const OrdinaryFloats floats;
    EXPECT_GT(third(), 0.0f);
  }
  EXPECT_EQ(std::fetestexcept(FE_INEXACT), 0);

  std::feraiseexcept(FE_DIVBYZERO);
  std::fesetround(FE_UPWARD);
  {
    const OrdinaryFloats floats;
    EXPECT_GT(third(), 0.0f);
  }
  std::fesetround(FE_TONEAREST);
  EXPECT_EQ(std::fetestexcept(FE_INEXACT | FE_DIVBYZERO), FE_DIVBYZERO);
  std::feclearexcept(FE_ALL_EXCEPT);
}

#if defined(__x86_64__) || defined(__aarch64__)
#if defined(__x86_64__)
constexpr std::uint64_t kFlush = 0x8040;  // of MXCSR: results and operands

std::uint64_t read_control() { return __builtin_ia32_stmxcsr(); }
void write_control(std::uint64_t control) {
  __builtin_ia32_ldmxcsr(static_cast<unsigned>(control));
}
#else
constexpr std::uint64_t kFlush = 1u << 24;  // of FPCR

std::uint64_t read_control() {
  std::uint64_t control = 0;
  asm volatile("mrs %0, fpcr" : "=r"(control) : : "memory");
  return control;
}
void write_control(std::uint64_t control) {
  asm volatile("msr fpcr, %0" : : "r"(control) : "memory");
}
#endif

volatile float smallest_normal = 1.17549435e-38f;
float half_of_smallest_normal() { return smallest_normal * 0.5f; }

TEST(OrdinaryFloats, KeepDenormalNumbersAndLeaveFlushToZeroAsFound) {
  const std::uint64_t before = read_control();
  write_control(before | kFlush);
  EXPECT_EQ(half_of_smallest_normal(), 0.0f);
  {
    const OrdinaryFloats floats;
    EXPECT_GT(half_of_smallest_normal(), 0.0f);
  }
  EXPECT_EQ(half_of_smallest_normal(), 0.0f);
  write_control(before);
}
#endif

TEST(OrdinaryFloats, HelperThreadsHaveThem) {
  const float to_nearest = third();
  std::fesetround(FE_UPWARD);
  std::vector<float> thirds(1000);
  parallel_for(thirds.size(), 4, "", {}, [&](std::size_t i) { thirds[i] = third(); });
  const int mode = std::fegetround();
  std::fesetround(FE_TONEAREST);
  EXPECT_EQ(mode, FE_UPWARD);
  for (const float each : thirds) EXPECT_EQ(each, to_nearest);
}

}  // namespace
}  // namespace voxshell::ordinary_floats_test
