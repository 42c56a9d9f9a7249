#pragma once

#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// The thickness of the mesh's walls where they are thinnest, meters: the first percentile, by
/// area, of the lengths of chords that begin on the surface, go straight in and leave through a
/// face that is opposite to within 30 degrees. What lies inside other parts of the mesh is no
/// surface. At most the shortest side of the bounds.
double compute_thickness(const TriangleMesh& mesh);

}  // namespace voxshell
