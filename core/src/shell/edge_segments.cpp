#include "voxshell/edge_segments.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include "base/text.h"
#include "shell/point_checks.h"
#include "simd/edge_view.h"

namespace voxshell {
namespace {

Error invalid(std::string message) { return {ErrorCode::kInvalidArgument, std::move(message)}; }

std::size_t count_pieces(const EdgeSegments::Edge& edge, double longest_half) {
  return std::max<std::size_t>(
      1, static_cast<std::size_t>(std::ceil(length(edge.to - edge.from) / (2.0 * longest_half))));
}

/// Of the pieces of all edges.
double choose_longest_half(std::span<const EdgeSegments::Edge> edges, double tolerance) {
  double sum = 0.0;
  for (const EdgeSegments::Edge& edge : edges) sum += length(edge.to - edge.from);
  const double half = EdgeSegments::kHalfPerTolerance * tolerance;
  const auto most = static_cast<double>(EdgeSegments::kMostPieces);
  // Each edge ends with one piece that may be shorter.
  const double left = most - static_cast<double>(edges.size());
  if (sum / (2.0 * half) <= left) return half;
  return std::max(half, sum / (2.0 * std::max(left, 0.5 * most)));
}

}  // namespace

EdgeSegments EdgeSegments::build(std::span<const Edge> edges, double tolerance, unsigned threads) {
  const double longest_half = choose_longest_half(edges, tolerance);
  std::vector<Vec3f> middles;
  std::vector<Vec3f> halves;
  std::vector<Vec3f> normals;
  for (const Edge& edge : edges) {
    const std::size_t count = count_pieces(edge, longest_half);
    const Vec3 piece = (edge.to - edge.from) / static_cast<double>(count);
    for (std::size_t i = 0; i < count; ++i) {
      const auto middle = static_cast<Vec3f>(edge.from + (static_cast<double>(i) + 0.5) * piece);
      // To the end as float32 has it, so that consecutive pieces meet.
      const auto end = static_cast<Vec3f>(edge.from + (static_cast<double>(i) + 1.0) * piece);
      middles.push_back(middle);
      halves.push_back(end - middle);
      normals.push_back(static_cast<Vec3f>(edge.normal));
    }
  }
  std::vector<std::uint32_t> order(middles.size());
  std::iota(order.begin(), order.end(), 0u);
  EdgeSegments result;
  result.tree_ = PointSphereTree::build(middles, order, {}, threads, normals);
  result.tolerance_ = tolerance;
  result.halves_.reserve(order.size());
  result.normals_.reserve(order.size());
  for (const std::uint32_t i : order) {
    result.halves_.push_back(halves[i]);
    result.normals_.push_back(normals[i]);
  }
  result.measure_reach();
  return result;
}

Result<EdgeSegments> EdgeSegments::from_parts(Parts parts) {
  const std::size_t count = parts.tree.point_count();
  if (count == 0 || parts.halves.size() != count || parts.normals.size() != count) {
    return invalid(format_text("there are %zu segments, %zu halves and %zu normals", count,
                               parts.halves.size(), parts.normals.size()));
  }
  if (!(parts.tolerance > 0.0) || !std::isfinite(parts.tolerance)) {
    return invalid(format_text("the tolerance of edge segments is %g m", parts.tolerance));
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3f middle = parts.tree.points()[i];
    if (!is_place(middle) || !is_place(parts.halves[i])) {
      return invalid(format_text("edge segment %zu is not finite, or too far away", i));
    }
    if (!is_direction(parts.normals[i])) {
      return invalid(format_text("the normal of edge segment %zu is not of unit length", i));
    }
  }
  EdgeSegments result;
  result.tree_ = std::move(parts.tree);
  result.halves_ = std::move(parts.halves);
  result.normals_ = std::move(parts.normals);
  result.tolerance_ = parts.tolerance;
  result.measure_reach();
  return result;
}

void EdgeSegments::measure_reach() {
  double squared = 0.0;
  for (const Vec3f& half : halves_) {
    squared = std::max(squared, squared_length(static_cast<Vec3>(half)));
  }
  // Of places along a piece, worked out in float32; its rounding by magnitude is in the slack of
  // queries.
  constexpr double kRounding = 1.0 + 1e-5;
  reach_ = static_cast<float>(std::sqrt(squared) * kRounding);
}

double EdgeSegments::bracket() const {
  constexpr double kSamples = 8.0;
  return static_cast<double>(reach_) / (kSamples - 1.0);
}

std::size_t EdgeSegments::nbytes() const {
  return tree_.nbytes() + (halves_.size() + normals_.size()) * sizeof(Vec3f);
}

simd::EdgeView EdgeSegments::view() const {
  simd::EdgeView view;
  view.tree = tree_.view();
  view.tree.normals = &normals_.data()->x;
  view.halves = &halves_.data()->x;
  view.reach = reach_;
  view.tie = tie();
  return view;
}

}  // namespace voxshell
