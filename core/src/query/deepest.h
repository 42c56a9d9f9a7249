#pragma once

#include <algorithm>
#include <cstddef>

#include "voxshell/contacts.h"

namespace voxshell {

/// Keeps the deepest `max_points` contacts, ties to the smaller id, and returns how many there are.
/// Ascending by id before and after.
inline std::size_t keep_deepest(Contact* contacts, std::size_t count, std::size_t max_points) {
  if (count <= max_points) return count;
  std::nth_element(contacts, contacts + max_points, contacts + count,
                   [](const Contact& a, const Contact& b) {
                     return a.depth != b.depth ? a.depth > b.depth : a.id < b.id;
                   });
  std::sort(contacts, contacts + max_points,
            [](const Contact& a, const Contact& b) { return a.id < b.id; });
  return max_points;
}

}  // namespace voxshell
