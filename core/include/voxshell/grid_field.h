#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "voxshell/bounds.h"
#include "voxshell/progress.h"
#include "voxshell/result.h"
#include "voxshell/triangle_mesh.h"
#include "voxshell/vector.h"

namespace voxshell {

namespace simd {
struct GridView;
struct ExactGridView;
}  // namespace simd

/// How to decide what is inside a mesh.
enum class SignMethod {
  kAutomatic,  ///< kClosed if the mesh is closed, otherwise kWinding
  kClosed,     ///< by the surface's crossings of grid rows; refuses any other mesh
  kWinding,    ///< where the generalized winding number is above a half: any mesh
};

/// How the signs were decided, and the defects found.
struct SignReport {
  SignMethod method = SignMethod::kClosed;
  /// 1 if the mesh is closed; otherwise the fraction of the mesh's area on both of whose sides the
  /// winding number is not near a half.
  double confidence = 1.0;
  bool was_turned = false;  ///< the mesh was inside out as a whole
  MeshDefects defects;      ///< open, non-manifold and wrongly oriented edges
  /// Grid nodes enclosed more than once or inside out, as far as the build looked for them.
  std::size_t overlaps = 0;
  std::size_t hidden_triangles = 0;  ///< left out of distances: inside on both sides
  Vec3 first_location{};             ///< of any of these defects, meters
  double cap_error = 0.0;  ///< the surface's uncertainty across holes, meters; 0: no holes
};

struct GridFieldSettings {
  double voxel_size = 0.0;  ///< edge of a cell, meters
  /// If samples near the surface are off by more than this, meters, cells hold the nearest
  /// triangles instead. 0: samples alone.
  double tolerance = 0.0;
  /// Thickness of the body's thinnest walls, meters. With a tolerance, normals are correct up to
  /// the middle of the walls, if that is no deeper than a brick. 0: within two voxels of the
  /// surface.
  double wall_thickness = 0.0;
  double padding = 0.0;  ///< meters of grid beyond the mesh's bounds; at least a brick is kept
  SignMethod sign = SignMethod::kAutomatic;
  unsigned threads = 0;  ///< 0: one per core; any number gives the same result
  std::size_t memory_limit = std::size_t{4} << 30;  ///< bytes; a larger grid is refused
};

/// Fine cells whose distance is that to the nearest of a few triangles. simd/exact_view.h explains
/// the arrays.
struct ExactCells {
  std::vector<std::uint32_t> bricks;  ///< one per brick, or none if no cell is exact
  std::vector<std::uint32_t> masks;
  std::vector<std::uint32_t> lists;
  std::vector<std::uint32_t> listed;
  std::vector<float> triangles;
  std::vector<float> feature_normals;

  std::size_t count() const { return lists.size(); }
  std::size_t nbytes() const {
    return 4 * (bricks.size() + masks.size() + lists.size() + listed.size() + triangles.size() +
                feature_normals.size());
  }
};

/// The contents of a grid field, as its file holds them. simd/grid_view.h explains the bits of the
/// entries. Meters, the mesh's frame.
struct GridFieldData {
  double voxel_size = 0.0;
  Vec3 origin{};                ///< of the first node
  std::array<int, 3> bricks{};  ///< along x, y, z
  Bounds surface_bounds;
  std::vector<std::uint32_t> entries;  ///< one per brick, x fastest
  std::vector<std::int16_t> samples;
  int quanta_per_voxel = 256;  ///< of samples at scale exponent 0; a power of two
  std::vector<float> planes;   ///< unit normal and offset of each
  double node_error = 0.0;     ///< meters; see simd::GridView
  /// Of a field by tolerance, meters; 0 for others. See GridField::surface_error().
  double surface_error = 0.0;
  /// Of cells of 2, 4 and 8 voxels; meters; see simd::GridView.
  std::array<double, 3> coarse_floors{};
  SignReport sign;
  ExactCells exact;

  /// The true distances of two nodes d apart differ by at most sqrt(d^2 + gap), meters^2: across
  /// holes the surface is known only to that.
  double gap() const { return sign.cap_error * sign.cap_error; }
  /// Surface near a plane that does not belong to it is at least this far away, meters.
  double plane_margin() const { return 4.0 * voxel_size; }
};

/// One number for each of eight points.
using EightFloats = std::array<float, 8>;

/// Coordinates of eight points. Meters, the field's frame.
struct EightPoints {
  std::array<EightFloats, 3> coordinates{};  ///< x, y, z

