#include "shell/sample_on_grid.h"

#include "shell/place_table.h"

namespace voxshell {
namespace {

/// Rounds samples to float32. Those that then share a place become one point if they face the same
/// way, too; otherwise all but one of them move to the middle of their piece of the surface. So the
/// two sides of an edge that passes nearest to a voxel's center both keep a point.
std::vector<ShellPoint> make_shell_points(const TriangleMesh& mesh,
                                          const std::vector<SurfaceSample>& samples, Stage& stage) {
  std::vector<ShellPoint> points;
  points.reserve(samples.size());
  for (const SurfaceSample& sample : samples) {
    points.push_back({static_cast<Vec3f>(sample.point), sample.triangle, sample.area});
  }
  const auto face_the_same_way = [&](std::uint32_t a, std::uint32_t b) {
    constexpr double kSameNormal = 1.0 - 1e-6;
    return points[a].triangle == points[b].triangle ||
           dot(normal_of_triangle(mesh, points[a].triangle),
               normal_of_triangle(mesh, points[b].triangle)) > kSameNormal;
  };
  const auto join = [&](std::uint32_t id, std::uint32_t other) {
    points[other].area += points[id].area;
    points[id].area = 0.0;
  };

  PlaceTable table(points);
  std::vector<std::uint32_t> moved;
  for (std::uint32_t id = 0; id < points.size(); ++id) {
    constexpr std::uint32_t kPointsAReport = 1 << 16;
    if (id % kPointsAReport == 0) {
      stage.report(0.9 + 0.1 * static_cast<double>(id) / static_cast<double>(points.size()));
      if (stage.stopped()) return {};
    }
    const std::uint32_t first = table.take(id);
    if (first == id) continue;
    if (face_the_same_way(id, first)) {
      join(id, first);
    } else {
      moved.push_back(id);
    }
  }
  for (const std::uint32_t id : moved) {
    points[id].point =
        static_cast<Vec3f>(samples[id].point + static_cast<Vec3>(samples[id].to_middle));
    // Where float32 cannot tell the middle from another point either, that one stands for both.
    const std::uint32_t first = table.take(id);
    if (first != id) join(id, first);
  }
  std::erase_if(points, [](const ShellPoint& point) { return point.area == 0.0; });
  return points;
}

}  // namespace

Vec3 normal_of_triangle(const TriangleMesh& mesh, std::uint32_t triangle) {
  const auto [a, b, c] = mesh.corners(triangle);
  return normalized(cross(b - a, c - a));
}

ShellSamples sample_on_grid(const TriangleMesh& mesh, const VoxelGrid& grid, unsigned threads,
                            Stage& stage) {
  const auto samples = sample_surface_voxels(mesh, grid, threads, stage.as_progress(0.0, 0.9));
  if (stage.stopped()) return {};
  return {make_shell_points(mesh, samples, stage), {}, grid.spacing, samples.size()};
}

}  // namespace voxshell
