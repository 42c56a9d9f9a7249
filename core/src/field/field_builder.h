#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "field/brick_grid.h"
#include "field/brick_plan.h"
#include "field/exact_cells.h"
#include "field/flat_regions.h"
#include "field/inside.h"
#include "mesh/distance_tree.h"
#include "voxshell/grid_field.h"
#include "voxshell/progress.h"
#include "voxshell/result.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// Places that lie in several layers of the mesh, or in one that is inside out.
struct OverlapCount {
  std::size_t places = 0;
  std::size_t of = 0;
  std::size_t inside = 0;  ///< of these
  Vec3 first{};

  void add(const OverlapCount& other) {
    if (places == 0) first = other.first;
    places += other.places;
    of += other.of;
    inside += other.inside;
  }
};

/// How finely a field holds distances, voxels.
struct Fineness {
  int quanta_per_voxel;
  double plane_tolerance;  ///< by which corners of a flat part may be off its plane
  double rounding;         ///< of what is worked out in float32
};

/// Fills the bricks of a field with the distances to a mesh, signed as `inside` says.
class FieldBuilder {
 public:
  /// `features` of the mesh are needed where a tolerance is given.
  FieldBuilder(const TriangleMesh& mesh, const BrickGridPlan& plan,
               const GridFieldSettings& settings, const Inside& inside, const Progress& progress,
               Features features);

  /// Returns the error that stopped it, if one did: kCanceled, kTooLarge, or kInvalidMesh where
  /// overlap() is not empty, which is seen as early as can be.
  std::optional<Error> build(GridFieldData& data);

  const OverlapCount& overlap() const { return overlap_; }

 private:
  std::optional<Error> check_overlap() const;
  bool measure_corners();
  bool plan_bricks();
  bool are_corners_shared() const;
  bool place_bricks(GridFieldData& data) const;
  bool fill_bricks(GridFieldData& data);
  void measure_coarse(const std::array<std::size_t, 3>& brick, const BrickPlan& plan,
                      std::span<const float> before, std::span<float> nodes) const;
  void sign_fine(const std::array<std::size_t, 3>& brick, std::span<float> nodes,
                 OverlapCount& overlap) const;

  const TriangleMesh& mesh_;
  const BrickGrid& grid_;
  const std::vector<std::uint8_t>& least_cells_;
  unsigned threads_;
  const Inside& inside_;
  const Progress& progress_;
  Fineness fineness_;
  FlatRegions flat_;
  DistanceTree tree_;
  CornerLattice lattice_;
  std::vector<BrickPlan> plans_;
  std::optional<ExactCellFinder> exact_;  ///< where a tolerance is given
  OverlapCount overlap_;
};

}  // namespace voxshell
