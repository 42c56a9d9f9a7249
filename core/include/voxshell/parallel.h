#pragma once

#include <cstddef>
#include <functional>
#include <string_view>

#include "voxshell/progress.h"

namespace voxshell {

/// Calls `task(i)` for every i below `count`, on `threads` threads (0: one per core). Tasks must
/// not depend on one another. `progress` (may be empty) is called from the calling thread only.
/// Returns false if progress asked to stop; tasks that have not begun are then skipped. The first
/// exception of a task, on any thread, also skips them and is rethrown to the caller.
bool parallel_for(std::size_t count, unsigned threads, std::string_view stage,
                  const Progress& progress, const std::function<void(std::size_t)>& task);

}  // namespace voxshell
