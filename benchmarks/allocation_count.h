#pragma once

#include <cstddef>

namespace voxshell::benchmarks {

/// How often this program has allocated so far, on any thread.
std::size_t allocation_count();

}  // namespace voxshell::benchmarks
