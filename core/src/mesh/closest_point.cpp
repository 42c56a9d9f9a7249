#include "mesh/closest_point.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace voxshell {
namespace {

constexpr std::uint32_t kLeafTriangles = 4;
constexpr int kMaxDepth = 64;  ///< median splits of at most 2^32 triangles stay far below

Vec3 area_normal(const std::array<Vec3, 3>& c) { return cross(c[1] - c[0], c[2] - c[0]); }

/// The interior angle at corner `i`, radians.
double corner_angle(const std::array<Vec3, 3>& c, std::size_t i) {
  const Vec3 u = c[(i + 1) % 3] - c[i];
  const Vec3 v = c[(i + 2) % 3] - c[i];
  return std::atan2(length(cross(u, v)), dot(u, v));
}

}  // namespace

ClosestPoint closest_point_on_triangle(const Vec3& p, const std::array<Vec3, 3>& corners) {
  const auto& [a, b, c] = corners;
  const auto answer = [&](const Vec3& point, TriangleFeature feature) {
    return ClosestPoint{point, squared_length(p - point), 0, feature};
  };
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const Vec3 ap = p - a;
  const double d1 = dot(ab, ap);
  const double d2 = dot(ac, ap);
  if (d1 <= 0.0 && d2 <= 0.0) return answer(a, TriangleFeature::kVertex0);

  const Vec3 bp = p - b;
  const double d3 = dot(ab, bp);
  const double d4 = dot(ac, bp);
  if (d3 >= 0.0 && d4 <= d3) return answer(b, TriangleFeature::kVertex1);

  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) {
    return answer(a + (d1 / (d1 - d3)) * ab, TriangleFeature::kEdge01);
  }

  const Vec3 cp = p - c;
  const double d5 = dot(ab, cp);
  const double d6 = dot(ac, cp);
  if (d6 >= 0.0 && d5 <= d6) return answer(c, TriangleFeature::kVertex2);

  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
    return answer(a + (d2 / (d2 - d6)) * ac, TriangleFeature::kEdge20);
  }

  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    const double along = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return answer(b + along * (c - b), TriangleFeature::kEdge12);
  }

  const double scale = 1.0 / (va + vb + vc);
  return answer(a + (vb * scale) * ab + (vc * scale) * ac, TriangleFeature::kFace);
}

ClosestPointTree::ClosestPointTree(const TriangleMesh& mesh) : mesh_(mesh) {
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
  build_pseudonormals();
}

void ClosestPointTree::build_node(std::uint32_t begin, std::uint32_t end,
                                  std::vector<Bounds>& triangle_bounds) {
  const std::size_t self = nodes_.size();
  nodes_.push_back({{}, begin, end - begin});
  Bounds centres;
  for (std::uint32_t i = begin; i < end; ++i) {
    nodes_[self].bounds.extend(triangle_bounds[order_[i]]);
    centres.extend(triangle_bounds[order_[i]].centre());
  }
  if (end - begin <= kLeafTriangles) return;

  const int axis = centres.longest_axis();
  const std::uint32_t middle = begin + (end - begin) / 2;
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    const double ca = triangle_bounds[a].centre()[axis];
    const double cb = triangle_bounds[b].centre()[axis];
    return ca != cb ? ca < cb : a < b;
  };
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end, before);
  nodes_[self].count = 0;
  build_node(begin, middle, triangle_bounds);
  nodes_[self].first = static_cast<std::uint32_t>(nodes_.size());
  build_node(middle, end, triangle_bounds);
}

void ClosestPointTree::build_pseudonormals() {
  struct Side {
    std::uint32_t low, high, triangle, side;
  };
  const auto triangles = mesh_.triangles();
  vertex_normals_.assign(mesh_.vertices().size(), Vec3{});
  edge_normals_.resize(triangles.size());
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const auto corners = mesh_.corners(i);
    const Vec3 normal = normalized(area_normal(corners));
    for (std::uint32_t side = 0; side < 3; ++side) {
      const std::uint32_t from = triangles[i][side];
      const std::uint32_t to = triangles[i][(side + 1) % 3];
      vertex_normals_[from] += corner_angle(corners, side) * normal;
      sides.push_back({std::min(from, to), std::max(from, to), i, side});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    if (a.low != b.low) return a.low < b.low;
    if (a.high != b.high) return a.high < b.high;
    return a.triangle < b.triangle;
  });
  for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    Vec3 sum{};
    for (; end < sides.size() && sides[end].low == sides[begin].low &&
           sides[end].high == sides[begin].high;
         ++end) {
      sum += normalized(area_normal(mesh_.corners(sides[end].triangle)));
    }
    for (std::size_t i = begin; i < end; ++i) edge_normals_[sides[i].triangle][sides[i].side] = sum;
  }
}

ClosestPoint ClosestPointTree::find_closest(const Vec3& p, double max_distance) const {
  ClosestPoint best{p, std::numeric_limits<double>::infinity(), 0, TriangleFeature::kFace};
  double limit = max_distance * max_distance;

  struct Waiting {
    std::uint32_t node;
    double squared_distance;
  };
  std::array<Waiting, kMaxDepth> stack;
  std::size_t waiting = 0;
  stack[waiting++] = {0, squared_distance(nodes_[0].bounds, p)};
  while (waiting > 0) {
    const Waiting next = stack[--waiting];
    if (next.squared_distance > limit) continue;
    const Node& node = nodes_[next.node];
    if (node.count > 0) {
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        ClosestPoint candidate = closest_point_on_triangle(p, corners_[i]);
        if (candidate.squared_distance <= limit &&
            candidate.squared_distance < best.squared_distance) {
          candidate.triangle = order_[i];
          best = candidate;
          limit = candidate.squared_distance;
        }
      }
      continue;
    }
    Waiting near{next.node + 1, squared_distance(nodes_[next.node + 1].bounds, p)};
    Waiting far{node.first, squared_distance(nodes_[node.first].bounds, p)};
    if (far.squared_distance < near.squared_distance) std::swap(near, far);
    if (far.squared_distance <= limit) stack[waiting++] = far;
    if (near.squared_distance <= limit) stack[waiting++] = near;
  }
  return best;
}

Vec3 ClosestPointTree::pseudonormal(const ClosestPoint& closest) const {
  const Triangle& triangle = mesh_.triangles()[closest.triangle];
  switch (closest.feature) {
    case TriangleFeature::kVertex0:
      return vertex_normals_[triangle[0]];
    case TriangleFeature::kVertex1:
      return vertex_normals_[triangle[1]];
    case TriangleFeature::kVertex2:
      return vertex_normals_[triangle[2]];
    case TriangleFeature::kEdge01:
      return edge_normals_[closest.triangle][0];
    case TriangleFeature::kEdge12:
      return edge_normals_[closest.triangle][1];
    case TriangleFeature::kEdge20:
      return edge_normals_[closest.triangle][2];
    case TriangleFeature::kFace:
      break;
  }
  return area_normal(mesh_.corners(closest.triangle));
}

double ClosestPointTree::signed_distance(const Vec3& p, double max_distance) const {
  const ClosestPoint closest = find_closest(p, max_distance);
  const double distance = std::sqrt(closest.squared_distance);
  return dot(pseudonormal(closest), p - closest.point) < 0.0 ? -distance : distance;
}

}  // namespace voxshell
