#include "shell/sample_by_tolerance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/text.h"
#include "mesh/creases.h"
#include "mesh/thickness.h"
#include "shell/place_table.h"
#include "shell/sample_on_grid.h"
#include "shell/surface_voxels.h"

namespace voxshell {
namespace {

/// The triangles of a mesh that `is_wanted`, with the vertices that they use. None where they are
/// no mesh: so small, or of so little area, that nothing is missed.
template <class IsWanted>
std::optional<TriangleMesh> extract(const TriangleMesh& mesh, const IsWanted& is_wanted) {
  constexpr auto kNone = static_cast<std::uint32_t>(-1);
  std::vector<std::uint32_t> index_of(mesh.vertices().size(), kNone);
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i < mesh.triangles().size(); ++i) {
    if (!is_wanted(i)) continue;
    Triangle triangle = mesh.triangles()[i];
    for (std::uint32_t& corner : triangle) {
      if (index_of[corner] == kNone) {
        index_of[corner] = static_cast<std::uint32_t>(vertices.size());
        vertices.push_back(mesh.vertices()[corner]);
      }
      corner = index_of[corner];
    }
    triangles.push_back(triangle);
  }
  auto part = TriangleMesh::from_parts(std::move(vertices), std::move(triangles));
  if (!part) return std::nullopt;
  return *std::move(part);
}

/// How far apart points are to be on each triangle, in steps of a square root of two finer than the
/// coarsest.
struct Density {
  static constexpr int kMostSteps = 64;

  double coarsest = 0.0;  ///< meters
  double expected_points = 0.0;
  std::vector<std::uint8_t> steps;

  static double refine(double spacing) { return spacing * 0.7071067811865476; }
};

/// How far points are apart on flat parts, meters: so that areas are spread over enough of them,
/// and that where bodies cross, some lie deep in the other one, even if all edges lie in its
/// surface. Of thin sheets that would be too many, and of surface narrower than the rounding, which
/// has no thickness and no area that says how many, without bound.
double choose_coarsest(const TriangleMesh& mesh, double wall_thickness) {
  constexpr double kFewest = 25.0;  // along the longest side
  constexpr double kOfThickness = 0.5;
  constexpr double kMostOnSheets = 5e3;  // about
  constexpr double kNarrow = 1e-6;       // of the longest side
  constexpr double kAlongNarrow = 1e3;
  double area = 0.0;
  for (std::size_t i = 0; i < mesh.triangles().size(); ++i) {
    const auto [a, b, c] = mesh.corners(i);
    area += 0.5 * length(cross(b - a, c - a));
  }
  const double longest = mesh.bounds().extents()[mesh.bounds().longest_axis()];
  if (area <= kNarrow * longest * longest) return longest / kAlongNarrow;
  const double inside =
      kOfThickness * (wall_thickness > 0.0 ? wall_thickness : compute_thickness(mesh));
  return std::min(longest / kFewest, std::max(inside, std::sqrt(area / kMostOnSheets)));
}

/// `stretch` is by how much farther points are apart than the spacings that are wanted.
Density choose_density(const TriangleMesh& mesh, std::span<const double> spacings, double tolerance,
                       double coarsest, double stretch) {
  constexpr double kFinest = 2.0;  // tolerances
  Density density;
  density.coarsest = coarsest;
  density.steps.reserve(spacings.size());
  for (std::size_t i = 0; i < spacings.size(); ++i) {
    double spacing = density.coarsest;
    int step = 0;
    while (step < Density::kMostSteps && spacing > stretch * spacings[i] &&
           Density::refine(spacing) >= kFinest * tolerance) {
      spacing = Density::refine(spacing);
      ++step;
    }
    density.steps.push_back(static_cast<std::uint8_t>(step));
    // As compute_passed_area() has it.
    const auto [a, b, c] = mesh.corners(i);
    const Vec3 doubled = cross(b - a, c - a);
    density.expected_points += 0.5 *
                               (std::abs(doubled.x) + std::abs(doubled.y) + std::abs(doubled.z)) /
                               (spacing * spacing);
  }
  return density;
}

/// With no more points than the settings say, if that can be.
Density choose_density(const TriangleMesh& mesh, std::span<const double> spacings,
                       const PointShellSettings& settings) {
  const double tolerance = settings.tolerance;
  const std::size_t most = settings.most_points;
  const double coarsest = choose_coarsest(mesh, settings.wall_thickness);
  Density density = choose_density(mesh, spacings, tolerance, coarsest, 1.0);
  constexpr double kStretch = 1.1;
  constexpr double kMostStretch = 100.0;
  double stretch = kStretch;
  while (most > 0 && stretch < kMostStretch &&
         density.expected_points > static_cast<double>(most)) {
    density = choose_density(mesh, spacings, tolerance, coarsest, stretch);
    stretch *= kStretch;
  }
  return density;
}

/// Leaves out the points that are marked, and keeps the order of the others.
void drop(ShellSamples& sampling, const std::vector<bool>& is_dropped) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < is_dropped.size(); ++i) {
    if (is_dropped[i]) continue;
    sampling.points[count] = sampling.points[i];
    sampling.normals[count] = sampling.normals[i];
    ++count;
  }
  sampling.points.resize(count);
  sampling.normals.resize(count);
}

