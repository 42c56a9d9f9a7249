#include "mesh/distance_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "voxshell/parallel.h"

namespace voxshell {
namespace {

constexpr std::size_t kLanes = simd::kBlockTriangles;
/// A triangle lower than this has edges alone.
constexpr double kThinnest = 1e-4;  // voxels
/// Bricks that more triangles than these may be the nearest of are measured node by node.
constexpr std::ptrdiff_t kMostBlocks = 512;

std::size_t blocks_for(std::size_t triangles) { return (triangles + kLanes - 1) / kLanes; }

/// The half of some blocks that goes to the left.
std::size_t left_half(std::size_t blocks) { return (blocks + 1) / 2; }

/// Any unit vector at right angles to another.
Vec3 perpendicular(const Vec3& direction) {
  const Vec3 axis = std::abs(direction.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  return normalized(cross(direction, axis));
}

/// Writes a triangle's numbers, see simd::TriangleField, into its lane of a block.
void write_triangle(const std::array<Vec3, 3>& corners, float* lane) {
  std::array<double, 3> lengths{};
  std::size_t longest = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    lengths[i] = length(corners[(i + 1) % 3] - corners[i]);
    if (lengths[i] > lengths[longest]) longest = i;
  }
  const Vec3 doubled = cross(corners[1] - corners[0], corners[2] - corners[0]);
  const double doubled_area = length(doubled);
  const bool is_thin = doubled_area <= kThinnest * lengths[longest];
  // That of a triangle that is a point is any.
  const auto along_side = [&](std::size_t i) {
    return lengths[i] > 0.0 ? (corners[(i + 1) % 3] - corners[i]) / lengths[i] : Vec3{1, 0, 0};
  };
  const Vec3 normal = is_thin ? perpendicular(along_side(longest)) : doubled / doubled_area;

  // Offsets go with the directions as they are after rounding.
  const auto write = [&](std::size_t field, const Vec3& direction) {
    const auto rounded = static_cast<Vec3f>(direction);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lane[8 * (field + axis)] = rounded[static_cast<int>(axis)];
    }
    return static_cast<Vec3>(rounded);
  };
  const auto write_offset = [&](std::size_t field, const Vec3& direction, const Vec3& corner) {
    lane[8 * field] = static_cast<float>(dot(direction, corner));
  };
  write_offset(simd::kHeight, write(simd::kNormal, normal), corners[longest]);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t side = is_thin ? longest : i;
    const Vec3& from = corners[side];
    const Vec3& to = corners[(side + 1) % 3];
    // Those without a normal are on neither side of their edge.
    const Vec3 inward = (is_thin && i > 0 ? -1.0 : 1.0) * cross(normal, along_side(side));
    const std::size_t first = simd::kFirstEdge + i * simd::kEdgeFields;
    const Vec3 along = write(first + simd::kAlong, along_side(side));
    write_offset(first + simd::kLow, along, from);
    write_offset(first + simd::kHigh, along, to);
    write_offset(first + simd::kSide, write(first + simd::kInward, inward), from);
  }
}

float round_down(double value) {
  return std::nextafter(static_cast<float>(value), -std::numeric_limits<float>::infinity());
}
float round_up(double value) {
  return std::nextafter(static_cast<float>(value), std::numeric_limits<float>::infinity());
}

}  // namespace

DistanceTree::DistanceTree(const TriangleMesh& mesh, const Vec3& origin, double voxel_size,
                           unsigned threads) {
  order_triangles(mesh, threads);
  const std::size_t blocks = blocks_for(order_.size());
  blocks_.resize(blocks * simd::kBlockFloats);
  centers_.resize(3 * blocks);
  std::vector<Bounds> bounds(blocks);
  constexpr std::size_t kChunk = 256;
  parallel_for((blocks + kChunk - 1) / kChunk, threads, {}, {}, [&](std::size_t chunk) {
    const std::size_t end = std::min(blocks, (chunk + 1) * kChunk);
    for (std::size_t block = chunk * kChunk; block < end; ++block) {
      std::array<std::array<Vec3, 3>, kLanes> triangles;
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        // The last block is filled up with the last triangle: it changes no least distance.
        triangles[lane] = mesh.corners(order_[std::min(block * kLanes + lane, order_.size() - 1)]);
        for (Vec3& corner : triangles[lane]) {
          corner = (corner - origin) / voxel_size;
          bounds[block].extend(corner);
        }
      }
      const auto center = static_cast<Vec3f>(bounds[block].center());
      for (std::size_t axis = 0; axis < 3; ++axis) {
        centers_[3 * block + axis] = center[static_cast<int>(axis)];
      }
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        for (Vec3& corner : triangles[lane]) corner = corner - static_cast<Vec3>(center);
        write_triangle(triangles[lane], &blocks_[block * simd::kBlockFloats + lane]);
      }
    }
  });
  Bounds all;
  for (const Bounds& of_block : bounds) all.extend(of_block);
  // Of float32 positions anywhere between the grid's origin and the far side of the mesh.
  slack_ = static_cast<float>(1e-6 * (length(all.lower) + length(all.upper)) + 1e-5);
  build_node(0, blocks, bounds);
}

