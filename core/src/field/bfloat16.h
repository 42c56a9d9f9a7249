#pragma once

#include <bit>
#include <cstdint>

namespace voxshell {

/// The largest bfloat16 that is at most `value`, and the smallest that is at least `value`, as the
/// upper halves of float32. `value` is finite.
inline std::uint32_t round_down_to_bfloat16(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const bool is_negative = (bits >> 31) != 0;
  return (is_negative ? bits + 0xffffu : bits) & 0xffff0000u;
}
inline std::uint32_t round_up_to_bfloat16(float value) {
  return round_down_to_bfloat16(-value) ^ 0x80000000u;
}

}  // namespace voxshell
