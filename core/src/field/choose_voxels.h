#pragma once

#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// The voxel size of a field that is exact to a tolerance, meters: fine enough that samples follow
/// most of the surface, as exact cells take several times as long; coarse where finer ones would
/// not help, as in plates thinner than voxels, or would take too much memory.
double choose_voxels(const TriangleMesh& mesh, double tolerance, unsigned threads);

}  // namespace voxshell
