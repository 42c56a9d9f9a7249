#pragma once

#include <algorithm>

namespace voxshell {

/// The lexicographical order of two arrays. Operator < of libstdc++ before 12.4 looks at a fraction
/// of the bytes of unsigned numbers on big-endian machines (PR libstdc++/113960).
struct ComesBefore {
  template <class Range>
  bool operator()(const Range& a, const Range& b) const {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  }
};

}  // namespace voxshell
