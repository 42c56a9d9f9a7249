#include "base/checksum.h"

#include <bit>
#include <cassert>
#include <cstring>

#include "base/little_endian.h"

namespace voxshell {
namespace {

constexpr std::uint64_t kPrime1 = 0x9E3779B185EBCA87u;
constexpr std::uint64_t kPrime2 = 0xC2B2AE3D27D4EB4Fu;
constexpr std::uint64_t kPrime3 = 0x165667B19E3779F9u;
constexpr std::uint64_t kPrime4 = 0x85EBCA77C2B2AE63u;
constexpr std::uint64_t kPrime5 = 0x27D4EB2F165667C5u;

std::uint64_t mix(std::uint64_t lane, std::uint64_t word) {
  return std::rotl(lane + word * kPrime2, 31) * kPrime1;
}

}  // namespace

void Checksum::add(std::span<const std::byte> bytes) {
  assert(bytes.size() % kStripe == 0);
  // On the stack the lanes stay in registers.
  std::array<std::uint64_t, 4> lanes = lanes_;
  for (std::size_t at = 0; at + kStripe <= bytes.size(); at += kStripe) {
    std::array<std::uint64_t, 4> words;
    std::memcpy(words.data(), bytes.data() + at, kStripe);
    for (std::size_t i = 0; i < words.size(); ++i) {
      lanes[i] = mix(lanes[i], little_endian(words[i]));
    }
  }
  lanes_ = lanes;
  size_ += bytes.size();
}

std::uint64_t Checksum::value() const {
  std::uint64_t hash = kPrime5;
  if (size_ > 0) {
    hash = std::rotl(lanes_[0], 1) + std::rotl(lanes_[1], 7) + std::rotl(lanes_[2], 12) +
           std::rotl(lanes_[3], 18);
    for (const std::uint64_t lane : lanes_) hash = (hash ^ mix(0, lane)) * kPrime1 + kPrime4;
  }
  hash += size_;
  hash = (hash ^ (hash >> 33)) * kPrime2;
  hash = (hash ^ (hash >> 29)) * kPrime3;
  return hash ^ (hash >> 32);
}

}  // namespace voxshell
