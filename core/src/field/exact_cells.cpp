#include "field/exact_cells.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "field/brick_plan.h"
#include "mesh/closest_point.h"
#include "simd/exact_formula.h"
#include "simd/exact_view.h"
#include "simd/grid_formula.h"
#include "simd/mesh_distance.h"

namespace voxshell {
namespace {

using simd::kBrickCells;

constexpr int kNodes = kBrickCells + 1;
constexpr std::size_t kCells = cube(kBrickCells);
/// The surface does not pass through cells whose corners are farther from it than this, voxels.
constexpr float kAtSurface = 0.9f;
/// Inside, cells are exact where depths have a ridge, as in the middle of walls: where samples are
/// off by much, voxels.
constexpr float kRidge = 0.08f;
/// Up to such a depth, as contacts lie no deeper as a rule, and up to the middle of thin walls,
/// where that is not too deep, voxels.
constexpr double kDeep = 2.0;
constexpr double kDeepest = 8.0;
/// Nor may normals be off by more than this there: 10 degrees, cosine.
constexpr float kNormalsAgree = 0.985f;
/// Away from the surface samples may be off by this fraction of the distance more.
constexpr float kOfDistance = 0.05f;
/// Of the tolerance, as few places of a cell are looked at.
constexpr double kSafety = 0.7;
/// A cell whose samples cannot be proved to be this good is exact, tolerances.
constexpr float kMostProved = 2.0f;
/// Nor is a cell looked at more closely than this, tolerances.
constexpr float kEnough = 1.5f;
/// A mean over the corners of a cell is off by no more than their mean distance from the place,
/// voxels: half a diagonal.
constexpr float kMostOff = 0.87f;
/// Where too many triangles may be the nearest, only what holds everywhere is known, voxels.
constexpr float kUnknown = 1.0f;
constexpr float kRounding = 0.004f;  // of places and distances, voxels
/// Normals whose chord is smaller face one way: 60 degrees.
constexpr float kOneWay = 1.0f;
/// Those of the two sides of a wall.
constexpr float kFolded = 1.9f;

/// Operator < of libstdc++ 12 looks at a quarter of the bytes of such lists on big-endian machines.
struct ComesBefore {
  bool operator()(const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) const {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  }
};

/// Of a place in a cube with so many to a side, x fastest.
std::size_t index_of(int x, int y, int z, int side) {
  const auto n = static_cast<std::size_t>(side);
  return static_cast<std::size_t>(x) +
         n * (static_cast<std::size_t>(y) + n * static_cast<std::size_t>(z));
}

Vec3 unit_normal(const TriangleMesh& mesh, std::size_t triangle) {
  const auto [a, b, c] = mesh.corners(triangle);
  return normalized(cross(b - a, c - a));
}

double choose_depth(double middle_of_walls) {
  constexpr double kBeyond = 1.0;
  return middle_of_walls > kDeepest ? kDeep : std::max(kDeep, middle_of_walls + kBeyond);
}

/// See simd/exact_view.h.
std::vector<float> make_records(const TriangleMesh& mesh) {
  const std::size_t count = mesh.triangles().size();
  std::vector<float> records(simd::kTriangleFloats * count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto [a, b, c] = mesh.corners(i);
    float* to = &records[simd::kTriangleFloats * i];
    for (const Vec3& row : {a, b - a, c - a, unit_normal(mesh, i)}) {
      const auto rounded = static_cast<Vec3f>(row);
      *to++ = rounded.x;
      *to++ = rounded.y;
      *to++ = rounded.z;
    }
  }
  return records;
}

/// Errors of trilinear samples in the cells of a brick, voxels, estimated from how the differences
/// of nodes change along each axis: a crease across a cell changes them by the difference of the
/// slopes of its two sides, four times the error in the middle of the cell.
std::array<float, kCells> estimate_errors(std::span<const float> nodes) {
  std::array<float, kCells> errors{};
  constexpr std::array<int, 3> kStrides{1, kNodes, kNodes * kNodes};
  const auto node = [&](const std::array<int, 3>& at) {
    return at[0] + kNodes * (at[1] + kNodes * at[2]);
  };
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const auto b = (a + 1) % 3;
    const auto c = (a + 2) % 3;
    // Of each node, how much the difference changes there; negative where it has no neighbors.
    std::array<float, cube(kNodes)> change{};
    for (int k = 0; k < kNodes; ++k) {
      for (int j = 0; j < kNodes; ++j) {
        for (int i = 0; i < kNodes; ++i) {
          std::array<int, 3> at{};
          at[a] = i;
          at[b] = j;
          at[c] = k;
          const auto n = static_cast<std::size_t>(node(at));
          const auto stride = static_cast<std::size_t>(kStrides[a]);
          change[n] = i == 0 || i == kNodes - 1
                          ? -1.0f
                          : std::abs(nodes[n - stride] - 2.0f * nodes[n] + nodes[n + stride]);
        }
      }
    }
    for (int k = 0; k < kBrickCells; ++k) {
      for (int j = 0; j < kBrickCells; ++j) {
        for (int i = 0; i < kBrickCells; ++i) {
          std::array<int, 3> at{};
          at[a] = i;
          at[b] = j;
          at[c] = k;
          const int cell = at[0] + kBrickCells * (at[1] + kBrickCells * at[2]);
          float worst = 0.0f;
          for (int side = 0; side < 4; ++side) {
            std::array<int, 3> low = at;
            low[b] += side & 1;
            low[c] += side >> 1;
            std::array<int, 3> high = low;
            ++high[a];
            const float before = change[static_cast<std::size_t>(node(low))];
            const float after = change[static_cast<std::size_t>(node(high))];
            // At the side of the brick only one of the two is known.
            const float error = before < 0.0f  ? after
                                : after < 0.0f ? before
                                               : 0.25f * (before + after);
            worst = std::max(worst, error);
          }
          errors[static_cast<std::size_t>(cell)] += worst;
        }
      }
    }
  }
  return errors;
}

}  // namespace

