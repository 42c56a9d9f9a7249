#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <span>
#include <type_traits>

namespace voxshell {

/// Reverses the bytes of each word; the size must be a multiple of `word_size`.
inline void reverse_words(std::span<std::byte> bytes, std::size_t word_size) {
  for (; !bytes.empty(); bytes = bytes.subspan(word_size)) {
    std::ranges::reverse(bytes.first(word_size));
  }
}

/// From the order of this machine's words to that of files, and back.
inline void turn_little_endian(std::span<std::byte> bytes, std::size_t word_size) {
  if constexpr (std::endian::native == std::endian::big) reverse_words(bytes, word_size);
}

/// A number whose bytes lie as in files, and back.
template <class T>
  requires std::is_arithmetic_v<T>
T little_endian(T value) {
  auto bytes = std::bit_cast<std::array<std::byte, sizeof(T)>>(value);
  turn_little_endian(bytes, sizeof(T));
  return std::bit_cast<T>(bytes);
}

}  // namespace voxshell
