#pragma once

#include <cstddef>

#include "base/stage.h"
#include "shell/shell_samples.h"
#include "voxshell/result.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// Samples a mesh on the grid that gives a wanted number of points, within 1 %.
/// Errors: kInvalidArgument if no grid is found, kCanceled.
Result<ShellSamples> sample_by_target(const TriangleMesh& mesh, std::size_t target,
                                      unsigned threads, Stage& stage);

}  // namespace voxshell