struct ExactCellFinder::Job {
  Vec3 origin;  ///< of the brick, meters
  std::span<const float> nodes;
  std::array<float, kCells> estimates;
  std::bitset<kCells> passed;  ///< by the surface
  std::bitset<kCells> wanted;  ///< these, and some below it
  Work& work;
  float quanta_per_voxel;

  /// A distance, rounded as samples are stored.
  float node(int x, int y, int z) const {
    return std::round(nodes[index_of(x, y, z, kNodes)] * quanta_per_voxel) / quanta_per_voxel;
  }

  /// Of one cell, voxels.
  simd::portable::GridCell<float> samples(const Cube& cell) const {
    const auto [x, y, z] = cell.first;
    simd::portable::GridCell<float> samples{};
    for (int i = 0; i < 8; ++i) {
      samples.c[i] = node(x + (i & 1), y + (i >> 1 & 1), z + (i >> 2));
    }
    samples.scale = 1.0f;
    samples.size = 1.0f;
    return samples;
  }
};

ExactCellFinder::ExactCellFinder(const TriangleMesh& mesh, const BrickGrid& grid,
                                 const DistanceTree& tree, const GridFieldSettings& settings,
                                 int quanta_per_voxel, Features features)
    : mesh_(mesh),
      grid_(grid),
      tree_(tree),
      tolerance_(static_cast<float>(kSafety * settings.tolerance / grid.voxel_size)),
      deep_(static_cast<float>(choose_depth(0.5 * settings.wall_thickness / grid.voxel_size))),
      quanta_per_voxel_(static_cast<float>(quanta_per_voxel)),
      records_(make_records(mesh)),
      features_(std::move(features)) {}

