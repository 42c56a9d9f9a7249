#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <string_view>

#include "of_this_thread.h"
#include "voxshell/parallel.h"

namespace voxshell::bullet {

/// Calls `task(i)` for every i below `count`, on as many of `threads` threads as have at least
/// `of_thread` tasks each. Tasks must not depend on one another.
inline void run_on_threads(std::size_t count, unsigned threads, std::size_t of_thread,
                           std::string_view stage, const std::function<void(std::size_t)>& task) {
  const std::size_t most =
      std::max<std::size_t>(std::min<std::size_t>(threads, count / of_thread), 1);
  // All thread_local variables of a library exist as soon as the thread touches one of them.
  const auto begin_thread = [] { static_cast<void>(ThreadObjects::of_this_thread()); };
  parallel_for(count, static_cast<unsigned>(most), stage, {}, task, begin_thread);
}

}  // namespace voxshell::bullet
