#pragma once

#include <cstddef>
#include <optional>

#include "field/brick_grid.h"
#include "field/inside.h"
#include "voxshell/progress.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// The boundary of what a mesh has inside by its winding numbers.
struct EnclosingSurface {
  TriangleMesh mesh;  ///< the mesh's own triangles that bound it, and specks where holes are closed
  std::size_t hidden_triangles = 0;  ///< left out: inside on both sides
  std::size_t caps = 0;              ///< specks, about one a voxel of the surface across holes
  double confidence = 0.0;  ///< share of the mesh's area that has no doubtful place on either side
};

/// Without a value where progress asked to stop, or where nothing is inside. Where the confidence
/// is below `least_confidence`, that is all there is.
std::optional<EnclosingSurface> find_enclosing_surface(const TriangleMesh& mesh,
                                                       const BrickGrid& grid,
                                                       const InsideByWindingNumbers& inside,
                                                       double least_confidence, unsigned threads,
                                                       const Progress& progress);

}  // namespace voxshell
