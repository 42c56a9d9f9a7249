#pragma once

#include <vector>

#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// The triangles of a mesh, cut where a vertex of an open edge lies amid another open edge
/// (T-junctions, as CAD programs write them): their sides then meet corner to corner, and what
/// looked open is closed. Other triangles stay as they are, in their order; pieces take the place
/// of their triangle. Nothing is cut where the mesh is so narrow that its edges lie amid one
/// another.
std::vector<Triangle> cut_at_t_vertices(const TriangleMesh& mesh);

}  // namespace voxshell
