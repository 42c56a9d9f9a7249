#include "voxshell/point_shell.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <compare>
#include <numeric>
#include <utility>

#include "base/portable_math.h"
#include "base/stage.h"
#include "base/text.h"
#include "mesh/creases.h"
#include "mesh/surface_cutter.h"
#include "mesh/thickness.h"
#include "shell/surface_voxels.h"
#include "voxshell/parallel.h"

namespace voxshell {
namespace {

struct ShellPoint {
  Vec3f point;
  std::uint32_t triangle;
  double area;
};

struct Sampling {
  std::vector<ShellPoint> points;
  std::vector<Vec3f> normals;  ///< of the points; filled in where sampling is done
  double spacing = 0.0;
  std::size_t samples = 0;  ///< more than points where float32 cannot tell some apart
  std::optional<EdgeSegments> edges = {};
};

Vec3 normal_of_triangle(const TriangleMesh& mesh, std::uint32_t triangle) {
  const auto [a, b, c] = mesh.corners(triangle);
  return normalized(cross(b - a, c - a));
}

/// Which point is at a place.
class PlaceTable {
 public:
  /// `points` stays where it is.
  explicit PlaceTable(const std::vector<ShellPoint>& points)
      : points_(points), slots_(std::bit_ceil(2 * points.size() + 1), kFree) {}

  /// The point at the place of `candidate`, which is `candidate` itself if it is the first.
  std::uint32_t take(std::uint32_t candidate) {
    const Vec3f& p = points_[candidate].point;
    std::size_t i = hash(p) & (slots_.size() - 1);
    while (slots_[i] != kFree && points_[slots_[i]].point != p) i = (i + 1) & (slots_.size() - 1);
    if (slots_[i] == kFree) slots_[i] = candidate;
    return slots_[i];
  }

 private:
  static constexpr auto kFree = static_cast<std::uint32_t>(-1);

  /// Spreads the bits of three floats (the steps of SplitMix64).
  static std::uint64_t hash(const Vec3f& p) {
    std::uint64_t h = 0;
    for (int axis = 0; axis < 3; ++axis) {
      h += std::bit_cast<std::uint32_t>(p[axis] + 0.0f);  // -0 becomes 0
      h = (h ^ (h >> 30)) * 0xBF58476D1CE4E5B9u;
      h = (h ^ (h >> 27)) * 0x94D049BB133111EBu;
    }
    return h >> 32;
  }

  const std::vector<ShellPoint>& points_;
  std::vector<std::uint32_t> slots_;
};

/// Rounds samples to float32. Those that then share a place become one point if they face the same
/// way, too; otherwise all but one of them move to the middle of their piece of the surface. So the
/// two sides of an edge that passes nearest to a voxel's centre both keep a point.
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

Sampling sample_shell(const TriangleMesh& mesh, const VoxelGrid& grid, unsigned threads,
                      Stage& stage) {
  const auto samples = sample_surface_voxels(mesh, grid, threads, stage.as_progress(0.0, 0.9));
  if (stage.stopped()) return {};
  return {make_shell_points(mesh, samples, stage), {}, grid.spacing, samples.size()};
}

/// A grid that shares no symmetry with the mesh; another for each index. Rotation and shift are
/// multiples of powers of the root of x^4 = x + 1, which spread evenly.
VoxelGrid make_odd_grid(double spacing, int index) {
  const auto spread = [n = index + 1.0](double step) { return n * step - std::floor(n * step); };
  const Vec3 shift{spread(0.8191725133961645), spread(0.6710436067037893),
                   spread(0.5497004779019703)};
  // From the quaternion (1, v): the last bits of sines and cosines differ by machine.
  const Vec3 v = 2.0 * shift - Vec3{1.0, 1.0, 1.0};
  const double s = 2.0 / (1.0 + squared_length(v));
  return {spacing,
          {{1.0 - s * (v.y * v.y + v.z * v.z), s * (v.x * v.y - v.z), s * (v.x * v.z + v.y)},
           {s * (v.x * v.y + v.z), 1.0 - s * (v.x * v.x + v.z * v.z), s * (v.y * v.z - v.x)},
           {s * (v.x * v.z - v.y), s * (v.y * v.z + v.x), 1.0 - s * (v.x * v.x + v.y * v.y)}},
          shift};
}

Error stopped() { return {ErrorCode::kCancelled, "building the point shell was stopped"}; }

/// Finds the spacing that gives a wanted number of points. The number falls with the spacing, on
/// most meshes almost as its inverse square; but on regular ones in steps, as many voxels appear at
/// once. Where a search ends at such a step, it goes on with odd grids.
class TargetSearch {
 public:
  TargetSearch(const TriangleMesh& mesh, std::size_t target)
      : wanted_(static_cast<double>(target)) {
    const double longest = mesh.bounds().extents()[mesh.bounds().longest_axis()];
    grid_.spacing = std::max(std::sqrt(compute_passed_area(mesh, {}) / wanted_), longest / wanted_);
  }

