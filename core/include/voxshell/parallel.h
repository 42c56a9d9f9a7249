#pragma once

#include <cstddef>
#include <functional>
#include <string_view>

#include "voxshell/progress.h"

namespace voxshell {

/// Calls `task(i)` for every i below `count`, on `threads` threads (0: one a core). Tasks must not
/// depend on one another. `progress` (may be empty) is called from the calling thread only.
/// Returns false where progress asked to stop; tasks not yet begun are then left out. The first
/// exception of a task, on whatever thread, does the same and arrives at the caller.
bool parallel_for(std::size_t count, unsigned threads, std::string_view stage,
                  const Progress& progress, const std::function<void(std::size_t)>& task);

}  // namespace voxshell
