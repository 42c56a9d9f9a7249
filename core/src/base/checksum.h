#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace voxshell {

/// XXH64 (Collet, xxHash specification 0.1.1) with seed 0, of input whose length is a multiple of
/// kStripe: the parts of our files are. Finds damage, not forgery. More than 5 GB/s on one core.
class Checksum {
 public:
  static constexpr std::size_t kStripe = 32;

  /// The size must be a multiple of kStripe.
  void add(std::span<const std::byte> bytes);

  /// Of all that was added.
  std::uint64_t value() const;

 private:
  static constexpr std::uint64_t kPrime1 = 0x9E3779B185EBCA87u;
  static constexpr std::uint64_t kPrime2 = 0xC2B2AE3D27D4EB4Fu;

  std::array<std::uint64_t, 4> lanes_{kPrime1 + kPrime2, kPrime2, 0, std::uint64_t{0} - kPrime1};
  std::uint64_t size_ = 0;
};

}  // namespace voxshell