  const VoxelGrid& grid() const { return grid_; }

  /// Chooses the next grid to try from the count that this one gave, which is not the one wanted.
  void take(std::size_t count) {
    const double ratio = static_cast<double>(count) / wanted_;
    if (odd_grids_ > 0) {
      grid_ = make_odd_grid(grid_.spacing * std::sqrt(std::sqrt(ratio)), odd_grids_++);
      return;
    }
    ++trials_;
    (ratio > 1.0 ? too_fine_ : too_coarse_) = {grid_.spacing, portable_log(ratio)};
    if (too_fine_.spacing == 0.0 || too_coarse_.spacing == 0.0) {
      // Beyond what is expected, if that fell short: to have it between two spacings soon.
      const double beyond = trials_ == 1 ? 0.0 : ratio > 1.0 ? 0.01 : -0.01;
      grid_.spacing *= std::max(0.5, std::sqrt(ratio)) * (1.0 + beyond);
      return;
    }
    const double apart = portable_log(too_coarse_.spacing / too_fine_.spacing);
    // By a straight line in logarithms, and by halves where that does not get there.
    const double fraction =
        trials_ % 2 == 0 ? too_fine_.log_ratio / (too_fine_.log_ratio - too_coarse_.log_ratio)
                         : 0.5;
    grid_.spacing = too_fine_.spacing * portable_exp(fraction * apart);
    constexpr double kStepWidth = 1e-4;
    constexpr int kManyTrials = 10;
    if (apart < kStepWidth || trials_ >= kManyTrials) {
      grid_ = make_odd_grid(grid_.spacing, odd_grids_++);
    }
  }

 private:
  struct Trial {
    double spacing = 0.0;
    double log_ratio = 0.0;  ///< of the count to the one wanted
  };

  double wanted_;
  VoxelGrid grid_{};
  Trial too_fine_;
  Trial too_coarse_;
  int trials_ = 0;
  int odd_grids_ = 0;
};

Result<Sampling> sample_target(const TriangleMesh& mesh, std::size_t target, unsigned threads,
                               Stage& stage) {
  constexpr int kMaxTrials = 256;  // few points must be hit to the point, and take little time
  constexpr double kTolerance = 0.01;
  const auto wanted = static_cast<double>(target);
  const auto miss = [&](const Sampling& sampling) {
    return std::abs(static_cast<double>(sampling.points.size()) - wanted);
  };
  TargetSearch search(mesh, target);
  Sampling best;
  double done = 0.0;
  for (int trial = 0; trial < kMaxTrials; ++trial) {
    // Most searches end soon: each trial counts half of what is left.
    stage.set_part(done, 0.5 * (1.0 + done));
    done = 0.5 * (1.0 + done);
    Sampling sampling = sample_shell(mesh, search.grid(), threads, stage);
    if (stage.stopped()) return stopped();
    const std::size_t count = sampling.points.size();
    const std::size_t samples = sampling.samples;
    if (best.points.empty() || miss(sampling) < miss(best)) best = std::move(sampling);
    // Soon, a third trial gets as near as a quarter of the tolerance.
    const double good_enough = trial < 3 ? 0.25 * kTolerance : kTolerance;
    if (miss(best) <= good_enough * wanted) return best;

    // Finer voxels would only give more points that float32 cannot tell apart.
    constexpr std::size_t kMostSamplesAPoint = 4;
    if (count < target && samples > kMostSamplesAPoint * target) break;
    search.take(count);
  }
  return Error{ErrorCode::kInvalidArgument,
               format_text("no voxel size gives %zu points within 1 %% on this mesh; the nearest "
                           "count found is %zu: ask for that, or for a spacing",
                           target, best.points.size())};
}

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

  double coarsest = 0.0;  ///< metres
  double expected_points = 0.0;
  std::vector<std::uint8_t> steps;

  static double refine(double spacing) { return spacing * 0.7071067811865476; }
};

/// How far points are apart on flat parts, metres: so that areas are spread over enough of them,
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

/// Drops points next to ones of a finer part that face the same way: where parts of different
/// spacings interlock, their voxels overlap. The others take over their areas. Corners, whose
/// spacing is 0, come first and stay.
void drop_crowded(Sampling& sampling, std::span<const double> spacings) {
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
  std::size_t count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (is_dropped[i]) continue;
    points[count] = points[i];
    sampling.normals[count] = sampling.normals[i];
    ++count;
  }
  points.resize(count);
  sampling.normals.resize(count);
}

