#include "mesh/winding_number.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/portable_math.h"
#include "voxshell/bounds.h"

namespace voxshell {
namespace {

constexpr std::uint32_t kLeafTriangles = 8;
constexpr std::size_t kMaxDepth = 64;
/// A group counts as one from this many of its radii away.
constexpr double kFarAway = 3.0;

/// Adds up angles of vectors in the plane, each from -pi to pi, by multiplying these as complex
/// numbers and counting how often the product passes the negative axis: one arc tangent for many.
class AngleSum {
 public:
  /// The angle of (x, y). A vector of zeros has none. The product of all lengths must stay in the
  /// range of doubles.
  void add(double x, double y) {
    if (x == 0.0 && y == 0.0) return;
    const bool was_below = std::signbit(y_);
    const double product = x_ * x - y_ * y;
    y_ = x_ * y + y_ * x;
    x_ = product;
    if (was_below == std::signbit(y) && std::signbit(y_) != was_below) turns_ += was_below ? -1 : 1;
  }

  double total() const { return portable_atan2(y_, x_) + 2.0 * std::numbers::pi * turns_; }

 private:
  double x_ = 1.0;
  double y_ = 0.0;
  int turns_ = 0;
};

/// Adds half the solid angle of a triangle (Van Oosterom and Strackee 1983).
void add_half_angle(const std::array<Vec3, 3>& corners, const Vec3& p, AngleSum& sum) {
  const Vec3 a = corners[0] - p;
  const Vec3 b = corners[1] - p;
  const Vec3 c = corners[2] - p;
  const double la = length(a);
  const double lb = length(b);
  const double lc = length(c);
  const double product = la * lb * lc;
  if (product == 0.0) return;  // as seen from a corner
  sum.add((product + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb) / product,
          dot(a, cross(b, c)) / product);
}

}  // namespace

WindingNumberTree::WindingNumberTree(const TriangleMesh& mesh) {
  const auto count = static_cast<std::uint32_t>(mesh.triangles().size());
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  std::vector<Vec3> centres(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto [a, b, c] = mesh.corners(i);
    centres[i] = (a + b + c) / 3.0;
  }
  build_node(mesh, 0, count, order, centres);
  corners_.reserve(count);
  for (const std::uint32_t triangle : order) corners_.push_back(mesh.corners(triangle));
}

void WindingNumberTree::build_node(const TriangleMesh& mesh, std::uint32_t begin, std::uint32_t end,
                                   std::vector<std::uint32_t>& order,
                                   const std::vector<Vec3>& centres) {
  const std::size_t self = nodes_.size();
  nodes_.push_back({{}, {}, 0.0, begin, end - begin});
  Bounds bounds;
  Vec3 area{};
  Vec3 weighted{};
  double total = 0.0;
  for (std::uint32_t i = begin; i < end; ++i) {
    const auto [a, b, c] = mesh.corners(order[i]);
    const Vec3 normal = 0.5 * cross(b - a, c - a);
    const double size = length(normal);
    area += normal;
    weighted += size * centres[order[i]];
    total += size;
    bounds.extend(centres[order[i]]);
  }
  const Vec3 centre = total > 0.0 ? weighted / total : bounds.centre();
  double squared = 0.0;
  for (std::uint32_t i = begin; i < end; ++i) {
    for (const Vec3& corner : mesh.corners(order[i])) {
      squared = std::max(squared, squared_length(corner - centre));
    }
  }
  nodes_[self].centre = centre;
  nodes_[self].area = area;
  nodes_[self].radius = std::sqrt(squared);
  if (end - begin <= kLeafTriangles) return;

  const int axis = bounds.longest_axis();
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(
      order.begin() + begin, order.begin() + middle, order.begin() + end,
      [&](std::uint32_t a, std::uint32_t b) {
        return centres[a][axis] != centres[b][axis] ? centres[a][axis] < centres[b][axis] : a < b;
      });
  nodes_[self].count = 0;
  build_node(mesh, begin, middle, order, centres);
  nodes_[self].first = static_cast<std::uint32_t>(nodes_.size());
  build_node(mesh, middle, end, order, centres);
}

double WindingNumberTree::compute(const Vec3& p) const {
  double sum = 0.0;
  std::array<std::uint32_t, kMaxDepth> stack;
  std::size_t waiting = 0;
  stack[waiting++] = 0;
  while (waiting > 0) {
    const std::uint32_t index = stack[--waiting];
    const Node& node = nodes_[index];
    const Vec3 to_centre = node.centre - p;
    const double squared = squared_length(to_centre);
    if (squared > kFarAway * kFarAway * node.radius * node.radius) {
      sum += dot(to_centre, node.area) / (squared * std::sqrt(squared));
    } else if (node.count > 0) {
      AngleSum halves;
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        add_half_angle(corners_[i], p, halves);
      }
      sum += 2.0 * halves.total();
    } else {
      stack[waiting++] = node.first;
      stack[waiting++] = index + 1;
    }
  }
  return sum / (4.0 * std::numbers::pi);
}

}  // namespace voxshell