/// Drops points next to ones of a finer part that face the same way: where parts of different
/// spacings interlock, their voxels overlap. The others take over their areas. Corners, whose
/// spacing is 0, come first and stay.
void drop_crowded(ShellSamples& sampling, std::span<const double> spacings) {
  constexpr double kCrowded = 0.4;  // spacings
  constexpr float kSameWay = 0.8f;  // cosine
  std::vector<ShellPoint>& points = sampling.points;
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return spacings[a] < spacings[b]; });
  std::vector<bool> is_dropped(points.size());
  struct Place {
    std::array<std::int64_t, 3> cell;
    std::uint32_t point;

    auto operator<=>(const Place&) const = default;
  };
  std::vector<Place> kept;
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    const double spacing = spacings[order[begin]];
    while (end < order.size() && spacings[order[end]] == spacing) ++end;
    if (begin == 0) continue;
    const double size = kCrowded * spacing;
    const auto cell_of = [&](const Vec3f& p, int axis) {
      return static_cast<std::int64_t>(std::floor(static_cast<double>(p[axis]) / size));
    };
    kept.clear();
    for (std::size_t i = 0; i < begin; ++i) {
      const Vec3f& p = points[order[i]].point;
      if (!is_dropped[order[i]]) {
        kept.push_back({{cell_of(p, 0), cell_of(p, 1), cell_of(p, 2)}, order[i]});
      }
    }
    std::sort(kept.begin(), kept.end());
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t id = order[i];
      const Vec3f p = points[id].point;
      double nearest = size * size;
      std::uint32_t by = id;
      for (int x = -1; x <= 1; ++x) {
        for (int y = -1; y <= 1; ++y) {
          const std::int64_t z = cell_of(p, 2);
          const Place first{{cell_of(p, 0) + x, cell_of(p, 1) + y, z - 1}, 0};
          for (auto at = std::lower_bound(kept.begin(), kept.end(), first);
               at != kept.end() && at->cell[0] == first.cell[0] && at->cell[1] == first.cell[1] &&
               at->cell[2] <= z + 1;
               ++at) {
            const double squared =
                squared_length(static_cast<Vec3>(points[at->point].point) - static_cast<Vec3>(p));
            if (squared >= nearest ||
                dot(sampling.normals[at->point], sampling.normals[id]) < kSameWay) {
              continue;
            }
            nearest = squared;
            by = at->point;
          }
        }
      }
      if (by == id) continue;
      is_dropped[id] = true;
      points[by].area += points[id].area;
    }
  }
  drop(sampling, is_dropped);
}

/// Points of different parts may share a place, as may corners and points: the first stands for
/// all.
void merge_shared_places(ShellSamples& sampling) {
  PlaceTable table(sampling.points);
  std::vector<bool> is_dropped(sampling.points.size());
  for (std::uint32_t id = 0; id < sampling.points.size(); ++id) {
    const std::uint32_t first = table.take(id);
    if (first == id) continue;
    is_dropped[id] = true;
    sampling.points[first].area += sampling.points[id].area;
  }
  drop(sampling, is_dropped);
}