/// Samples a mesh as densely as its curvature asks for, and adds corners and edges: what is visible
/// of it, or all where that is null.
Result<Sampling> sample_by_tolerance(const TriangleMesh& mesh, const VisibleSurface* visible,
                                     const PointShellSettings& settings, Stage& stage) {
  const double tolerance = settings.tolerance;
  const Creases creases = find_creases(mesh, tolerance);
  const Density density = choose_density(mesh, creases.spacings, settings);
  Sampling sampling;
  for (const Corner& corner : creases.corners) {
    if (visible != nullptr &&
        visible->cutter->look_at(mesh.vertices()[corner.vertex], corner.normal).is_hidden()) {
      continue;
    }
    sampling.points.push_back({static_cast<Vec3f>(mesh.vertices()[corner.vertex]), 0, 0.0});
    sampling.normals.push_back(static_cast<Vec3f>(corner.normal));
  }
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
    Sampling sampled =
        sample_shell(*part, {std::min(spacing, 2.0 * size), {}}, settings.threads, stage);
    if (stage.stopped()) return stopped();
    if (sampling.spacing == 0.0) sampling.spacing = spacing;
    for (const ShellPoint& point : sampled.points) {
      spacings.push_back(spacing);
      sampling.points.push_back(point);
      sampling.normals.push_back(static_cast<Vec3f>(normal_of_triangle(*part, point.triangle)));
    }
  }
  stage.set_part(0.0, 1.0);
  drop_crowded(sampling, spacings);
  // Points of different parts may share a place, as may corners and points.
  PlaceTable table(sampling.points);
  std::size_t kept = 0;
  std::vector<std::uint32_t> place(sampling.points.size());
  for (std::uint32_t id = 0; id < sampling.points.size(); ++id) place[id] = table.take(id);
  for (std::uint32_t id = 0; id < sampling.points.size(); ++id) {
    if (place[id] != id) sampling.points[place[id]].area += sampling.points[id].area;
  }
  for (std::uint32_t id = 0; id < sampling.points.size(); ++id) {
    if (place[id] != id) continue;
    sampling.points[kept] = sampling.points[id];
    sampling.normals[kept] = sampling.normals[id];
    ++kept;
  }
  sampling.points.resize(kept);
  sampling.normals.resize(kept);

  std::vector<EdgeSegments::Edge> edges;
  edges.reserve(creases.sharp_edges.size());
  for (std::size_t i = 0; i < creases.sharp_edges.size(); ++i) {
    const BentEdge& edge = creases.sharp_edges[i];
    const Vec3& from = mesh.vertices()[edge.from];
    const Vec3& to = mesh.vertices()[edge.to];
    if (visible == nullptr) {
      edges.push_back({from, to, creases.edge_normals[i]});
      continue;
    }
    for (const auto& [begin, end] : visible->cutter->cut_line(from, to, creases.edge_normals[i])) {
      const Vec3 way = to - from;
      edges.push_back({from + begin * way, from + end * way, creases.edge_normals[i]});
    }
  }
  if (!edges.empty()) sampling.edges = EdgeSegments::build(edges, tolerance, settings.threads);
  return sampling;
}

}  // namespace

Result<std::monostate> PointShell::check(const TriangleMesh& mesh,
                                         const PointShellSettings& settings) {
  const bool by_spacing = settings.spacing != 0.0;
  if (settings.tolerance != 0.0) {
    if (by_spacing || settings.target_points != 0) {
      return Error{ErrorCode::kInvalidArgument,
                   "give a tolerance, a point spacing or a number of target points, not several"};
    }
    if (settings.tolerance > 0.0 && std::isfinite(settings.tolerance)) return std::monostate{};
    return Error{ErrorCode::kInvalidArgument,
                 format_text("tolerance must be above 0 m, not %g", settings.tolerance)};
  }
  if (by_spacing == (settings.target_points != 0)) {
    return Error{ErrorCode::kInvalidArgument,
                 "give either a point spacing or a number of target points"};
  }
  if (by_spacing && (!(settings.spacing > 0.0) || !std::isfinite(settings.spacing))) {
    return Error{ErrorCode::kInvalidArgument,
                 format_text("point spacing must be above 0 m, not %g", settings.spacing)};
  }
  const double area = compute_passed_area(mesh, {});
  const double longest = mesh.bounds().extents()[mesh.bounds().longest_axis()];
  const std::size_t limit = std::min(settings.point_limit, PointShellSettings::kMostPoints);
  // A wire has no area to speak of, but passes a voxel a spacing.
  const double expected = by_spacing ? std::max(area / (settings.spacing * settings.spacing),
                                                longest / settings.spacing)
                                     : static_cast<double>(settings.target_points);
  if (expected > static_cast<double>(limit)) {
    constexpr double kSafety = 1.2;  // how far the estimate may be below the number found
    const double fits = std::max(std::sqrt(kSafety * area / static_cast<double>(limit)),
                                 kSafety * longest / static_cast<double>(limit));
    return Error{ErrorCode::kTooLarge,
                 format_text("a point shell of about %.3g points is above the limit of %zu; ",
                             expected, limit) +
                     (by_spacing ? format_text("use a point spacing of at least %.3g m", fits)
                                 : "ask for no more points")};
  }
  return std::monostate{};
}

