#include <algorithm>
#include <cmath>
#include <span>

#include "base/parallel.h"
#include "base/text.h"
#include "field/brick_bounds.h"
#include "field/brick_entry.h"
#include "field/brick_grid.h"
#include "mesh/closest_point.h"
#include "mesh/row_winding.h"
#include "voxshell/grid_field.h"

namespace voxshell {
namespace {

using simd::kBrickCells;

constexpr std::size_t kFineNodes = kBrickCells + 1;
constexpr std::size_t kFineSamples = (cube(kFineNodes) + simd::kSampleAlignment - 1) /
                                     simd::kSampleAlignment * simd::kSampleAlignment;

/// Nodes that lie in several layers of the mesh, or in one that is inside out.
struct OverlapCount {
  std::size_t nodes = 0;
  Vec3 first{};

  void add(const Vec3& node) { add(OverlapCount{1, node}); }
  void add(const OverlapCount& other) {
    if (nodes == 0) first = other.first;
    nodes += other.nodes;
  }
};

/// A progress that is one part of another.
Progress part_of(const Progress& whole, double from, double to) {
  if (!whole) return {};
  return [&whole, from, to](std::string_view stage, double fraction) {
    return whole(stage, from + (to - from) * fraction);
  };
}

/// The least exponent of a scale in which a distance of so many quanta fits.
int find_exponent(double quanta) {
  int exponent = 0;
  while (std::ldexp(32767.0, exponent) < quanta) ++exponent;
  return exponent;
}

int store_samples(std::span<const double> distances, double quantum, std::int16_t* samples) {
  double farthest = 0.0;
  for (const double d : distances) farthest = std::max(farthest, std::abs(d));
  const int exponent = find_exponent(farthest / quantum);
  const double scale = 1.0 / (quantum * std::ldexp(1.0, exponent));
  for (std::size_t i = 0; i < distances.size(); ++i) {
    samples[i] = static_cast<std::int16_t>(std::lrint(distances[i] * scale));
  }
  return exponent;
}

}  // namespace

Result<GridField> GridField::build(const TriangleMesh& mesh, const GridFieldSettings& settings,
                                   const Progress& progress) {
  const auto planned = plan_brick_grid(mesh.bounds(), settings);
  if (!planned) return planned.error();
  const BrickGrid& grid = *planned;
  if (auto closed = check_encloses_volume(mesh); !closed) return closed.error();

  GridFieldData data;
  data.voxel_size = grid.voxel_size;
  data.origin = grid.origin;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    data.bricks[axis] = static_cast<int>(grid.bricks[axis]);
  }
  data.surface_bounds = mesh.bounds();
  data.entries.resize(grid.count());
  data.samples.resize(std::max<std::size_t>(grid.count() * kFineSamples, simd::kFewestSamples));

  const std::size_t rows_y = kBrickCells * grid.bricks[1] + 1;
  const std::size_t rows_z = kBrickCells * grid.bricks[2] + 1;
  const auto winding = RowWinding::build(
      mesh, {.origin = grid.origin, .step = grid.voxel_size, .rows_y = rows_y, .rows_z = rows_z});
  if (!winding) return winding.error();
  const ClosestPointTree tree(mesh);
  std::vector<OverlapCount> overlaps(grid.count());
  std::vector<int> exponents(grid.count());
  const auto fill_brick = [&](std::size_t brick) {
    const double h = grid.voxel_size;
    const auto place = grid.place(brick);
    std::array<double, cube(kFineNodes)> distances;
    std::array<double, kFineNodes> row_x;
    std::array<int, kFineNodes> layers{};
    std::size_t node = 0;
    ClosestPoint closest{};
    for (std::size_t k = 0; k < kFineNodes; ++k) {
      for (std::size_t j = 0; j < kFineNodes; ++j) {
        const std::size_t y = kBrickCells * place[1] + j;
        const std::size_t z = kBrickCells * place[2] + k;
        for (std::size_t i = 0; i < kFineNodes; ++i) {
          row_x[i] = grid.node(kBrickCells * place[0] + i, y, z).x;
        }
        winding->compute(y + z * rows_y, row_x, layers);
        for (std::size_t i = 0; i < kFineNodes; ++i, ++node) {
          const Vec3 p = grid.node(kBrickCells * place[0] + i, y, z);
          closest = tree.find_closest(p, closest.triangle);
          const double distance = std::sqrt(closest.squared_distance);
          distances[node] = layers[i] > 0 ? -distance : distance;
          if (layers[i] != 0 && layers[i] != 1 && distance > h) overlaps[brick].add(p);
        }
      }
    }
    const std::size_t first = brick * kFineSamples;
    exponents[brick] =
        store_samples(distances, h / simd::kQuantaPerVoxel, data.samples.data() + first);
    data.entries[brick] =
        BrickEntry{.cells = kBrickCells, .exponent = exponents[brick], .first = first}.pack();
  };
  const Error cancelled{ErrorCode::kCancelled, "building the distance field was stopped"};
  if (!parallel_for(grid.count(), settings.threads, "distance field", part_of(progress, 0.0, 0.9),
                    fill_brick)) {
    return cancelled;
  }
  OverlapCount overlap;
  for (const OverlapCount& of_brick : overlaps) overlap.add(of_brick);
  if (overlap.nodes > 0) {
    return Error{ErrorCode::kInvalidMesh,
                 format_text("mesh overlaps itself by more than a voxel: %zu of %zu grid nodes are "
                             "enclosed more than once or inside out (first near %s metres); unite "
                             "its parts before building a signed field",
                             overlap.nodes, grid.count() * cube(kFineNodes),
                             format_point(overlap.first).c_str())};
  }

  const int coarsest = *std::max_element(exponents.begin(), exponents.end());
  const double rounding = std::ldexp(0.5 / simd::kQuantaPerVoxel, coarsest);
  data.coarse_floor = simd::kNoCoarseFloor;
  data.error = (std::sqrt(0.75) + rounding) * grid.voxel_size;
  if (!compute_brick_bounds(data, settings.threads, part_of(progress, 0.9, 1.0))) return cancelled;
  return GridField(std::move(data));
}

}  // namespace voxshell