  void set(std::size_t i, const Vec3f& p) {
    coordinates[0][i] = p.x;
    coordinates[1][i] = p.y;
    coordinates[2][i] = p.z;
  }
};

/// The signed distance field of a mesh on a sparse regular grid. Negative inside; meters, the
/// mesh's frame.
///
/// The grid consists of bricks of 8x8x8 cells. A brick near the surface holds the true distances at
/// its 9x9x9 nodes, to 1/512 voxel. Farther away it may hold fewer nodes, down to its corners. If
/// all its distances are those to one plane, it holds the plane. Values between nodes are
/// trilinear. A field by tolerance is eight times finer. Cells that trilinear values cannot follow
/// (creases, thin walls) hold the few triangles that are nearest to them, and are exact.
///
/// Outside the grid, the field extrapolates from the nearest point of the grid. Its error there is
/// at most that point's distance from the surface, plus the point's own error. For D(q), the
/// distance of the nearest point q of the grid, the true distance of p is between
/// sqrt(|p - q|^2 + D(q)^2) and |p - q| + D(q).
class GridField {
 public:
  /// Errors: kInvalidArgument; kInvalidMesh (the mesh encloses nothing; or it must be closed, but
  /// is open, inside out or overlaps itself); kTooLarge; kCanceled.
  static Result<GridField> build(const TriangleMesh& mesh, const GridFieldSettings& settings,
                                 const Progress& progress = {});

  /// `data` must come from data() of a field, or have passed the same checks.
  explicit GridField(GridFieldData data);
  GridField(const GridField& other);
  GridField& operator=(const GridField& other);
  GridField(GridField&& other) noexcept;
  GridField& operator=(GridField&& other) noexcept;
  ~GridField();

  float distance(const Vec3f& p) const;

  /// The exact gradient of distance() in the grid; its length is near 1 except close to the medial
  /// axis. Unit length outside.
  Vec3f gradient(const Vec3f& p) const;

  /// No point within `radius` of `center` has a smaller distance.
  float lower_bound(const Vec3f& center, float radius) const;

  /// The same for eight points or balls at once: the same bits, in about the time of one.
  EightFloats distances(const EightPoints& points) const;
  struct BallValues {
    EightFloats distance;  ///< of the center
    EightFloats lower_bound;
  };
  BallValues bound_balls(const EightPoints& centers, const EightFloats& radii) const;

  double reach() const;

  double voxel_size() const { return data_.voxel_size; }
  const Vec3& origin() const { return data_.origin; }  ///< position of the first node
  std::array<int, 3> shape() const;                    ///< nodes along x, y, z
  std::size_t nbytes() const;
  const Bounds& surface_bounds() const { return data_.surface_bounds; }

  /// |distance() - true distance| is at most this near the surface, meters. This is a proof, far
  /// above what Model::accuracy() measures: the true distance is 1-Lipschitz, and the corners of a
  /// cell are at most sqrt(3)/2 voxel from a point of it in the trilinear mean. For bricks with
  /// fewer nodes, the bound scales with their larger cells.
  double interpolation_error() const {
    return std::sqrt(0.75) * data_.voxel_size + data_.node_error + data_.sign.cap_error;
  }

  /// Largest distance from the surface at which field and mesh disagree on what is inside, meters.
  /// This is proven: cell by cell when a field by tolerance is built (decision 0028); for others it
  /// is interpolation_error().
  double surface_error() const {
    return data_.surface_error > 0.0 ? data_.surface_error : interpolation_error();
  }

  const SignReport& sign_report() const { return data_.sign; }

  const GridFieldData& data() const { return data_; }
  const simd::GridView& view() const;

  /// Whether any cells are exact. If so, use this view of the field.
  bool has_exact_cells() const { return !data_.exact.bricks.empty(); }
  const simd::ExactGridView& exact_view() const { return *view_; }

 private:
  GridField(GridFieldData data, std::uint64_t serial);
  template <class Visit>
  auto with_view(const Visit& visit) const;

  GridFieldData data_;
  std::unique_ptr<const simd::ExactGridView> view_;  ///< of data_, for kernels
};

}  // namespace voxshell
