#pragma once

#include "mesh/surface_cutter.h"
#include "voxshell/accuracy.h"
#include "voxshell/grid_field.h"
#include "voxshell/point_shell.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// Measures on 100,000 places of the mesh's surface or slightly more: on faces by their area, along
/// edges by their length, and at vertices. `thickness` is compute_thickness() of the mesh. The
/// result is the same for any number of threads (0: one a core). Places that `cutter` says are
/// hidden are left out; null: there are none.
Accuracy measure_accuracy(const TriangleMesh& mesh, const GridField& field, const PointShell& shell,
                          double thickness, unsigned threads,
                          const SurfaceCutter* cutter = nullptr);

}  // namespace voxshell
