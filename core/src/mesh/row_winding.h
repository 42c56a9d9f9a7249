#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// Parallels to the x axis at y = origin.y + j step, z = origin.z + k step.
struct RowGrid {
  Vec3 origin;
  double step;
  std::size_t rows_y;
  std::size_t rows_z;

  std::size_t count() const { return rows_y * rows_z; }
};

/// Winding numbers of a closed mesh along the rows of a grid: how many times the surface encloses a
/// point. They follow from the surface's crossings of the row, so they are right also where the
/// mesh folds over or meets itself, which defeats signs from normals.
class RowWinding {
 public:
  /// Error kInvalidMesh where a row enters the mesh more often than it leaves it: the mesh is open.
  static Result<RowWinding> build(const TriangleMesh& mesh, const RowGrid& rows);

  /// Winding numbers at ascending places `x` of row j + k rows_y, into `winding`.
  void compute(std::size_t row, std::span<const double> x, std::span<int> winding) const;

 private:
  struct Crossing {
    double x;
    int sign;  ///< 1 where the row leaves the mesh, -1 where it enters
  };

  std::vector<Crossing> crossings_;  ///< row by row, ascending by x
  std::vector<std::size_t> first_;   ///< of each row; one more at the end
};

}  // namespace voxshell