ExactCellFinder::Brick ExactCellFinder::find(std::size_t index, std::span<const float> nodes,
                                             Work& work) const {
  Brick brick;
  brick.index = index;
  const auto place = grid_.place(index);
  Job job{grid_.node(kBrickCells * place[0], kBrickCells * place[1], kBrickCells * place[2]),
          nodes,
          estimate_errors(nodes),
          {},
          {},
          work,
          quanta_per_voxel_};
  for (std::size_t cell = 0; cell < kCells; ++cell) {
    const std::size_t x = cell % kBrickCells;
    const std::size_t y = cell / kBrickCells % kBrickCells;
    const std::size_t z = cell / (kBrickCells * kBrickCells);
    float least = std::numeric_limits<float>::infinity();
    float deepest = 0.0f;
    for (std::size_t corner = 0; corner < 8; ++corner) {
      const float node = nodes[x + (corner & 1) + kNodes * (y + (corner >> 1 & 1)) +
                               std::size_t{kNodes} * kNodes * (z + (corner >> 2))];
      least = std::min(least, std::abs(node));
      deepest = std::min(deepest, node);
    }
    job.passed[cell] = least < kAtSurface;
    job.wanted[cell] = job.passed[cell] || (job.estimates[cell] > std::max(tolerance_, kRidge) &&
                                            deepest < 0.0f && least < deep_);
  }
  if (job.wanted.none()) return brick;
  const Vec3 center = center_of(place);
  const double at_center = std::abs(static_cast<double>(
      nodes[kBrickCells / 2 * (1 + kNodes * (1 + static_cast<std::size_t>(kNodes)))]));
  constexpr std::size_t kMostInBrick = 1 << 16;
  if (!tree_.find_within(center, at_center + 2.0 * kHalfDiagonal + static_cast<double>(kRounding),
                         kMostInBrick, work.nearby)) {
    if (job.passed.any()) brick.error = kUnknown;
    return brick;
  }
  std::vector<std::uint32_t> triangles = work.nearby;
  std::ranges::sort(triangles);
  triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
  std::erase_if(triangles, [&](std::uint32_t triangle) {
    const float* normal = &records_[simd::kTriangleFloats * std::size_t{triangle}];
    normal += simd::kRecordNormal;
    return normal[0] == 0.0f && normal[1] == 0.0f && normal[2] == 0.0f;  // its edges are others'
  });
  if (triangles.empty()) {
    if (job.passed.any()) brick.error = kUnknown;
    return brick;
  }
  divide(job, {{0, 0, 0}, kBrickCells}, triangles, brick);
  // Cells were found in the order of octants.
  std::vector<std::size_t> order(brick.cells.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::sort(order, {}, [&](std::size_t i) { return brick.cells[i]; });
  Brick sorted;
  sorted.index = index;
  sorted.error = brick.error;
  for (const std::size_t i : order) {
    sorted.cells.push_back(brick.cells[i]);
    sorted.lists.push_back(std::move(brick.lists[i]));
  }
  return sorted;
}

/// Keeps those triangles that may be the nearest somewhere in the cube, and goes on with its
/// octants.
void ExactCellFinder::divide(Job& job, const Cube& cube, std::span<const std::uint32_t> triangles,
                             Brick& brick) const {
  const auto h = static_cast<float>(grid_.voxel_size);
  const auto [x, y, z] = cube.first;
  bool is_wanted = false;
  for (int k = z; k < z + cube.size && !is_wanted; ++k) {
    for (int j = y; j < y + cube.size && !is_wanted; ++j) {
      for (int i = x; i < x + cube.size && !is_wanted; ++i) {
        is_wanted = job.wanted[index_of(i, j, k, kBrickCells)];
      }
    }
  }
  if (!is_wanted) return;
  const auto& kernels = simd::mesh_distance_kernels();
  const float half = 0.5f * static_cast<float>(cube.size) * h;
  const auto lowest =
      static_cast<Vec3f>(job.origin + grid_.voxel_size * Vec3{1.0 * x, 1.0 * y, 1.0 * z});
  const std::array center{lowest.x + half, lowest.y + half, lowest.z + half};
  const float diagonal = std::sqrt(3.0f) * half;
  std::vector<float>& squared = job.work.distances;
  squared.resize(8 * (triangles.size() + 1));
  kernels.measure_listed(records_.data(), triangles.data(),
                         static_cast<std::uint32_t>(triangles.size()), center.data(),
                         squared.data());
  const auto end = squared.begin() + static_cast<std::ptrdiff_t>(triangles.size());
  const float nearest = std::sqrt(*std::min_element(squared.begin(), end));
  std::vector<std::uint32_t> kept;
  const auto keep = [&] {
    const float limit = nearest + 2.0f * diagonal + kRounding * h;
    kept.clear();
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      if (squared[i] <= limit * limit) kept.push_back(triangles[i]);
    }
  };
  if (cube.size > 1) {
    keep();
    const int size = cube.size / 2;
    for (int octant = 0; octant < 8; ++octant) {
      divide(
          job,
          {{x + size * (octant & 1), y + size * (octant >> 1 & 1), z + size * (octant >> 2)}, size},
          kept, brick);
    }
    return;
  }
  // The surface does not pass, and samples can follow it.
  const std::size_t index = index_of(x, y, z, kBrickCells);
  if (nearest > diagonal + kRounding * h) {
    if (job.estimates[index] <= tolerance_) return;
    job.passed[index] = false;
  }
  keep();
  decide(job, cube, std::move(kept), brick);
}

