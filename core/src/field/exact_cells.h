#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "field/brick_grid.h"
#include "field/feature_normals.h"
#include "mesh/distance_tree.h"
#include "voxshell/grid_field.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// Finds the fine cells that samples cannot follow, and the triangles that are nearest in them.
class ExactCellFinder {
 public:
  /// `features` of the mesh; the first three outlive this.
  ExactCellFinder(const TriangleMesh& mesh, const BrickGrid& grid, const DistanceTree& tree,
                  const GridFieldSettings& settings, int quanta_per_voxel, Features features);

  /// The exact cells of one brick and their lists of triangles, ascending.
  struct Brick {
    std::size_t index = 0;
    std::vector<std::uint16_t> cells;  ///< x fastest, ascending
    std::vector<std::vector<std::uint32_t>> lists;
    float error = 0.0f;  ///< proved, of the other cells that the surface passes, voxels
  };

  /// Working memory of one thread.
  struct Work {
    std::vector<std::uint32_t> nearby;
    std::vector<float> distances;
    std::vector<std::uint8_t> may_be_nearest;
  };

  /// `nodes` are the signed distances of the brick's nodes, voxels, x fastest.
  Brick find(std::size_t index, std::span<const float> nodes, Work& work) const;

  /// Of bricks ascending by index.
  ExactCells assemble(std::span<const Brick> bricks) const;

 private:
  struct Cube {
    std::array<int, 3> first;  ///< cell
    int size;                  ///< cells
  };
  struct Job;
  void divide(Job& job, const Cube& cube, std::span<const std::uint32_t> triangles,
              Brick& brick) const;
  void decide(const Job& job, const Cube& cell, std::vector<std::uint32_t> triangles,
              Brick& brick) const;
  struct Look;
  Look look_at_parts(const Job& job, const Cube& cell, int parts,
                     std::vector<std::uint32_t>& triangles) const;
  bool is_wall_lost(const Job& job, const Cube& cell,
                    std::span<const std::uint32_t> triangles) const;
  bool are_signs_in_doubt(std::span<const std::uint32_t> triangles) const;
  bool is_continuous(const Job& job, const Cube& cell,
                     std::span<const std::uint32_t> triangles) const;

  const TriangleMesh& mesh_;
  const BrickGrid& grid_;
  const DistanceTree& tree_;
  float tolerance_;  ///< voxels
  float deep_;       ///< up to which cells are exact where depths have a ridge, voxels
  float quanta_per_voxel_;
  std::vector<float> records_;  ///< of triangles; see simd/exact_view.h
  Features features_;
};

}  // namespace voxshell
