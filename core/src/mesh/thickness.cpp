#include "mesh/thickness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "mesh/box_hierarchy.h"
#include "mesh/surface_places.h"
#include "voxshell/bounds.h"

namespace voxshell {
namespace {

using namespace simd::portable;

constexpr double kNone = std::numeric_limits<double>::infinity();
/// The faces of a wall are parallel to within 30 degrees: cosine. Next to the edge of a blunter
/// wedge a body is as thin as one likes.
constexpr double kOpposite = 0.8660254037844386;

struct Ray {
  Vec3 origin;
  Vec3 direction;  ///< unit length
};

/// How far along a ray it enters boxes.
class BoxEntry {
 public:
  explicit BoxEntry(const Ray& ray) {
    // A ray that is square to an axis counts as slightly slanted.
    constexpr float kLeast = 1e-20f;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int i = static_cast<int>(axis);
      origin_[axis] = static_cast<float>(ray.origin[i]);
      const auto along = static_cast<float>(ray.direction[i]);
      inverse_[axis] = 1.0f / (std::abs(along) < kLeast ? kLeast : along);
    }
  }

  /// Infinite for boxes that it misses.
  F8 operator()(const BoxHierarchy::Node& node) const {
    constexpr float kRounding = 1.0f + 1e-5f;
    const F8 infinite = splat<F8>(std::numeric_limits<float>::infinity());
    F8 first{};
    F8 last = infinite;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const F8 a = (node.lower[axis] - origin_[axis]) * inverse_[axis];
      const F8 b = (node.upper[axis] - origin_[axis]) * inverse_[axis];
      first = maximum(first, minimum(a, b));
      last = minimum(last, maximum(a, b));
    }
    return select((first <= last * kRounding) & (node.lower[0] <= node.upper[0]), first, infinite);
  }

 private:
  std::array<float, 3> origin_{};
  std::array<float, 3> inverse_{};
};

/// Where a ray leaves the body through a triangle, or enters it.
struct Crossing {
  double at = kNone;  ///< signed distance along the ray; kNone where it misses the triangle
  bool leaves = false;
  const std::array<Vec3, 3>* triangle = nullptr;
};

/// After Möller and Trumbore (1997). Edges count as part of both of their triangles.
Crossing cross_triangle(const Ray& ray, const std::array<Vec3, 3>& triangle) {
  constexpr double kSlack = 1e-9;
  const Vec3 ab = triangle[1] - triangle[0];
  const Vec3 ac = triangle[2] - triangle[0];
  const Vec3 p = cross(ray.direction, ac);
  const double facing = dot(ab, p);  // below 0 where the ray leaves
  if (facing == 0.0) return {};
  const double scale = 1.0 / facing;
  const Vec3 from = ray.origin - triangle[0];
  const double u = scale * dot(from, p);
  const Vec3 q = cross(from, ab);
  const double v = scale * dot(ray.direction, q);
  if (!(u >= -kSlack && v >= -kSlack && u + v <= 1.0 + kSlack)) return {};
  return {scale * dot(ac, q), facing < 0.0, &triangle};
}

/// Finds where rays leave a body.
class RayCaster {
 public:
  RayCaster(const TriangleMesh& mesh, bool inside_out)
      : order_(order_triangles(mesh)),
        corners_(collect(mesh, order_, inside_out)),
        hierarchy_(bound(corners_), compute_slack(mesh.bounds())) {
    ranks_.resize(order_.size());
    for (std::size_t i = 0; i < order_.size(); ++i) {
      ranks_[order_[i]] = static_cast<std::uint32_t>(i);
    }
  }

  /// How thick the wall is at a place of a triangle, square to it: as far as it is to where the
  /// body ends, through all of its parts that overlap or come as near to each other as
  /// `touching`, and at most `most`. `most`, too, where that is not the opposite face of a wall,
  /// or is nearer than `touching`. None where the place is inside another part of the body.
  std::optional<double> measure_wall(std::uint32_t triangle, const Vec3& place, double touching,
                                     double most) const {
    const auto& [a, b, c] = corners_[ranks_[triangle]];
    const Vec3 inward = -normalized(cross(b - a, c - a));
    // Of parts that touch, one may end or begin just before the place.
    std::vector<Crossing> crossings = find_crossings({place, inward}, -touching, triangle);
    const auto leaving = std::count_if(crossings.begin(), crossings.end(),
                                       [](const Crossing& crossing) { return crossing.leaves; });
    const auto entering = static_cast<std::ptrdiff_t>(crossings.size()) - leaving;
    if (leaving > entering + 1) return std::nullopt;

    const auto rank = [&](const Crossing& crossing) {
      return std::tuple(crossing.leaves ? crossing.at : crossing.at - touching, crossing.leaves,
                        crossing.triangle);
    };
    std::ranges::sort(crossings, {}, rank);
    int depth = 1;  // in how many parts
    for (const Crossing& crossing : crossings) {
      depth += crossing.leaves ? -1 : 1;
      if (depth > 0) continue;
      const auto& [d, e, f] = *crossing.triangle;
      const bool is_opposite = dot(inward, normalized(cross(e - d, f - d))) > kOpposite;
      return is_opposite && crossing.at >= touching ? std::min(crossing.at, most) : most;
    }
    return most;
  }

