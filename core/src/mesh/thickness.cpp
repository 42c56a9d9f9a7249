#include "mesh/thickness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "mesh/box_hierarchy.h"
#include "mesh/surface_places.h"
#include "voxshell/bounds.h"

namespace voxshell {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

struct Ray {
  Vec3 origin;
  Vec3 direction;  ///< unit length
  Vec3 inverse;    ///< of each component of the direction

  Ray(const Vec3& from, const Vec3& along)
      : origin(from), direction(along), inverse{1.0 / along.x, 1.0 / along.y, 1.0 / along.z} {}
};

/// How far along the ray it enters the box; kNone where it misses it or enters beyond `limit`.
double enter(const Ray& ray, const Bounds& box, double limit) {
  double first = 0.0;
  double last = limit;
  for (int axis = 0; axis < 3; ++axis) {
    const double lower = box.lower[axis] - ray.origin[axis];
    const double upper = box.upper[axis] - ray.origin[axis];
    if (!(lower <= upper)) return kNone;  // an empty box
    if (ray.direction[axis] == 0.0) {
      if (lower > 0.0 || upper < 0.0) return kNone;
      continue;
    }
    const double a = lower * ray.inverse[axis];
    const double b = upper * ray.inverse[axis];
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
  }
  return first <= last ? first : kNone;
}

/// Where the ray leaves the body through the triangle, as a distance along it; kNone elsewhere
/// (Möller and Trumbore 1997). Edges count as part of both of their triangles.
double leave(const Ray& ray, const std::array<Vec3, 3>& triangle) {
  constexpr double kSlack = 1e-9;
  const Vec3 ab = triangle[1] - triangle[0];
  const Vec3 ac = triangle[2] - triangle[0];
  const double facing = dot(ray.direction, cross(ab, ac));
  if (!(facing > 0.0)) return kNone;
  const Vec3 p = cross(ray.direction, ac);
  const double scale = 1.0 / dot(ab, p);
  const Vec3 from = ray.origin - triangle[0];
  const double u = scale * dot(from, p);
  const Vec3 q = cross(from, ab);
  const double v = scale * dot(ray.direction, q);
  if (!(u >= -kSlack && v >= -kSlack && u + v <= 1.0 + kSlack)) return kNone;
  return scale * dot(ac, q);
}

/// Finds where rays leave a body.
class RayCaster {
 public:
  RayCaster(const TriangleMesh& mesh, bool inside_out)
      : order_(order_triangles(mesh)),
        corners_(collect(mesh, order_, inside_out)),
        hierarchy_(bound(corners_)) {}

  /// The shortest way along the ray from `nearest` on, leaving out one triangle.
  double find_exit(const Ray& ray, double nearest, std::uint32_t except) const {
    double found = kNone;
    std::array<std::pair<std::size_t, double>, BoxHierarchy::kStack> stack{};
    std::size_t waiting = 0;
    stack[waiting++] = {BoxHierarchy::kRoot,
                        enter(ray, hierarchy_.box(BoxHierarchy::kRoot), kNone)};
    while (waiting > 0) {
      const auto [node, distance] = stack[--waiting];
      if (!(distance < found)) continue;
      if (hierarchy_.is_leaf(node)) {
        const std::size_t begin = hierarchy_.run_of(node) * BoxHierarchy::kRun;
        const std::size_t end = std::min(begin + BoxHierarchy::kRun, corners_.size());
        for (std::size_t i = begin; i < end; ++i) {
          if (order_[i] == except) continue;
          const double exit = leave(ray, corners_[i]);
          if (exit >= nearest && exit < found) found = exit;
        }
        continue;
      }
      const std::size_t left = 2 * node;
      const double to_left = enter(ray, hierarchy_.box(left), found);
      const double to_right = enter(ray, hierarchy_.box(left + 1), found);
      const bool left_first = to_left <= to_right;
      const std::pair first{left_first ? left : left + 1, std::min(to_left, to_right)};
      const std::pair second{left_first ? left + 1 : left, std::max(to_left, to_right)};
      if (second.second < found) stack[waiting++] = second;
      if (first.second < found) stack[waiting++] = first;
    }
    return found;
  }

 private:
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

  static BoxHierarchy bound(const std::vector<std::array<Vec3, 3>>& corners) {
    std::vector<Bounds> boxes(corners.size());
    for (std::size_t i = 0; i < corners.size(); ++i) {
      for (const Vec3& corner : corners[i]) boxes[i].extend(corner);
    }
    return BoxHierarchy(boxes);
  }

  std::vector<std::uint32_t> order_;          ///< triangle indices
  std::vector<std::array<Vec3, 3>> corners_;  ///< in that order
  BoxHierarchy hierarchy_;
};

}  // namespace

double compute_thickness(const TriangleMesh& mesh) {
  constexpr std::size_t kChords = 4096;
  constexpr double kShare = 0.01;     // of the area that may be thinner
  constexpr double kTouching = 1e-7;  // of the longest side: chords that do not leave the surface
  const Vec3 sides = mesh.bounds().extents();
  const double longest = sides[mesh.bounds().longest_axis()];
  const double shortest = std::max(std::min({sides.x, sides.y, sides.z}), kTouching * longest);

  const bool inside_out = mesh.compute_volume() < 0.0;
  const RayCaster caster(mesh, inside_out);
  std::vector<double> chords;
  chords.reserve(kChords);
  const std::vector<std::uint32_t> faces = spread_over_faces(mesh, kChords);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const std::array<Vec3, 3> corners = mesh.corners(faces[i]);
    const Vec3 normal = normalized(cross(corners[1] - corners[0], corners[2] - corners[0]));
    const Ray ray(place_on_triangle(corners, i), inside_out ? normal : -normal);
    chords.push_back(std::min(caster.find_exit(ray, kTouching * longest, faces[i]), shortest));
  }
  if (chords.empty()) return shortest;
  const auto at =
      chords.begin() + static_cast<std::ptrdiff_t>(kShare * static_cast<double>(chords.size()));
  std::nth_element(chords.begin(), at, chords.end());
  return *at;
}

}  // namespace voxshell
