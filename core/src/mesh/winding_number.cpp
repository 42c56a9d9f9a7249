#include "mesh/winding_number.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "voxshell/bounds.h"

namespace voxshell {
namespace {

constexpr std::uint32_t kLeafTriangles = 8;

}  // namespace

WindingNumberTree::WindingNumberTree(const TriangleMesh& mesh) {
  const auto count = static_cast<std::uint32_t>(mesh.triangles().size());
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  std::vector<Vec3> centers(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto [a, b, c] = mesh.corners(i);
    centers[i] = (a + b + c) / 3.0;
  }
  build_node(mesh, 0, count, order, centers);
  triangles_.reserve(std::size_t{simd::kWindingTriangleDoubles} * count);
  for (const std::uint32_t triangle : order) {
    for (const Vec3& corner : mesh.corners(triangle)) {
      triangles_.insert(triangles_.end(), {corner.x, corner.y, corner.z});
    }
  }
}

void WindingNumberTree::build_node(const TriangleMesh& mesh, std::uint32_t begin, std::uint32_t end,
                                   std::vector<std::uint32_t>& order,
                                   const std::vector<Vec3>& centers) {
  const std::size_t self = nodes_.size();
  nodes_.push_back({.center = {}, .area = {}, .radius = 0.0, .first = begin, .count = end - begin});
  Bounds bounds;
  Vec3 area{};
  Vec3 weighted{};
  double total = 0.0;
  for (std::uint32_t i = begin; i < end; ++i) {
    const auto [a, b, c] = mesh.corners(order[i]);
    const Vec3 normal = 0.5 * cross(b - a, c - a);
    const double size = length(normal);
    area += normal;
    weighted += size * centers[order[i]];
    total += size;
    bounds.extend(centers[order[i]]);
  }
  const Vec3 center = total > 0.0 ? weighted / total : bounds.center();
  double squared = 0.0;
  for (std::uint32_t i = begin; i < end; ++i) {
    for (const Vec3& corner : mesh.corners(order[i])) {
      squared = std::max(squared, squared_length(corner - center));
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    nodes_[self].center[axis] = center[axis];
    nodes_[self].area[axis] = area[axis];
  }
  nodes_[self].radius = std::sqrt(squared);
  if (end - begin <= kLeafTriangles) return;

  const int axis = bounds.longest_axis();
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(
      order.begin() + begin, order.begin() + middle, order.begin() + end,
      [&](std::uint32_t a, std::uint32_t b) {
        return centers[a][axis] != centers[b][axis] ? centers[a][axis] < centers[b][axis] : a < b;
      });
  nodes_[self].count = 0;
  build_node(mesh, begin, middle, order, centers);
  nodes_[self].first = static_cast<std::uint32_t>(nodes_.size());
  build_node(mesh, middle, end, order, centers);
}

void WindingNumberTree::compute(std::span<const Vec3> places, std::span<double> numbers) const {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  const simd::WindingView view{nodes_.data(), triangles_.data()};
  simd::winding_kernels().compute(view, places.empty() ? nullptr : &places.front().x,
                                  static_cast<std::int64_t>(places.size()), numbers.data());
}

double WindingNumberTree::compute(const Vec3& p) const {
  double number = 0.0;
  compute({&p, 1}, {&number, 1});
  return number;
}

}  // namespace voxshell
