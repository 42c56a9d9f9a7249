#pragma once

#include <cstdio>
#include <string>

#include "voxshell/vector.h"

namespace voxshell {

/// printf into a string, for error messages. Without arguments the format is the text.
template <class... Args>
std::string format_text(const char* format, Args... args) {
  if constexpr (sizeof...(args) == 0) {
    return format;
  } else {
    const int size = std::snprintf(nullptr, 0, format, args...);
    std::string text(static_cast<std::size_t>(size), '\0');
    std::snprintf(text.data(), text.size() + 1, format, args...);
    return text;
  }
}

inline std::string format_point(const Vec3& p) {
  return format_text("[%.4g, %.4g, %.4g]", p.x, p.y, p.z);
}

}  // namespace voxshell