bool ExactCellFinder::are_signs_in_doubt(std::span<const std::uint32_t> triangles) const {
  return !features_.is_in_doubt.empty() &&
         std::ranges::any_of(triangles, [&](auto i) { return features_.is_in_doubt[i]; });
}

/// Whether distances change no faster than places do, and agree with the samples at the corners of
/// the cell. Looked at on a lattice.
bool ExactCellFinder::is_continuous(const Job& job, const Cube& cell,
                                    std::span<const std::uint32_t> triangles) const {
  constexpr int kSteps = 4;
  constexpr int kPlaces = kSteps + 1;
  constexpr float kJump = 0.02f;  // voxels
  std::array<float, 3 * cube(kPlaces)> places{};
  float* to = places.data();
  for (int z = 0; z < kPlaces; ++z) {
    for (int y = 0; y < kPlaces; ++y) {
      for (int x = 0; x < kPlaces; ++x) {
        const Vec3 offset{1.0 * x / kSteps, 1.0 * y / kSteps, 1.0 * z / kSteps};
        const Vec3 first{1.0 * cell.first[0], 1.0 * cell.first[1], 1.0 * cell.first[2]};
        const auto p = static_cast<Vec3f>(job.origin + grid_.voxel_size * (first + offset));
        *to++ = p.x;
        *to++ = p.y;
        *to++ = p.z;
      }
    }
  }
  std::array<float, cube(kPlaces)> distances{};
  simd::mesh_distance_kernels().evaluate_listed(
      records_.data(), features_.normals.data(), triangles.data(),
      static_cast<std::uint32_t>(triangles.size()), places.data(),
      static_cast<std::uint32_t>(distances.size()), distances.data());
  for (int z = 0; z < kPlaces; ++z) {
    for (int y = 0; y < kPlaces; ++y) {
      for (int x = 0; x < kPlaces; ++x) {
        const auto distance_at = [&](int i, int j, int k) {
          return distances[index_of(i, j, k, kPlaces)] / static_cast<float>(grid_.voxel_size);
        };
        const float distance = distance_at(x, y, z);
        const auto jumps = [&](float before, float apart) {
          return std::abs(distance - before) > apart + kJump;
        };
        constexpr float kApart = 1.0f / kSteps;
        if (x > 0 && jumps(distance_at(x - 1, y, z), kApart)) return false;
        if (y > 0 && jumps(distance_at(x, y - 1, z), kApart)) return false;
        if (z > 0 && jumps(distance_at(x, y, z - 1), kApart)) return false;
        if (x % kSteps + y % kSteps + z % kSteps > 0) continue;
        const float node =
            job.nodes[index_of(cell.first[0] + x / kSteps, cell.first[1] + y / kSteps,
                               cell.first[2] + z / kSteps, kNodes)];
        if (jumps(node, 0.0f)) return false;
      }
    }
  }
  return true;
}

/// The accuracy of samples in a cell.
struct ExactCellFinder::Look {
  float proved = 0.0f;     ///< no place of the cell is off by more, voxels
  bool is_off = false;     ///< some place that was looked at is, or has another normal
  bool is_folded = false;  ///< surfaces that face each other, or away, are near
  bool has_sign = true;    ///< samples are off by no more than they can be with the same signs
};

