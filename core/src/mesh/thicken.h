#pragma once

#include "voxshell/result.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// The solid that an open surface becomes as a sheet of some thickness, meters: a copy of it half
/// the thickness to either side along the vertices' normals, and walls along its rims. Parts of the
/// mesh that are closed stay as they are.
///
/// Where more than two triangles meet at an edge, where the surface cannot be oriented, and along
/// sharp edges at vertices that no offset moves to one side of all faces, it is cut, and the sheets
/// overlap there. Error kInvalidMesh where nothing of it has an area.
Result<TriangleMesh> thicken(const TriangleMesh& mesh, double thickness);

}  // namespace voxshell
