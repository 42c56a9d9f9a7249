#include "base/checksum.h"

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include <gtest/gtest.h>

namespace voxshell::checksum_test {
namespace {

/// 0, 1, 2, ... 255, 0, 1, ...
std::vector<std::byte> make_bytes(std::size_t size) {
  std::vector<std::byte> bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::byte>(i % 256);
  return bytes;
}

std::uint64_t compute(std::span<const std::byte> bytes) {
  Checksum checksum;
  checksum.add(bytes);
  return checksum.value();
}

TEST(Checksum, IsXxh64) {
  // From XXH64 of libxxhash 0.8.1.
  EXPECT_EQ(Checksum{}.value(), 0xEF46DB3751D8E999u);
  EXPECT_EQ(compute(make_bytes(32)), 0xCBF59C5116FF32B4u);
  EXPECT_EQ(compute(make_bytes(64)), 0xF7C67301DB6713F0u);
  EXPECT_EQ(compute(make_bytes(4096)), 0x0F6E64BE186AF6A4u);
}

TEST(Checksum, DoesNotDependOnHowTheInputIsCut) {
  const auto bytes = make_bytes(960);
  const std::uint64_t whole = compute(bytes);
  for (std::size_t first = 0; first <= bytes.size(); first += Checksum::kStripe) {
    Checksum checksum;
    checksum.add(std::span(bytes).first(first));
    checksum.add(std::span(bytes).subspan(first));
    EXPECT_EQ(checksum.value(), whole);
  }
}

TEST(Checksum, ChangesWithEveryBit) {
  auto bytes = make_bytes(128);
  const std::uint64_t whole = compute(bytes);
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    const auto mask = std::byte{1} << static_cast<int>(bit % 8);
    bytes[bit / 8] ^= mask;
    EXPECT_NE(compute(bytes), whole);
    bytes[bit / 8] ^= mask;
  }
  EXPECT_NE(compute(std::vector<std::byte>(32)), compute(std::vector<std::byte>(64)));
}

}  // namespace
}  // namespace voxshell::checksum_test
