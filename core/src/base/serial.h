#pragma once

#include <atomic>
#include <cstdint>

namespace voxshell {

/// A number that no other caller in this process gets: tells immutable objects apart even where one
/// takes the address of another that is gone.
inline std::uint64_t next_serial() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

}  // namespace voxshell
