#pragma once

#include "voxshell/grid_field.h"
#include "voxshell/progress.h"

namespace voxshell {

/// Works out `bounds` of a field whose bricks are filled. False where progress asked to stop.
bool compute_brick_bounds(GridFieldData& data, unsigned threads, const Progress& progress);

}  // namespace voxshell
