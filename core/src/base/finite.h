#pragma once

#include <cmath>
#include <cstddef>
#include <span>

#include "voxshell/vector.h"

namespace voxshell {

/// Whether all magnitudes are at most `limit`: none infinite, none not a number.
template <class T>
bool are_within(std::span<const T> values, T limit) {
  // Without a branch, so that it takes many at a time.
  std::size_t beyond = 0;
  for (const T value : values) beyond += std::abs(value) <= limit ? 0u : 1u;
  return beyond == 0;
}

/// The coordinates of all vectors, one after the other.
template <class T>
std::span<const T> coordinates(std::span<const Vector3<T>> vectors) {
  static_assert(sizeof(Vector3<T>) == 3 * sizeof(T));
  return {vectors.empty() ? nullptr : &vectors.front().x, 3 * vectors.size()};
}

}  // namespace voxshell
