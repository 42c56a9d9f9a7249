#pragma once

#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// The thickness of the mesh where it is thinnest, metres: the first percentile, by area, of the
/// lengths of chords that begin on the surface and go straight in. Of open meshes, at most the
/// shortest side of the bounds.
double compute_thickness(const TriangleMesh& mesh);

}  // namespace voxshell
