#include "base/comes_before.h"

#include <array>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace voxshell {
namespace {

TEST(ComesBefore, ComparesWholeNumbersInTheirOrder) {
  const ComesBefore before;
  using Three = std::array<std::uint32_t, 3>;
  EXPECT_TRUE(before(Three{1, 2, 3}, Three{1, 2, 4}));
  EXPECT_FALSE(before(Three{1, 2, 4}, Three{1, 2, 3}));
  EXPECT_FALSE(before(Three{1, 2, 3}, Three{1, 2, 3}));
  EXPECT_TRUE(before(Three{0x0201, 0, 0}, Three{0x0102'0000, 0, 0}));
  using Some = std::vector<std::uint32_t>;
  EXPECT_TRUE(before(Some{7}, Some{7, 0}));
  EXPECT_TRUE(before(Some{}, Some{0}));
  EXPECT_FALSE(before(Some{8}, Some{7, 9}));
}

}  // namespace
}  // namespace voxshell
