#include "field/field_builder.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <string_view>

#include "base/text.h"
#include "field/brick_entry.h"
#include "field/plane_surroundings.h"
#include "voxshell/parallel.h"

namespace voxshell {
namespace {

using simd::kBrickCells;

constexpr std::string_view kStage = "distance field";
constexpr std::size_t kMostCoarseCells = 4;
constexpr std::uint32_t kNoIndex = 0xffffffffu;

/// A progress that is one part of another.
Progress part_of(const Progress& whole, double from, double to) {
  if (!whole) return {};
  return [&whole, from, to](std::string_view stage, double fraction) {
    return whole(stage, from + (to - from) * fraction);
  };
}

std::size_t align(std::size_t samples) {
  return (samples + simd::kSampleAlignment - 1) / simd::kSampleAlignment * simd::kSampleAlignment;
}

std::size_t samples_of(int cells) { return align(cube(static_cast<std::size_t>(cells) + 1)); }

/// Stores distances in quanta and returns the exponent of their scale, the least in which they fit.
int store_samples(std::span<const float> distances, int quanta_per_voxel, std::int16_t* samples) {
  const auto quanta = static_cast<float>(quanta_per_voxel);
  float farthest = 0.0f;
  for (const float d : distances) farthest = std::max(farthest, std::abs(d));
  int exponent = 0;
  while (std::ldexp(32767.0f / quanta, exponent) < farthest) ++exponent;
  const float scale = std::ldexp(quanta, -exponent);
  for (std::size_t i = 0; i < distances.size(); ++i) {
    samples[i] = static_cast<std::int16_t>(std::lrint(distances[i] * scale));
  }
  return exponent;
}

Fineness choose_fineness(const TriangleMesh& mesh, const BrickGrid& grid, double tolerance) {
  if (tolerance == 0.0) return {256, 1.0 / 1024.0, 1e-3};
  constexpr double kRoundings = 8.0;  // that add up in a distance
  constexpr double kFloat = 6e-8;
  const Bounds& bounds = mesh.bounds();
  double farthest = 0.0;  // from the origins of the mesh and of the grid
  for (int axis = 0; axis < 3; ++axis) {
    farthest = std::max({farthest, std::abs(bounds.lower[axis]), std::abs(bounds.upper[axis]),
                         bounds.upper[axis] - grid.origin[axis]});
  }
  return {2048, 1.0 / 8192.0, kRoundings * kFloat * farthest / grid.voxel_size};
}

void count_overlap(int layers, float distance, const Vec3& place, OverlapCount& overlap) {
  constexpr float kOnSurface = 0.02f;  // voxels
  ++overlap.of;
  overlap.inside += layers > 0 && distance > kOnSurface;
  if (layers == 0 || layers == 1 || distance <= 1.0f) return;
  if (overlap.places++ == 0) overlap.first = place;
}

/// The nearest that bricks with cells of 2, 4 and 8 voxels, or larger, come to the surface, voxels.
using Floors = std::array<double, simd::kCoarseSizes>;
constexpr Floors kNoFloors{1e30, 1e30, 1e30};

/// No point of a brick is nearer to the surface than this, voxels.
double find_least_magnitude(std::span<const float> nodes, double size) {
  float least = std::abs(nodes[0]);
  for (const float d : nodes) least = std::min(least, std::abs(d));
  return static_cast<double>(least) - 0.5 * std::sqrt(3.0) * size;
}

}  // namespace

FieldBuilder::FieldBuilder(const TriangleMesh& mesh, const BrickGridPlan& plan,
                           const GridFieldSettings& settings, const Inside& inside,
                           const Progress& progress, Features features)
    : mesh_(mesh),
      grid_(plan.grid),
      least_cells_(plan.least_cells),
      threads_(settings.threads),
      inside_(inside),
      progress_(progress),
      fineness_(choose_fineness(mesh, plan.grid, settings.tolerance)),
      flat_(mesh, fineness_.plane_tolerance * plan.grid.voxel_size),
      tree_(mesh, plan.grid.origin, plan.grid.voxel_size, settings.threads) {
  if (settings.tolerance > 0.0) {
    exact_.emplace(mesh, plan.grid, tree_, settings, fineness_.quanta_per_voxel,
                   std::move(features));
  }
}

std::optional<Error> FieldBuilder::build(GridFieldData& data) {
  Error canceled{ErrorCode::kCanceled, "building the distance field was stopped"};
  if (!measure_corners()) return canceled;
  if (auto overlapping = check_overlap()) return overlapping;
  if (!plan_bricks()) return canceled;
  if (!place_bricks(data)) {
    return Error{ErrorCode::kTooLarge,
                 format_text("a distance field of voxel size %.3g m has more samples than can be "
                             "numbered; use a voxel size of at least %.3g m",
                             grid_.voxel_size, 1.2 * grid_.voxel_size)};
  }
  if (!fill_bricks(data)) return canceled;
  if (auto overlapping = check_overlap()) return overlapping;
  measure_plane_surroundings(data, threads_);
  return std::nullopt;
}

std::optional<Error> FieldBuilder::check_overlap() const {
  if (overlap_.places == 0) return std::nullopt;
  return Error{ErrorCode::kInvalidMesh,
               format_text("mesh overlaps itself by more than a voxel: %zu of %zu grid nodes "
                           "looked at are enclosed more than once or inside out (first near %s "
                           "meters); unite its parts, or use winding numbers to find the inside",
                           overlap_.places, overlap_.of, format_point(overlap_.first).c_str())};
}

bool FieldBuilder::measure_corners() {
  lattice_.nodes = {grid_.bricks[0] + 1, grid_.bricks[1] + 1, grid_.bricks[2] + 1};
  const auto [nx, ny, nz] = lattice_.nodes;
  lattice_.distances.resize(nx * ny * nz);
  lattice_.triangles.resize(nx * ny * nz);
  std::vector<OverlapCount> overlaps(ny * nz);
  const auto measure_row = [&, nx = nx, ny = ny](std::size_t row) {
    const std::size_t j = row % ny;
    const std::size_t k = row / ny;
    std::vector<int> layers(nx);
    inside_.find_corners(j, k, layers);
    DistanceTree::Nearest nearest{};
    for (std::size_t i = 0; i < nx; ++i) {
      const Vec3 in_voxels{static_cast<double>(kBrickCells * i),
                           static_cast<double>(kBrickCells * j),
                           static_cast<double>(kBrickCells * k)};
      nearest = tree_.find_nearest(in_voxels, nearest.guess);
      const float distance = nearest.distance;
      lattice_.distances[lattice_.index(i, j, k)] = layers[i] > 0 ? -distance : distance;
      lattice_.triangles[lattice_.index(i, j, k)] = nearest.triangle;
      count_overlap(layers[i], distance,
                    grid_.node(kBrickCells * i, kBrickCells * j, kBrickCells * k), overlaps[row]);
    }
  };
  const bool is_done =
      parallel_for(ny * nz, threads_, kStage, part_of(progress_, 0.0, 0.1), measure_row);
  for (const OverlapCount& of_row : overlaps) overlap_.add(of_row);
  return is_done;
}

bool FieldBuilder::plan_bricks() {
  plans_.resize(grid_.count());
  const std::size_t nx = grid_.bricks[0];
  const BrickPlanner planner(mesh_, grid_, lattice_, tree_, flat_, fineness_.plane_tolerance);
  const auto plan_row = [&](std::size_t row) {
    BrickPlanner::Work work;
    for (std::size_t brick = row * nx; brick < (row + 1) * nx; ++brick) {
      plans_[brick] = planner.plan(grid_.place(brick), least_cells_[brick], work);
    }
  };
  return parallel_for(grid_.bricks[1] * grid_.bricks[2], threads_, kStage,
                      part_of(progress_, 0.1, 0.3), plan_row);
}

bool FieldBuilder::are_corners_shared() const {
  return std::ranges::any_of(plans_, [](const BrickPlan& plan) { return plan.cells == 1; });
}

/// Gives each brick its samples or plane. False where there are too many.
bool FieldBuilder::place_bricks(GridFieldData& data) const {
  const std::size_t count = grid_.count();
  data.quanta_per_voxel = fineness_.quanta_per_voxel;
  data.entries.resize(count);
  const std::size_t corners = are_corners_shared() ? lattice_.distances.size() : 0;
  if (corners > kMostPayloads) return false;
  std::size_t samples = align(corners);
  std::vector<std::uint32_t> index_of_region(mesh_.triangles().size(), kNoIndex);
  for (std::size_t brick = 0; brick < count; ++brick) {
    const BrickPlan& plan = plans_[brick];
    if (samples >= kMostPayloads * simd::kSampleAlignment) return false;
    if (plan.cells == 1) {
      const std::size_t first = lattice_.corner(grid_.place(brick), 0);
      data.entries[brick] = BrickEntry{.cells = 1, .first = first}.pack();
      continue;
    }
    if (plan.cells > 0) {
      data.entries[brick] = BrickEntry{.cells = plan.cells, .first = samples}.pack();
      samples += samples_of(plan.cells);
      continue;
    }
    std::uint32_t& index = index_of_region[plan.region];
    if (index == kNoIndex) {
      index = static_cast<std::uint32_t>(data.planes.size() / 4);
      const auto& plane = flat_.plane(plan.region);
      const auto normal = static_cast<Vec3f>(plane.normal);
      data.planes.insert(data.planes.end(),
                         {normal.x, normal.y, normal.z, static_cast<float>(plane.offset)});
    }
    data.entries[brick] = BrickEntry{.is_plane = true, .first = index}.pack();
  }
  data.samples.resize(std::max<std::size_t>(samples, simd::kFewestSamples));
  return true;
}

bool FieldBuilder::fill_bricks(GridFieldData& data) {
  const auto [nx, ny, nz] = grid_.bricks;
  struct RowResult {
    OverlapCount overlap;
    double rounding = 0.0;  ///< largest, of a cell's size
    Floors floors = kNoFloors;
    std::vector<ExactCellFinder::Brick> exact;
    float proved = 0.0f;  ///< of samples at the surface, voxels
  };
  std::vector<RowResult> results(ny * nz);
  const int quanta = fineness_.quanta_per_voxel;
  const int exponent_of_corners =
      are_corners_shared() ? store_samples(lattice_.distances, quanta, data.samples.data()) : 0;
  const auto fill_row = [&, nx = nx](std::size_t row) {
    DistanceTree::Scratch scratch;
    ExactCellFinder::Work exact_work;
    RowResult& result = results[row];
    std::array<float, cube(kBrickCells + 1)> distances;
    std::array<float, cube(kMostCoarseCells + 1)> distances_before;
    std::span<float> before;
    for (std::size_t brick = row * nx; brick < (row + 1) * nx; ++brick) {
      const BrickPlan& plan = plans_[brick];
      if (plan.cells == 0) continue;
      const auto place = grid_.place(brick);
      const auto corners = lattice_.corners_of(place);
      const std::span<float> nodes(distances.data(),
                                   cube(static_cast<std::size_t>(plan.cells) + 1));
      if (plan.cells == 1) {
        std::copy(corners.begin(), corners.end(), nodes.begin());
      } else if (plan.cells == kBrickCells) {
        tree_.measure_brick(center_of(place), plan.at_center, scratch, nodes);
        sign_fine(place, nodes, result.overlap);
        if (exact_) {
          auto exact = exact_->find(brick, nodes, exact_work);
          result.proved = std::max(result.proved, exact.error);
          if (!exact.cells.empty()) result.exact.push_back(std::move(exact));
        }
      } else {
        const bool follows = brick % nx > 0 && plans_[brick - 1].cells == plan.cells;
        measure_coarse(place, plan, follows ? before : std::span<float>{}, nodes);
        before = std::span(distances_before).first(nodes.size());
        std::copy(nodes.begin(), nodes.end(), before.begin());
        if (corners[0] < 0.0) {
          for (float& d : nodes) d = -d;
        }
      }
      BrickEntry entry = BrickEntry::unpack(data.entries[brick]);
      entry.exponent = plan.cells == 1 ? exponent_of_corners
                                       : store_samples(nodes, quanta, &data.samples[entry.first]);
      data.entries[brick] = entry.pack();
      const double size = static_cast<double>(kBrickCells) / plan.cells;
      result.rounding = std::max(result.rounding, std::ldexp(0.5 / quanta, entry.exponent) / size);
      if (plan.cells == kBrickCells) continue;
      const double least = find_least_magnitude(nodes, size);
      for (std::size_t i = 0; i < result.floors.size() && plan.cells < kBrickCells >> i; ++i) {
        result.floors[i] = std::min(result.floors[i], least);
      }
    }
  };
  if (!parallel_for(ny * nz, threads_, kStage, part_of(progress_, 0.3, 1.0), fill_row)) {
    return false;
  }
  double rounding = 0.0;
  float proved = 0.0f;
  Floors floors = kNoFloors;
  std::vector<ExactCellFinder::Brick> exact;
  for (RowResult& result : results) {
    std::ranges::move(result.exact, std::back_inserter(exact));
    overlap_.add(result.overlap);
    proved = std::max(proved, result.proved);
    rounding = std::max(rounding, result.rounding);
    for (std::size_t i = 0; i < floors.size(); ++i) {
      floors[i] = std::min(floors[i], result.floors[i]);
    }
  }
  data.node_error =
      (std::max(rounding, 1.5 * fineness_.plane_tolerance) + fineness_.rounding) * grid_.voxel_size;
  if (exact_) {
    data.exact = exact_->assemble(exact);
    data.surface_error = data.node_error + static_cast<double>(proved) * grid_.voxel_size;
  }
  // Other bricks at larger scales are far away.
  const double rounding_of_corners = std::ldexp(0.5 / quanta, exponent_of_corners);
  for (std::size_t i = 0; i < floors.size(); ++i) {
    data.coarse_floors[i] =
        floors[i] == kNoFloors[i]
            ? static_cast<double>(simd::kNoCoarseFloor)
            : (std::max(kLeastFloors[i], floors[i]) - fineness_.rounding - rounding_of_corners) *
                  grid_.voxel_size;
  }
  return true;
}

/// Unsigned. Those at the corners and the center are known, and those on the side shared with the
/// brick before this one are among that one's, `before`, if it has as many.
void FieldBuilder::measure_coarse(const std::array<std::size_t, 3>& brick, const BrickPlan& plan,
                                  std::span<const float> before, std::span<float> nodes) const {
  const auto cells = static_cast<std::size_t>(plan.cells);
  const double spacing = static_cast<double>(kBrickCells) / plan.cells;
  const Vec3 first = center_of(brick) - Vec3{kHalfEdge, kHalfEdge, kHalfEdge};
  const auto corners = lattice_.corners_of(brick);
  const auto is_end = [&](std::size_t i) { return i == 0 || i == cells; };
  DistanceTree::Nearest nearest{};
  nearest.guess = plan.guess;
  std::size_t node = 0;
  for (std::size_t k = 0; k <= cells; ++k) {
    for (std::size_t j = 0; j <= cells; ++j) {
      for (std::size_t i = 0; i <= cells; ++i, ++node) {
        if (is_end(i) && is_end(j) && is_end(k)) {
          nodes[node] = static_cast<float>(std::abs(corners[(i + 2 * j + 4 * k) / cells]));
        } else if (2 * i == cells && 2 * j == cells && 2 * k == cells) {
          nodes[node] = plan.at_center;
        } else if (i == 0 && !before.empty()) {
          nodes[node] = before[node + cells];
        } else {
          const Vec3 offset{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
          nearest = tree_.find_nearest(first + spacing * offset, nearest.guess);
          nodes[node] = nearest.distance;
        }
      }
    }
  }
}

void FieldBuilder::sign_fine(const std::array<std::size_t, 3>& brick, std::span<float> nodes,
                             OverlapCount& overlap) const {
  constexpr std::size_t kNodes = kBrickCells + 1;
  std::array<int, cube(kNodes)> layers{};
  inside_.find_nodes(brick, nodes, layers);
  for (std::size_t node = 0; node < layers.size(); ++node) {
    count_overlap(layers[node], nodes[node],
                  grid_.node(kBrickCells * brick[0] + node % kNodes,
                             kBrickCells * brick[1] + node / kNodes % kNodes,
                             kBrickCells * brick[2] + node / (kNodes * kNodes)),
                  overlap);
    if (layers[node] > 0) nodes[node] = -nodes[node];
  }
}

}  // namespace voxshell
