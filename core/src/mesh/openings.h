#pragma once

#include "voxshell/openings.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// The openings of a mesh, of which nothing was made yet.
Openings find_openings(const TriangleMesh& mesh);

/// Whether a mesh with such openings is a sheet rather than a solid with holes: its caps would be a
/// large fraction of the surface, or it is a tube, with mouths at two ends or more (decision 29).
bool suggest_sheet(const Openings& openings);

}  // namespace voxshell
