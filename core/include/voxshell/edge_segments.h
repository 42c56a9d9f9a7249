#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "voxshell/point_sphere_tree.h"
#include "voxshell/result.h"
#include "voxshell/vector.h"

namespace voxshell {

namespace simd {
struct EdgeView;
}

/// Sharp edges of a mesh, cut into short straight pieces: the elements of a shell that points alone
/// would miss. Meters, the mesh's frame.
///
/// A piece is its middle, which the tree holds, and half of the vector from one end to the other.
/// Queries find the place of the least distance along each piece by samples, as a function of the
/// pose alone.
class EdgeSegments {
 public:
  /// A straight edge before it is cut.
  struct Edge {
    Vec3 from;
    Vec3 to;
    Vec3 normal;  ///< the mean of the two faces', unit length
  };

  /// Longest half of a piece, in tolerances. Samples along a piece are then two tolerances apart.
  static constexpr double kHalfPerTolerance = 7.0;
  static constexpr std::size_t kMostPieces = 50'000;  ///< unless there are more edges than that

  /// Cuts `edges`, at least one. If they would give more than kMostPieces, pieces are longer.
  static EdgeSegments build(std::span<const Edge> edges, double tolerance, unsigned threads = 0);

  /// The results of the functions below.
  struct Parts {
    PointSphereTree tree;  ///< of the middles
    std::vector<Vec3f> halves;
    std::vector<Vec3f> normals;
    double tolerance = 0.0;
  };

  /// Checks the data: equal counts, finite values, normals of unit length or zero. Error:
  /// kInvalidArgument.
  static Result<EdgeSegments> from_parts(Parts parts);

  std::size_t size() const { return tree_.point_count(); }
  BucketPoints middles() const { return tree_.points(); }
  std::span<const Vec3f> halves() const { return halves_; }  ///< from the middle to an end
  std::span<const Vec3f> normals() const { return normals_; }
  const PointSphereTree& tree() const { return tree_; }
  double tolerance() const { return tolerance_; }

  /// No end of a piece is farther than this from its middle.
  float reach() const { return reach_; }

  /// Error bound in fields whose distances change by at most the distance between two places: no
  /// place of a piece is deeper than the place that queries find by more than this and tie().
  double bracket() const;

  /// Places whose distances differ by less than this count as equally deep. The contact is the
  /// middle of them, so an edge that lies flat touches with its middle.
  float tie() const { return static_cast<float>(tolerance_ / 8.0); }

  std::size_t nbytes() const;
  simd::EdgeView view() const;

 private:
  EdgeSegments() = default;
  void measure_reach();

  PointSphereTree tree_;
  std::vector<Vec3f> halves_;
  std::vector<Vec3f> normals_;
  double tolerance_ = 0.0;
  float reach_ = 0.0f;
};

}  // namespace voxshell
