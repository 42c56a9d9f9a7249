#pragma once

#include <functional>
#include <string_view>

namespace voxshell {

/// A long build calls this from the calling thread at intervals, with the stage's name and the
/// fraction of it that is done (0 to 1). Return false to stop the build with Error kCanceled.
using Progress = std::function<bool(std::string_view stage, double fraction)>;

}  // namespace voxshell
