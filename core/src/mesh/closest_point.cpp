#include "mesh/closest_point.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace voxshell {
namespace {

constexpr std::uint32_t kLeafTriangles = 4;
constexpr int kMaxDepth = 64;  ///< median splits of at most 2^32 triangles stay far below

Vec3 closest_point_on_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 ab = b - a;
  const double squared = squared_length(ab);
  return squared > 0.0 ? a + std::clamp(dot(p - a, ab) / squared, 0.0, 1.0) * ab : a;
}

}  // namespace

Vec3 closest_point_on_triangle(const Vec3& p, const std::array<Vec3, 3>& corners) {
  const auto& [a, b, c] = corners;
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const Vec3 ap = p - a;
  const double d1 = dot(ab, ap);
  const double d2 = dot(ac, ap);
  if (d1 <= 0.0 && d2 <= 0.0) return a;

  const Vec3 bp = p - b;
  const double d3 = dot(ab, bp);
  const double d4 = dot(ac, bp);
  if (d3 >= 0.0 && d4 <= d3) return b;

  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 && d1 > d3) {
    return a + (d1 / (d1 - d3)) * ab;
  }

  const Vec3 cp = p - c;
  const double d5 = dot(ab, cp);
  const double d6 = dot(ac, cp);
  if (d6 >= 0.0 && d5 <= d6) return c;

  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
    return a + (d2 / (d2 - d6)) * ac;
  }

  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    const double along = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return b + along * (c - b);
  }

  const double total = va + vb + vc;
  const Vec3 on_face = a + (vb / total) * ab + (vc / total) * ac;
  // On a needle the weights are mostly rounding (on one without area, 0 / 0), but it has no point
  // far from its sides.
  constexpr double kThin = 1e-6;  // sine of the angle at a, squared
  if (total > kThin * squared_length(ab) * squared_length(ac)) return on_face;
  Vec3 best = closest_point_on_segment(p, a, b);
  for (const Vec3& candidate :
       {closest_point_on_segment(p, b, c), closest_point_on_segment(p, c, a), on_face}) {
    if (squared_length(p - candidate) < squared_length(p - best)) best = candidate;
  }
  return best;
}

ClosestPointTree::ClosestPointTree(const TriangleMesh& mesh) {
  const auto count = static_cast<std::uint32_t>(mesh.triangles().size());
  order_.resize(count);
  std::iota(order_.begin(), order_.end(), 0u);
  std::vector<Bounds> triangle_bounds(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    for (const Vec3& corner : mesh.corners(i)) triangle_bounds[i].extend(corner);
  }
  build_node(0, count, triangle_bounds);
  corners_.reserve(count);
  for (const std::uint32_t triangle : order_) corners_.push_back(mesh.corners(triangle));
  place_.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) place_[order_[i]] = i;
}

void ClosestPointTree::build_node(std::uint32_t begin, std::uint32_t end,
                                  std::vector<Bounds>& triangle_bounds) {
  const std::size_t self = nodes_.size();
  nodes_.push_back({{}, begin, end - begin});
  Bounds centers;
  for (std::uint32_t i = begin; i < end; ++i) {
    nodes_[self].bounds.extend(triangle_bounds[order_[i]]);
    centers.extend(triangle_bounds[order_[i]].center());
  }
  if (end - begin <= kLeafTriangles) return;

  const int axis = centers.longest_axis();
  const std::uint32_t middle = begin + (end - begin) / 2;
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    const double ca = triangle_bounds[a].center()[axis];
    const double cb = triangle_bounds[b].center()[axis];
    return ca != cb ? ca < cb : a < b;
  };
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end, before);
  nodes_[self].count = 0;
  build_node(begin, middle, triangle_bounds);
  nodes_[self].first = static_cast<std::uint32_t>(nodes_.size());
  build_node(middle, end, triangle_bounds);
}

ClosestPoint ClosestPointTree::find_closest(const Vec3& p, std::uint32_t guess) const {
  const Vec3 guessed = closest_point_on_triangle(p, corners_[place_[guess]]);
  ClosestPoint best{guessed, squared_length(p - guessed), guess};

  struct Waiting {
    std::uint32_t node;
    double squared_distance;
  };
  std::array<Waiting, kMaxDepth> stack;
  std::size_t waiting = 0;
  stack[waiting++] = {0, squared_distance(nodes_[0].bounds, p)};
  while (waiting > 0) {
    const Waiting next = stack[--waiting];
    if (next.squared_distance >= best.squared_distance) continue;
    const Node& node = nodes_[next.node];
    if (node.count > 0) {
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        const Vec3 candidate = closest_point_on_triangle(p, corners_[i]);
        const double squared = squared_length(p - candidate);
        if (squared < best.squared_distance) best = {candidate, squared, order_[i]};
      }
      continue;
    }
    Waiting near{next.node + 1, squared_distance(nodes_[next.node + 1].bounds, p)};
    Waiting far{node.first, squared_distance(nodes_[node.first].bounds, p)};
    if (far.squared_distance < near.squared_distance) std::swap(near, far);
    if (far.squared_distance < best.squared_distance) stack[waiting++] = far;
    if (near.squared_distance < best.squared_distance) stack[waiting++] = near;
  }
  return best;
}

}  // namespace voxshell
