#include "base/little_endian.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace voxshell::little_endian_test {
namespace {

std::vector<std::byte> make_bytes(std::initializer_list<int> values) {
  std::vector<std::byte> bytes;
  for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
  return bytes;
}

TEST(LittleEndian, NumbersHaveTheirLowestByteFirst) {
  const std::uint32_t number = little_endian(std::uint32_t{0x04030201});
  const auto bytes = std::bit_cast<std::array<std::byte, 4>>(number);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(bytes[i], static_cast<std::byte>(i + 1));
  EXPECT_EQ(little_endian(number), 0x04030201u);
}

TEST(LittleEndian, WordsAreReversedEachByItself) {
  auto bytes = make_bytes({1, 2, 3, 4, 5, 6, 7, 8});
  reverse_words(bytes, 2);
  EXPECT_EQ(bytes, make_bytes({2, 1, 4, 3, 6, 5, 8, 7}));
  reverse_words(bytes, 8);
  EXPECT_EQ(bytes, make_bytes({7, 8, 5, 6, 3, 4, 1, 2}));
  reverse_words(bytes, 1);
  EXPECT_EQ(bytes, make_bytes({7, 8, 5, 6, 3, 4, 1, 2}));
}

}  // namespace
}  // namespace voxshell::little_endian_test
