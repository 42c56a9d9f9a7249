#include "voxshell/ordinary_floats.h"

#include <cfenv>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "base/parallel.h"

namespace voxshell {
namespace {

/// Read anew at each use: not worked out by the compiler.
volatile float third_of = 1.0f;
volatile float smallest_normal = 1.17549435e-38f;

float third() { return third_of / 3.0f; }
float half_of_smallest_normal() { return smallest_normal * 0.5f; }

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
}

#if defined(__x86_64__)
TEST(OrdinaryFloats, KeepDenormalNumbersAndLeaveFlushToZeroAsFound) {
  constexpr unsigned kFlushToZero = 0x8000;
  constexpr unsigned kDenormalsAreZero = 0x0040;
  const unsigned before = __builtin_ia32_stmxcsr();
  __builtin_ia32_ldmxcsr(before | kFlushToZero | kDenormalsAreZero);
  EXPECT_EQ(half_of_smallest_normal(), 0.0f);
  {
    const OrdinaryFloats floats;
    EXPECT_GT(half_of_smallest_normal(), 0.0f);
  }
  EXPECT_EQ(half_of_smallest_normal(), 0.0f);
  __builtin_ia32_ldmxcsr(before);
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
}  // namespace voxshell