/// The corners as points, which stand for no area.
ShellSamples sample_corners(const TriangleMesh& mesh, const VisibleSurface* visible,
                            const std::vector<Corner>& corners) {
  ShellSamples sampling;
  for (const Corner& corner : corners) {
    const Vec3& place = mesh.vertices()[corner.vertex];
    if (visible != nullptr && visible->cutter->look_at(place, corner.normal).is_hidden()) continue;
    sampling.points.push_back({static_cast<Vec3f>(place), 0, 0.0});
    sampling.normals.push_back(static_cast<Vec3f>(corner.normal));
  }
  return sampling;
}

/// The sharp edges, or the visible parts of them.
std::vector<EdgeSegments::Edge> find_visible_edges(const TriangleMesh& mesh,
                                                   const VisibleSurface* visible,
                                                   const Creases& creases) {
  std::vector<EdgeSegments::Edge> edges;
  edges.reserve(creases.sharp_edges.size());
  for (std::size_t i = 0; i < creases.sharp_edges.size(); ++i) {
    const Vec3& from = mesh.vertices()[creases.sharp_edges[i].from];
    const Vec3& to = mesh.vertices()[creases.sharp_edges[i].to];
    const Vec3& normal = creases.edge_normals[i];
    if (visible == nullptr) {
      edges.push_back({from, to, normal});
      continue;
    }
    const Vec3 way = to - from;
    for (const auto& [begin, end] : visible->cutter->cut_line(from, to, normal)) {
      edges.push_back({from + begin * way, from + end * way, normal});
    }
  }
  return edges;
}

}  // namespace

/// Samples a mesh as densely as its curvature asks for, and adds corners and edges: what is visible
/// of it, or all where that is null.
Result<ShellSamples> sample_by_tolerance(const TriangleMesh& mesh, const VisibleSurface* visible,
                                         const PointShellSettings& settings, Stage& stage) {
  const double tolerance = settings.tolerance;
  const Creases creases = find_creases(mesh, tolerance);
  const Density density = choose_density(mesh, creases.spacings, settings);
  ShellSamples sampling = sample_corners(mesh, visible, creases.corners);
  std::vector<double> spacings(sampling.points.size(), 0.0);  // by which points were chosen
  const int finest = *std::max_element(density.steps.begin(), density.steps.end());
  double spacing = density.coarsest;
  for (int step = 0; step <= finest; ++step, spacing = Density::refine(spacing)) {
    stage.set_part(static_cast<double>(step) / (finest + 1), (step + 1.0) / (finest + 1));
    const auto part = visible != nullptr
                          ? extract(visible->mesh,
                                    [&](std::size_t i) {
                                      return density.steps[visible->triangles[i].triangle] == step;
                                    })
                          : extract(mesh, [&](std::size_t i) { return density.steps[i] == step; });
    if (!part) continue;
    const std::size_t limit = std::min(settings.point_limit, PointShellSettings::kMostPoints);
    const double expected = compute_passed_area(*part, {}) / (spacing * spacing);
    if (expected + static_cast<double>(sampling.points.size()) > static_cast<double>(limit)) {
      return Error{
          ErrorCode::kTooLarge,
          format_text("a point shell with a tolerance of %g m has about %.3g points, above "
                      "the limit of %zu; use a larger tolerance",
                      tolerance, expected, limit)};
    }
    const double size = length(part->bounds().extents());
    ShellSamples sampled =
        sample_on_grid(*part, {std::min(spacing, 2.0 * size), {}}, settings.threads, stage);
    if (stage.stopped()) return make_stopped_error();
    if (sampling.spacing == 0.0) sampling.spacing = spacing;
    for (const ShellPoint& point : sampled.points) {
      spacings.push_back(spacing);
      sampling.points.push_back(point);
      sampling.normals.push_back(static_cast<Vec3f>(normal_of_triangle(*part, point.triangle)));
    }
  }
  stage.set_part(0.0, 1.0);
  drop_crowded(sampling, spacings);
  merge_shared_places(sampling);
  const auto edges = find_visible_edges(mesh, visible, creases);
  if (!edges.empty()) sampling.edges = EdgeSegments::build(edges, tolerance, settings.threads);
  return sampling;
}

}  // namespace voxshell