/// Looks at the middles of a cell's parts, so many to a side, and leaves only those triangles that
/// may be the nearest in one of them.
///
/// In a part, the true distance changes along a normal that differs from that of the nearest
/// triangle by no more than those of all that may be the nearest do, as long as they face one way:
/// a direction out of an edge or a corner lies between the normals of the faces around. Samples
/// change by differences of nodes next to each other. So what samples are off in the middle is off
/// elsewhere by at most the difference of the two, times the way from the middle.
ExactCellFinder::Look ExactCellFinder::look_at_parts(const Job& job, const Cube& cell, int parts,
                                                     std::vector<std::uint32_t>& triangles) const {
  const auto h = static_cast<float>(grid_.voxel_size);
  const auto [x, y, z] = cell.first;
  const auto lowest =
      static_cast<Vec3f>(job.origin + grid_.voxel_size * Vec3{1.0 * x, 1.0 * y, 1.0 * z});
  auto samples = job.samples(cell);
  std::array<float, 3> least_slope{};
  std::array<float, 3> most_slope{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const unsigned step = 1u << axis;
    least_slope[axis] = most_slope[axis] = samples.c[step] - samples.c[0];
    for (unsigned i = 0; i < 8; ++i) {
      if ((i & step) != 0) continue;
      const float slope = samples.c[i | step] - samples.c[i];
      least_slope[axis] = std::min(least_slope[axis], slope);
      most_slope[axis] = std::max(most_slope[axis], slope);
    }
  }

  const float edge = 1.0f / static_cast<float>(parts);
  const float radius = 0.5f * std::sqrt(3.0f) * edge;
  const int count = parts * parts * parts;
  const auto place_of = [&](int part) {
    const auto along = [&](int i) { return (static_cast<float>(i) + 0.5f) * edge; };
    return Vec3f{along(part % parts), along(part / parts % parts), along(part / (parts * parts))};
  };
  std::vector<std::uint8_t>& may_be_nearest = job.work.may_be_nearest;
  may_be_nearest.assign(triangles.size(), 0);
  job.work.distances.resize(8 * triangles.size());
  const simd::portable::ListedTriangles list{triangles.data(),
                                             static_cast<std::uint32_t>(triangles.size()),
                                             records_.data(), features_.normals.data()};
  Look look;
  for (int first = 0; first < count; first += simd::kBlockTriangles) {
    std::array<float, 24> places{};
    for (int i = 0; i < 8; ++i) {
      const Vec3f place = lowest + h * place_of(std::min(first + i, count - 1));
      places[static_cast<std::size_t>(i)] = place.x;
      places[static_cast<std::size_t>(i) + 8] = place.y;
      places[static_cast<std::size_t>(i) + 16] = place.z;
    }
    EightFloats squared{};
    EightFloats squared_chord{};
    std::array<std::int32_t, 8> nearest{};
    simd::mesh_distance_kernels().compare_listed(
        records_.data(), list.listed, list.count, places.data(), (2.0f * radius + kRounding) * h,
        job.work.distances.data(), may_be_nearest.data(), squared.data(), nearest.data(),
        squared_chord.data());
    for (int i = 0; i < std::min(8, count - first); ++i) {
      const auto lane = static_cast<std::size_t>(i);
      const auto found = static_cast<std::uint32_t>(nearest[lane]);
      const float* record = list.record(found);
      const float* normal = record + simd::kRecordNormal;
      const bool is_one_way = squared_chord[lane] < kOneWay * kOneWay;
      const std::array place{places[lane], places[lane + 8], places[lane + 16]};
      float distance = 0.0f;
      if (is_one_way) {
        float height = 0.0f;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          height += normal[axis] * (place[axis] - record[axis]);
        }
        distance = std::copysign(std::sqrt(squared[lane]), height) / h;
      } else {
        distance = evaluate_triangle(list, found, place[0], place[1], place[2]).distance / h;
      }
      const Vec3f t = place_of(first + i);
      samples.t = {t.x, t.y, t.z};
      const float off = std::abs(interpolate(samples) - distance);
      look.is_off |= !(off <= tolerance_ + kOfDistance * std::abs(distance));
      look.has_sign &= off <= kMostOff;
      if (distance < -tolerance_ && !look.is_off) {
        const auto exact = evaluate_triangle(list, found, place[0], place[1], place[2]);
        const auto slope = differentiate(samples, 1.0f);
        look.is_off |= dot(slope, exact.gradient) <= kNormalsAgree * simd::portable::length(slope);
      }
      look.is_folded |= squared_chord[lane] > kFolded * kFolded;
      float squared_difference = 0.0f;
      float squared_slope = 0.0f;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const float from = least_slope[axis];
        const float to = most_slope[axis];
        const float difference = std::max(normal[axis] - from, to - normal[axis]);
        squared_difference += difference * difference;
        squared_slope += std::max(from * from, to * to);
      }
      const float change = is_one_way
                               ? std::sqrt(squared_difference) + std::sqrt(squared_chord[lane])
                               : std::sqrt(squared_slope) + 1.0f;
      look.proved = std::max(look.proved, off + radius * change);
    }
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (may_be_nearest[i] != 0) triangles[kept++] = triangles[i];
  }
  triangles.resize(kept);
  return look;
}