/// Median splits along the longest axis, such that all blocks but the last are full.
void DistanceTree::order_triangles(const TriangleMesh& mesh, unsigned threads) {
  const std::size_t count = mesh.triangles().size();
  order_.resize(count);
  std::iota(order_.begin(), order_.end(), 0u);
  std::vector<Vec3f> centers(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto [a, b, c] = mesh.corners(i);
    centers[i] = static_cast<Vec3f>((a + b + c) / 3.0);
  }
  struct Range {
    std::size_t begin;
    std::size_t end;
  };
  const auto split = [&](const Range& range) {
    Vec3f lower = centers[order_[range.begin]];
    Vec3f upper = lower;
    for (std::size_t i = range.begin; i < range.end; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        lower[axis] = std::min(lower[axis], centers[order_[i]][axis]);
        upper[axis] = std::max(upper[axis], centers[order_[i]][axis]);
      }
    }
    const Vec3f extents = upper - lower;
    const int axis = extents.x >= extents.y && extents.x >= extents.z ? 0
                     : extents.y >= extents.z                         ? 1
                                                                      : 2;
    const std::size_t middle =
        range.begin + kLanes * left_half(blocks_for(range.end - range.begin));
    const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(
        at(range.begin), at(middle), at(range.end), [&](std::uint32_t a, std::uint32_t b) {
          return centers[a][axis] != centers[b][axis] ? centers[a][axis] < centers[b][axis] : a < b;
        });
    return middle;
  };
  const auto sort_below = [&](const auto& self, const Range& range) -> void {
    if (range.end - range.begin <= kLanes) return;
    const std::size_t middle = split(range);
    self(self, {range.begin, middle});
    self(self, {middle, range.end});
  };
  // A few levels here, the parts below them on all threads.
  std::vector<Range> parts{{0, count}};
  for (int level = 0; level < 4; ++level) {
    std::vector<Range> halves;
    std::vector<std::size_t> middles(parts.size());
    parallel_for(parts.size(), threads, {}, {}, [&](std::size_t i) {
      const bool is_block = parts[i].end - parts[i].begin <= kLanes;
      middles[i] = is_block ? parts[i].end : split(parts[i]);
    });
    for (std::size_t i = 0; i < parts.size(); ++i) {
      halves.push_back({parts[i].begin, middles[i]});
      if (middles[i] < parts[i].end) halves.push_back({middles[i], parts[i].end});
    }
    parts = std::move(halves);
  }
  parallel_for(parts.size(), threads, {}, {},
               [&](std::size_t i) { sort_below(sort_below, parts[i]); });
}

