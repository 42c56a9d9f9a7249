#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <map>
#include <span>
#include <utility>

#include "field/brick_entry.h"
#include "field/brick_grid.h"
#include "mesh/row_winding.h"
#include "mesh/surface_cutter.h"

namespace voxshell {

/// Says which nodes of a grid are inside a mesh, as the number of layers that enclose them.
class Inside {
 public:
  virtual ~Inside() = default;

  /// At the corners of bricks along a row.
  virtual void find_corners(std::size_t brick_y, std::size_t brick_z,
                            std::span<int> layers) const = 0;

  /// At the 9^3 nodes of a brick, whose unsigned distances are given in voxels.
  virtual void find_nodes(const std::array<std::size_t, 3>& brick, std::span<const float> distances,
                          std::span<int> layers) const = 0;
};

/// Of closed meshes, by their crossings of rows.
class InsideByRows : public Inside {
 public:
  InsideByRows(const BrickGrid& grid, const RowWinding& winding) : grid_(grid), winding_(winding) {}
  /// Of meshes that overlap themselves: what is enclosed several times counts once, what is inside
  /// out not at all. Gaps narrower than `rounding`, meters, are none.
  InsideByRows(const BrickGrid& grid, const RowWinding& winding, double rounding)
      : grid_(grid), winding_(winding), is_union_(true), rounding_(rounding) {}

  void find_corners(std::size_t brick_y, std::size_t brick_z, std::span<int> layers) const override;
  void find_nodes(const std::array<std::size_t, 3>& brick, std::span<const float> distances,
                  std::span<int> layers) const override;

 private:
  void compute(std::size_t row, std::span<const double> x, std::span<int> layers) const;

  const BrickGrid& grid_;
  const RowWinding& winding_;
  bool is_union_ = false;
  double rounding_ = 0.0;
};

/// Which nodes of a brick are inside, by their winding numbers.
struct BrickSides {
  static constexpr std::size_t kNodes = cube(std::size_t{simd::kBrickCells} + 1);
  std::bitset<kNodes> is_inside;
  std::bitset<kNodes> is_clear;  ///< the number is not near a half
};

/// By the winding numbers of the nodes, x fastest.
BrickSides decide_sides(std::span<const double> numbers);

/// Those of some bricks, by the bricks' numbers in the grid.
using KnownSides = std::map<std::size_t, BrickSides>;

/// Of any mesh, by generalised winding numbers: inside is what has one above a half. Nodes that are
/// nearer to one another than to the surface lie on one side of it, so that few need their own.
class InsideByWindingNumbers : public Inside {
 public:
  InsideByWindingNumbers(const BrickGrid& grid, const Bounds& bounds, const SurfaceCutter& surface)
      : grid_(grid), bounds_(bounds), surface_(surface) {}

  /// Sides that need not be found again.
  void remember(KnownSides sides) { known_ = std::move(sides); }

  /// The winding numbers at places, meters, where they may be above a half, and 0 elsewhere.
  void compute(std::span<const Vec3> places, std::span<double> numbers) const;

  void find_corners(std::size_t brick_y, std::size_t brick_z, std::span<int> layers) const override;
  void find_nodes(const std::array<std::size_t, 3>& brick, std::span<const float> distances,
                  std::span<int> layers) const override;

 private:
  const BrickGrid& grid_;
  Bounds bounds_;
  const SurfaceCutter& surface_;
  KnownSides known_;
};

}  // namespace voxshell
