#include "mesh/self_crossings.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "voxshell/parallel.h"

namespace voxshell {
namespace {

/// How near things are that touch, of the mesh's longest side: above the rounding of coordinates to
/// float32 in files, below what matters.
constexpr double kRounding = 1e-6;
constexpr double kRoundingOfCoordinates = 1e-7;  // of the largest

constexpr std::size_t kCorners = 3;
std::size_t next(std::size_t corner) { return corner + 1 == kCorners ? 0 : corner + 1; }

double farthest_coordinate(const Bounds& bounds) {
  double farthest = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    farthest = std::max({farthest, std::abs(bounds.lower[axis]), std::abs(bounds.upper[axis])});
  }
  return farthest;
}

/// Heights of a triangle's corners above a plane; 0 within the rounding.
std::array<double, 3> measure_heights(const std::array<Vec3, 3>& corners, const Vec3& origin,
                                      const Vec3& normal, double rounding) {
  std::array<double, 3> heights{};
  for (std::size_t i = 0; i < kCorners; ++i) {
    heights[i] = dot(corners[i] - origin, normal);
    if (std::abs(heights[i]) <= rounding) heights[i] = 0.0;
  }
  return heights;
}

bool are_on_one_side(const std::array<double, 3>& heights) {
  return (heights[0] > 0.0 && heights[1] > 0.0 && heights[2] > 0.0) ||
         (heights[0] < 0.0 && heights[1] < 0.0 && heights[2] < 0.0);
}

}  // namespace

double measure_rounding(const TriangleMesh& mesh) {
  const Bounds& bounds = mesh.bounds();
  return kRounding * bounds.extents()[bounds.longest_axis()] +
         kRoundingOfCoordinates * farthest_coordinate(bounds);
}

SelfCrossings::SelfCrossings(const TriangleMesh& mesh)
    : rounding_(measure_rounding(mesh)),
      triangles_(mesh.triangles().begin(), mesh.triangles().end()),
      finder_(bound_triangles(mesh)) {
  corners_.reserve(triangles_.size());
  normals_.reserve(triangles_.size());
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    corners_.push_back(mesh.corners(i));
    const auto& [a, b, c] = corners_.back();
    normals_.push_back(normalized(cross(b - a, c - a)));
  }
}

std::vector<SelfCrossings::Line> SelfCrossings::find_lines(std::uint32_t triangle) const {
  std::vector<Line> lines;
  const auto& own = corners_[triangle];
  const Vec3& normal = normals_[triangle];
  if (normal == Vec3{}) return lines;
  const Triangle& t = triangles_[triangle];
  finder_.visit(widen(bound_triangle(own), rounding_), [&](std::uint32_t other) {
    // Neighbors meet it along a side.
    const auto is_shared = [&](std::uint32_t v) { return v == t[0] || v == t[1] || v == t[2]; };
    if (std::ranges::count_if(triangles_[other], is_shared) > 1) return;
    const auto& corners = corners_[other];
    if (normals_[other] == Vec3{}) return;
    const auto heights = measure_heights(corners, own[0], normal, rounding_);
    if (are_on_one_side(heights)) return;
    std::array<Vec3, 2> ends{};
    std::size_t count = 0;
    std::size_t flat = 0;
    for (std::size_t i = 0; i < kCorners; ++i) {
      const double here = heights[i];
      const double there = heights[next(i)];
      if (here == 0.0) ++flat;
      if (count == ends.size()) continue;
      if (here == 0.0) {
        ends[count++] = corners[i];
      } else if (here * there < 0.0) {
        ends[count++] = corners[i] + here / (here - there) * (corners[next(i)] - corners[i]);
      }
    }
    if (count < ends.size() || flat == kCorners) return;
    if (are_on_one_side(measure_heights(own, corners[0], normals_[other], rounding_))) return;
    lines.push_back({ends[0], ends[1], normals_[other]});
  });
  return lines;
}

void SelfCrossings::clip(std::span<const Vec3> polygon, const Vec3& normal,
                         std::vector<Line>& lines) const {
  std::vector<Vec3> inwards(polygon.size());
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3& b = polygon[i + 1 == polygon.size() ? 0 : i + 1];
    inwards[i] = normalized(cross(normal, b - polygon[i]));
  }
  std::size_t kept = 0;
  for (const Line& line : lines) {
    double begin = 0.0;
    double end = 1.0;
    const Vec3 way = line.to - line.from;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const double height = dot(line.from - polygon[i], inwards[i]) - 2.0 * rounding_;
      const double slope = dot(way, inwards[i]);
      if (height < 0.0) begin = height + slope < 0.0 ? 1.0 : std::max(begin, -height / slope);
      if (height + slope < 0.0) end = std::min(end, -height / slope);
    }
    if ((end - begin) * length(way) <= 2.0 * rounding_) continue;
    lines[kept++] = {line.from + begin * way, line.from + end * way, line.outward};
  }
  lines.resize(kept);
}

bool SelfCrossings::is_crossed(std::uint32_t triangle) const {
  std::vector<Line> lines = find_lines(triangle);
  clip(corners_[triangle], normals_[triangle], lines);
  return !lines.empty();
}

std::vector<std::uint32_t> SelfCrossings::find_crossed(unsigned threads) const {
  std::vector<std::uint8_t> crossed(triangles_.size(), 0);
  constexpr std::size_t kChunk = 256;
  parallel_for((crossed.size() + kChunk - 1) / kChunk, threads, "distance field", {},
               [&](std::size_t chunk) {
                 const std::size_t end = std::min(crossed.size(), (chunk + 1) * kChunk);
                 for (std::size_t i = chunk * kChunk; i < end; ++i) {
                   crossed[i] = is_crossed(static_cast<std::uint32_t>(i)) ? 1 : 0;
                 }
               });
  std::vector<std::uint32_t> found;
  for (std::uint32_t i = 0; i < crossed.size(); ++i) {
    if (crossed[i] != 0) found.push_back(i);
  }
  return found;
}

}  // namespace voxshell
