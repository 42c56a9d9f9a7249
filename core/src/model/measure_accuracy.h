#pragma once

#include "mesh/surface_cutter.h"
#include "voxshell/accuracy.h"
#include "voxshell/grid_field.h"
#include "voxshell/point_shell.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell {

struct AccuracySettings {
  double thickness = 0.0;  ///< compute_thickness() of the mesh
  double tolerance = 0.0;  ///< that the shell is to keep; 0: whatever it misses
  unsigned threads = 0;    ///< 0: one a core; the result is the same
};

/// Measures on 100,000 places of the mesh's surface or slightly more: on faces by their area, along
/// edges by their length, and at vertices. Those that the shell misses by more than the tolerance
/// become points of it. Places that do not bound the body, as `visible` has it, are left out; null:
/// there are none.
Accuracy measure_accuracy(const TriangleMesh& mesh, const GridField& field, PointShell& shell,
                          const AccuracySettings& settings,
                          const VisibleSurface* visible = nullptr);

}  // namespace voxshell