 private:
  /// From `first` on along the ray, of all triangles but `except`.
  std::vector<Crossing> find_crossings(const Ray& ray, double first, std::uint32_t except) const {
    std::vector<Crossing> crossings;
    const BoxEntry entry({ray.origin + first * ray.direction, ray.direction});
    hierarchy_.search(std::numeric_limits<float>::max(), entry, [&](std::size_t run) {
      const std::size_t begin = run * BoxHierarchy::kEach;
      const std::size_t end = std::min(begin + BoxHierarchy::kEach, corners_.size());
      for (std::size_t i = begin; i < end; ++i) {
        if (order_[i] == except) continue;
        const Crossing crossing = cross_triangle(ray, corners_[i]);
        if (crossing.at >= first && crossing.at < kNone) crossings.push_back(crossing);
      }
    });
    return crossings;
  }

  static std::vector<std::uint32_t> order_triangles(const TriangleMesh& mesh) {
    std::vector<Vec3> middles(mesh.triangles().size());
    for (std::size_t i = 0; i < middles.size(); ++i) {
      const auto [a, b, c] = mesh.corners(i);
      middles[i] = (a + b + c) / 3.0;
    }
    return order_by_place(middles);
  }

  static std::vector<std::array<Vec3, 3>> collect(const TriangleMesh& mesh,
                                                  const std::vector<std::uint32_t>& order,
                                                  bool inside_out) {
    std::vector<std::array<Vec3, 3>> corners;
    corners.reserve(order.size());
    for (const std::uint32_t triangle : order) {
      corners.push_back(mesh.corners(triangle));
      if (inside_out) std::swap(corners.back()[1], corners.back()[2]);
    }
    return corners;
  }

  /// Outweighs the rounding of places to float32.
  static double compute_slack(const Bounds& bounds) {
    constexpr double kRounding = 1e-6;
    return kRounding * (length(bounds.center()) + length(bounds.extents()));
  }

  static std::vector<Bounds> bound(const std::vector<std::array<Vec3, 3>>& corners) {
    std::vector<Bounds> boxes(corners.size());
    for (std::size_t i = 0; i < corners.size(); ++i) {
      for (const Vec3& corner : corners[i]) boxes[i].extend(corner);
    }
    return boxes;
  }

  std::vector<std::uint32_t> order_;          ///< triangle indices
  std::vector<std::uint32_t> ranks_;          ///< of each triangle in that order
  std::vector<std::array<Vec3, 3>> corners_;  ///< in that order
  BoxHierarchy hierarchy_;
};

}  // namespace

double compute_thickness(const TriangleMesh& mesh) {
  constexpr std::size_t kChords = 4096;
  constexpr double kFraction = 0.01;  // of the area that may be thinner
  constexpr double kTouching = 1e-7;  // of the longest side
  const Vec3 sides = mesh.bounds().extents();
  const double longest = sides[mesh.bounds().longest_axis()];
  const double shortest = std::max(std::min({sides.x, sides.y, sides.z}), kTouching * longest);

  const RayCaster caster(mesh, mesh.compute_volume() < 0.0);
  std::vector<double> chords;
  chords.reserve(kChords);
  const std::vector<std::uint32_t> faces = spread_over_faces(mesh, kChords);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const Vec3 place = place_on_triangle(mesh.corners(faces[i]), i);
    const auto chord = caster.measure_wall(faces[i], place, kTouching * longest, shortest);
    if (chord) chords.push_back(*chord);
  }
  if (chords.empty()) return shortest;
  const auto at =
      chords.begin() + static_cast<std::ptrdiff_t>(kFraction * static_cast<double>(chords.size()));
  std::nth_element(chords.begin(), at, chords.end());
  return *at;
}

}  // namespace voxshell
