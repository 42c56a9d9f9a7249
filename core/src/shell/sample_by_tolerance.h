#pragma once

#include "base/stage.h"
#include "mesh/surface_cutter.h"
#include "shell/shell_samples.h"
#include "voxshell/point_shell.h"
#include "voxshell/result.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// Samples a mesh as densely as its curvature asks for, and adds corners and sharp edges, so that a
/// shell misses no more depth than the settings' tolerance. Samples only what is visible of the
/// mesh, or all of it if `visible` is null. Errors: kTooLarge, kCanceled.
Result<ShellSamples> sample_by_tolerance(const TriangleMesh& mesh, const VisibleSurface* visible,
                                         const PointShellSettings& settings, Stage& stage);

}  // namespace voxshell