PointShell PointShell::with_points(std::span<const Vec3f> points, std::span<const Vec3f> normals,
                                   unsigned threads) const {
  std::vector<Vec3f> all;
  all.reserve(size() + points.size());
  for (const Vec3f& point : this->points()) all.push_back(point);
  std::vector<Vec3f> normals_of_all = normals_;
  const auto as_array = [](const Vec3f& p) { return std::array{p.x, p.y, p.z}; };
  std::vector<Vec3f> taken = all;
  std::ranges::sort(taken, {}, as_array);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::ranges::binary_search(taken, as_array(points[i]), {}, as_array)) continue;
    all.push_back(points[i]);
    normals_of_all.push_back(normals[i]);
  }
  std::vector<std::uint32_t> order(all.size());
  std::iota(order.begin(), order.end(), 0u);

  PointShell shell;
  shell.spacing_ = spacing_;
  shell.edges_ = edges_;
  shell.tree_ = PointSphereTree::build(all, order, {}, threads, normals_of_all);
  for (const std::uint32_t i : order) {
    shell.normals_.push_back(normals_of_all[i]);
    shell.areas_.push_back(i < size() ? areas_[i] : 0.0f);
  }
  return shell;
}

Result<PointShell> PointShell::build(const TriangleMesh& mesh, const PointShellSettings& settings,
                                     const Progress& progress) {
  return build(mesh, nullptr, settings, progress);
}

Result<PointShell> PointShell::build(const TriangleMesh& mesh, const VisibleSurface* visible,
                                     const PointShellSettings& settings, const Progress& progress) {
  // Creases are those of the whole mesh, whose triangles know their neighbors.
  const bool by_tolerance = settings.tolerance != 0.0;
  const TriangleMesh& surface = visible != nullptr && !by_tolerance ? visible->mesh : mesh;
  if (auto checked = check(surface, settings); !checked) return checked.error();

  Stage stage(progress, "point shell");
  Sampling sampling;
  if (by_tolerance) {
    auto sampled = sample_by_tolerance(surface, visible, settings, stage);
    if (!sampled) return sampled.error();
    sampling = *std::move(sampled);
  } else if (settings.target_points == 0) {
    // Voxels of twice the surface's size and above hold all of it; far above, numbers overflow.
    const double size = length(surface.bounds().extents());
    sampling = sample_shell(surface, {std::min(settings.spacing, 2.0 * size), {}}, settings.threads,
                            stage);
    sampling.spacing = settings.spacing;
  } else {
    auto found = sample_target(surface, settings.target_points, settings.threads, stage);
    if (!found) return found.error();
    sampling = *std::move(found);
    stage.set_part(0.0, 1.0);
  }
  stage.report(1.0);
  if (stage.stopped()) return stopped();

  std::vector<Vec3f> points(sampling.points.size());
  std::vector<Vec3f> normals(sampling.points.size());
  constexpr std::size_t kPointsATask = 1 << 14;
  const std::size_t tasks = (points.size() + kPointsATask - 1) / kPointsATask;
  const auto for_points = [&](const auto& visit) {
    parallel_for(tasks, settings.threads, "point shell", {}, [&](std::size_t task) {
      const std::size_t end = std::min(points.size(), (task + 1) * kPointsATask);
      for (std::size_t i = task * kPointsATask; i < end; ++i) visit(i);
    });
  };
  for_points([&](std::size_t i) {
    points[i] = sampling.points[i].point;
    normals[i] = sampling.normals.empty()
                     ? static_cast<Vec3f>(normal_of_triangle(surface, sampling.points[i].triangle))
                     : sampling.normals[i];
  });
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0u);

  PointShell shell;
  shell.spacing_ = sampling.spacing;
  shell.edges_ = std::move(sampling.edges);
  shell.tree_ = PointSphereTree::build(points, order, progress, settings.threads, normals);
  if (shell.tree_.point_count() == 0) return stopped();
  shell.normals_.resize(order.size());
  shell.areas_.resize(order.size());
  for_points([&](std::size_t i) {
    shell.normals_[i] = normals[order[i]];
    shell.areas_[i] = static_cast<float>(sampling.points[order[i]].area);
  });
  return shell;
}

}  // namespace voxshell
