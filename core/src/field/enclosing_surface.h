#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "field/brick_grid.h"
#include "field/inside.h"
#include "mesh/surface_cutter.h"
#include "voxshell/progress.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// The boundary of what a mesh has inside by its winding numbers.
struct EnclosingSurface {
  TriangleMesh mesh;  ///< the part of the mesh that bounds it, and specks where holes are closed
  /// The part of the mesh that bounds it, where that is not all of the mesh.
  std::optional<VisibleSurface> visible;
  std::size_t hidden_triangles = 0;  ///< inside on both sides, wholly or in part
  Vec3 first_hidden{};               ///< the middle of the first of them, meters
  /// 0, or the steps that were too few to cut the mesh where it crosses itself: all there is then.
  std::size_t spent_steps = 0;
  std::size_t caps = 0;  ///< specks, about one a voxel of the surface across holes
  KnownSides sides;      ///< of the bricks through which the boundary was followed
  double confidence =
      0.0;  ///< fraction of the mesh's area that has no doubtful place on either side
};

/// Without a value where progress asked to stop, or where nothing is inside. Where the confidence
/// is below `least_confidence`, that is all there is. `cutter` is that of the mesh.
std::optional<EnclosingSurface> find_enclosing_surface(
    const TriangleMesh& mesh, const std::shared_ptr<const SurfaceCutter>& cutter,
    const BrickGrid& grid, const InsideByWindingNumbers& inside, double least_confidence,
    unsigned threads, const Progress& progress);

}  // namespace voxshell
