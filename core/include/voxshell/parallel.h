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
/// `begin_helper` (may be empty) is called first on each thread but the caller's, and may not
/// throw. Memory is set aside for it: it should touch thread_local variables of the caller's
/// library, as glibc ends a process that has no memory for them when a thread first does.
bool parallel_for(std::size_t count, unsigned threads, std::string_view stage,
                  const Progress& progress, const std::function<void(std::size_t)>& task,
                  const std::function<void()>& begin_helper = {});

/// Likewise calls `task(begin, end)` for ranges of `size` indices, of which the last may be
/// shorter, that together are those below `count`.
bool parallel_for_ranges(std::size_t count, std::size_t size, unsigned threads,
                         std::string_view stage, const Progress& progress,
                         const std::function<void(std::size_t, std::size_t)>& task);

}  // namespace voxshell