/// Whether a cell is exact, by the triangles that may be the nearest in it.
void ExactCellFinder::decide(const Job& job, const Cube& cell, std::vector<std::uint32_t> triangles,
                             Brick& brick) const {
  const auto [x, y, z] = cell.first;
  const std::size_t index = index_of(x, y, z, kBrickCells);
  const bool is_passed = job.passed[index];
  if (triangles.empty()) return;
  Look look = look_at_parts(job, cell, 2, triangles);
  if (is_passed && !look.is_off && look.proved > kEnough * tolerance_) {
    look = look_at_parts(job, cell, 3, triangles);
  }
  const bool should_be_exact = look.is_off ||
                               (is_passed && look.proved > kMostProved * tolerance_) ||
                               (look.is_folded && is_wall_lost(job, cell, triangles));
  if (!should_be_exact) {
    if (is_passed) brick.error = std::max(brick.error, look.proved);
    return;
  }
  const bool has_signs = look.has_sign && (!are_signs_in_doubt(triangles) ||
                                           (is_passed && is_continuous(job, cell, triangles)));
  if (has_signs && triangles.size() <= simd::kMostInList) {
    brick.cells.push_back(static_cast<std::uint16_t>(index));
    brick.lists.push_back(std::move(triangles));
  } else if (is_passed) {
    brick.error = std::max(brick.error, has_signs ? look.proved : kUnknown);
  }
}

/// Walls thinner than a sample's unit show at the surface alone.
bool ExactCellFinder::is_wall_lost(const Job& job, const Cube& cell,
                                   std::span<const std::uint32_t> triangles) const {
  const auto [x, y, z] = cell.first;
  const double h = grid_.voxel_size;
  const Vec3 corner = job.origin + h * Vec3{1.0 * x, 1.0 * y, 1.0 * z};
  auto samples = job.samples(cell);
  for (const std::uint32_t triangle : triangles) {
    const Vec3 nearest =
        closest_point_on_triangle(corner + 0.5 * h * Vec3{1.0, 1.0, 1.0}, mesh_.corners(triangle));
    const auto t = static_cast<Vec3f>((1.0 / h) * (nearest - corner));
    const auto is_within = [](float along) { return along >= 0.0f && along <= 1.0f; };
    if (!is_within(t.x) || !is_within(t.y) || !is_within(t.z)) continue;
    samples.t = {t.x, t.y, t.z};
    if (!(std::abs(simd::portable::interpolate(samples)) <= tolerance_)) return true;
  }
  return false;
}

ExactCells ExactCellFinder::assemble(std::span<const Brick> bricks) const {
  ExactCells exact;
  if (bricks.empty()) return exact;
  exact.bricks.resize(grid_.count());
  std::map<std::vector<std::uint32_t>, std::uint32_t, ComesBefore> known;
  std::uint32_t number = 0;
  for (const Brick& brick : bricks) {
    exact.bricks[brick.index] = ++number;
    const std::size_t masks = exact.masks.size();
    exact.masks.resize(masks + 2 * std::size_t{simd::kMaskWords});
    std::size_t next = 0;
    for (std::size_t word = 0; word < simd::kMaskWords; ++word) {
      exact.masks[masks + simd::kMaskWords + word] = static_cast<std::uint32_t>(exact.lists.size());
      for (; next < brick.cells.size() && brick.cells[next] / 32 == word; ++next) {
        exact.masks[masks + word] |= 1u << brick.cells[next] % 32;
        const auto& list = brick.lists[next];
        const std::size_t packed = exact.listed.size() << simd::kListCountBits | list.size();
        const auto [found, is_new] = known.try_emplace(list, static_cast<std::uint32_t>(packed));
        if (is_new) exact.listed.insert(exact.listed.end(), list.begin(), list.end());
        exact.lists.push_back(found->second);
      }
    }
  }
  // Only the triangles in use are kept, and indices become those among them.
  std::vector<std::uint32_t> used = exact.listed;
  std::ranges::sort(used);
  used.erase(std::unique(used.begin(), used.end()), used.end());
  const auto copy = [&](const std::vector<float>& all, std::size_t each, std::vector<float>& to) {
    to.reserve(each * used.size());
    for (const std::uint32_t triangle : used) {
      const auto from = all.begin() + static_cast<std::ptrdiff_t>(each * triangle);
      to.insert(to.end(), from, from + static_cast<std::ptrdiff_t>(each));
    }
  };
  copy(records_, simd::kTriangleFloats, exact.triangles);
  copy(features_.normals, simd::kFeatureNormalFloats, exact.feature_normals);
  for (std::uint32_t& triangle : exact.listed) {
    triangle = static_cast<std::uint32_t>(std::ranges::lower_bound(used, triangle) - used.begin());
  }
  return exact;
}

}  // namespace voxshell
