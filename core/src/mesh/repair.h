#pragma once

#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// A mesh without what only its bookkeeping has wrong.
struct RepairedMesh {
  TriangleMesh mesh;
  MeshDefects found;         ///< in the mesh as it was given
  bool is_closed = false;    ///< now
  bool is_balanced = false;  ///< now: at each edge as many triangles run one way as the other
};

/// Drops triangles that others repeat, facing the same way, unless that would open it, cuts those
/// amid whose open edges vertices of others lie, if that closes some, and turns
/// triangles so that neighbors agree: of what hangs together by edges of two triangles, those of
/// the smaller area. A surface that cannot be oriented, as a Moebius strip, stays as it is, and so
/// does one that is inside out as a whole. A closed mesh is returned as it was given.
RepairedMesh repair_mesh(const TriangleMesh& mesh);

/// Only measures.
RepairedMesh take_as_it_is(TriangleMesh mesh);

}  // namespace voxshell