std::int32_t DistanceTree::build_node(std::size_t first_block, std::size_t blocks,
                                      const std::vector<Bounds>& of) {
  struct Range {
    std::size_t first;
    std::size_t count;
  };
  std::vector<Range> children{{first_block, blocks}};
  for (int level = 0; level < 3; ++level) {
    std::vector<Range> halves;
    for (const auto& [first, count] : children) {
      const std::size_t left = left_half(count);
      halves.push_back({first, left});
      if (count > left) halves.push_back({first + left, count - left});
    }
    children = std::move(halves);
  }
  const std::size_t self = nodes_.size();
  nodes_.emplace_back();
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    Bounds bounds;
    std::int32_t child = 0;
    if (lane < children.size()) {
      const auto& [first, count] = children[lane];
      for (std::size_t block = first; block < first + count; ++block) bounds.extend(of[block]);
      child = count == 1 ? ~static_cast<std::int32_t>(first) : build_node(first, count, of);
    }
    constexpr float kFarAway = 1e18f;
    for (int axis = 0; axis < 3; ++axis) {
      const bool is_empty = lane >= children.size();
      nodes_[self].lower[axis][lane] = is_empty ? kFarAway : round_down(bounds.lower[axis]);
      nodes_[self].upper[axis][lane] = is_empty ? kFarAway : round_up(bounds.upper[axis]);
    }
    nodes_[self].child[lane] = child;
  }
  return static_cast<std::int32_t>(self);
}

simd::MeshTreeView DistanceTree::view() const {
  return {nodes_.data(), blocks_.data(), centers_.data(), slack_};
}

DistanceTree::Nearest DistanceTree::find_nearest(const Vec3& p, std::int32_t guess) const {
  const auto [distance, found] =
      simd::mesh_distance_kernels().find_nearest(view(), std::array{p.x, p.y, p.z}.data(), guess);
  const auto place = std::min(static_cast<std::size_t>(found), order_.size() - 1);
  return {distance, order_[place], found / simd::kBlockTriangles};
}

std::vector<std::int32_t> DistanceTree::list_guesses() const {
  std::vector<std::int32_t> guesses(order_.size());
  for (std::size_t i = 0; i < order_.size(); ++i) {
    guesses[order_[i]] = static_cast<std::int32_t>(i / kLanes);
  }
  return guesses;
}

bool DistanceTree::find_within(const Vec3& p, double radius, std::size_t most,
                               std::vector<std::uint32_t>& found) const {
  std::vector<std::int32_t> blocks(blocks_for(most));
  const std::int32_t count = simd::mesh_distance_kernels().find_blocks(
      view(), std::array{p.x, p.y, p.z}.data(), static_cast<float>(radius),
      static_cast<std::int32_t>(blocks.size()), blocks.data());
  found.clear();
  for (std::int32_t i = 0; i < count; ++i) {
    const std::size_t first =
        kLanes * static_cast<std::size_t>(blocks[static_cast<std::size_t>(i)]);
    const std::size_t last = std::min(first + kLanes, order_.size());
    found.insert(found.end(), order_.begin() + static_cast<std::ptrdiff_t>(first),
                 order_.begin() + static_cast<std::ptrdiff_t>(last));
  }
  return count >= 0;
}

void DistanceTree::measure_brick(const Vec3& center, float at_center, Scratch& scratch,
                                 std::span<float> distances) const {
  if (!scratch.floats) {
    // A megabyte, of which most bricks need little.
    scratch.indices =
        std::make_unique_for_overwrite<std::int32_t[]>(kMostBlocks * (1 + 2 * kLanes));
    scratch.floats = std::make_unique_for_overwrite<float[]>(
        kMostBlocks * (2 * std::size_t{simd::kBlockFloats} + kLanes));
  }
  std::int32_t* blocks = scratch.indices.get();
  float* moved = scratch.floats.get();
  float* gathered = moved + kMostBlocks * simd::kBlockFloats;
  const simd::BrickScratch work{static_cast<std::int32_t>(kMostBlocks),
                                blocks,
                                moved,
                                gathered,
                                gathered + kMostBlocks * simd::kBlockFloats,
                                blocks + kMostBlocks,
                                blocks + kMostBlocks * (1 + kLanes)};
  const auto& kernels = simd::mesh_distance_kernels();
  if (kernels.measure_brick(view(), std::array{center.x, center.y, center.z}.data(), at_center,
                            work, distances.data())) {
    return;
  }
  Nearest nearest{};
  for (std::size_t node = 0; node < distances.size(); ++node) {
    const std::array<std::size_t, 3> place{node % 9, node / 9 % 9, node / 81};
    const Vec3 p =
        center + Vec3{static_cast<double>(place[0]) - 4.0, static_cast<double>(place[1]) - 4.0,
                      static_cast<double>(place[2]) - 4.0};
    nearest = find_nearest(p, nearest.guess);
    distances[node] = nearest.distance;
  }
}

}  // namespace voxshell
