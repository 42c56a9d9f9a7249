#pragma once

#include "voxshell/accuracy.h"
#include "voxshell/grid_field.h"
#include "voxshell/point_shell.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// On at least 100,000 places of the mesh's surface. The same for any number of threads (0: one a
/// core).
Accuracy measure_accuracy(const TriangleMesh& mesh, const GridField& field, const PointShell& shell,
                          unsigned threads);

}  // namespace voxshell
