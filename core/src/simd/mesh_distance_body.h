#pragma once

#include "simd/exact_formula.h"
#include "simd/mesh_distance.h"
#include "simd/wide.h"

namespace voxshell::simd::VOXSHELL_ISA {

/// Cells along each axis of a brick.
inline constexpr int kCells = 8;
/// Nodes along each axis that are dealt with together.
inline constexpr int kPacketNodes = 2;
/// Outweighs the rounding of what is compared with it.
inline constexpr float kCullSlack = 1e-3f;  // voxels

/// Squared distances of points to triangles, one of the two being the same for all lanes.
/// `field(f)` gives the triangles' numbers, as F8 or as float.
template <class Field, class P>
[[gnu::always_inline]] inline F8 squared_distance(const Field& field, const P& x, const P& y,
                                                  const P& z) {
  const F8 zero = F8{};
  const F8 height =
      (field(kNormal) * x + field(kNormal + 1) * y) + (field(kNormal + 2) * z - field(kHeight));
  F8 nearest_edge = zero + 1e30f;
  F8 least_side = nearest_edge;
  for (int edge = 0; edge < 3; ++edge) {
    const int f = kFirstEdge + edge * kEdgeFields;
    const F8 along =
        (zero + field(f + kAlong) * x) + (field(f + kAlong + 1) * y + field(f + kAlong + 2) * z);
    const F8 side = (field(f + kInward) * x + field(f + kInward + 1) * y) +
                    (field(f + kInward + 2) * z - field(f + kSide));
    const F8 on_edge =
        minimum<F8>(maximum<F8>(along, zero + field(f + kLow)), zero + field(f + kHigh));
    const F8 off = along - on_edge;
    nearest_edge = minimum<F8>(nearest_edge, off * off + side * side);
    least_side = minimum<F8>(least_side, side);
  }
  return height * height + select(least_side > 0.0f, zero, nearest_edge);
}

/// Of eight triangles to one point.
[[gnu::always_inline]] inline F8 squared_distances_of_block(const float* block, float x, float y,
                                                            float z) {
  const auto field = [&](int f) { return load<F8>(block + 8 * f); };
  return squared_distance(field, x, y, z);
}

inline float least_of(F8 values) {
  float least = values[0];
  for (int i = 1; i < 8; ++i) least = minimum(least, values[i]);
  return least;
}

inline void subtract(const double* p, const float* center, float* local) {
  for (int axis = 0; axis < 3; ++axis) {
    local[axis] = static_cast<float>(p[axis] - static_cast<double>(center[axis]));
  }
}

[[gnu::always_inline]] inline F8 squared_distances_to_boxes(const BoxNode& node, const float* p) {
  F8 sum = F8{};
  for (int axis = 0; axis < 3; ++axis) {
    const F8 below = load<F8>(node.lower[axis]) - p[axis];
    const F8 above = p[axis] - load<F8>(node.upper[axis]);
    const F8 outside = maximum<F8>(maximum<F8>(below, above), F8{});
    sum += outside * outside;
  }
  return sum;
}

/// Deeper than any tree: each level has at least twice the blocks of the next.
inline constexpr int kMostWaiting = 8 * 32;

/// How far boxes may be that still matter.
inline float reach_of(const MeshTreeView& tree, float squared) {
  const float reach = square_root(squared) * (1.0f + 1e-6f) + tree.slack;
  return reach * reach;
}

inline Nearest find_nearest(const MeshTreeView& tree, const double* p, int32_t guess) {
  Nearest nearest{1e30f, 0};
  float bound = 1e30f;
  const auto look_into = [&](int32_t block) {
    float local[3];
    subtract(p, tree.centers + 3 * block, local);
    const F8 squared = squared_distances_of_block(tree.blocks + block * kBlockFloats, local[0],
                                                  local[1], local[2]);
    const float least = least_of(squared);
    if (least >= nearest.distance) return;
    nearest.distance = least;
    nearest.triangle = 8 * block + __builtin_ctz(bits(squared <= least));
    bound = reach_of(tree, least);
  };
  look_into(guess);

  const float single[3] = {static_cast<float>(p[0]), static_cast<float>(p[1]),
                           static_cast<float>(p[2])};
  int32_t waiting[kMostWaiting];
  float distances[kMostWaiting];
  int count = 0;
  waiting[count] = 0;
  distances[count++] = 0.0f;
  while (count > 0) {
    --count;
    if (distances[count] >= bound) continue;
    const int32_t child = waiting[count];
    if (child < 0) {
      if (~child != guess) look_into(~child);
      continue;
    }
    const BoxNode& node = tree.nodes[child];
    const F8 squared = squared_distances_to_boxes(node, single);
    float of_child[8];
    store(of_child, squared);
    const int first = count;
    unsigned near = bits(squared < bound);
    while (near != 0) {
      const int lane = __builtin_ctz(near);
      near &= near - 1;
      // The nearest goes on top.
      int place = count++;
      while (place > first && distances[place - 1] < of_child[lane]) {
        waiting[place] = waiting[place - 1];
        distances[place] = distances[place - 1];
        --place;
      }
      waiting[place] = node.child[lane];
      distances[place] = of_child[lane];
    }
  }
  nearest.distance = square_root(nearest.distance);
  return nearest;
}

inline int32_t find_blocks(const MeshTreeView& tree, const double* p, float radius, int32_t most,
                           int32_t* found) {
  const float single[3] = {static_cast<float>(p[0]), static_cast<float>(p[1]),
                           static_cast<float>(p[2])};
  const float bound = reach_of(tree, radius * radius);
  int32_t waiting[kMostWaiting];
  int count = 0;
  int32_t blocks = 0;
  waiting[count++] = 0;
  while (count > 0) {
    const BoxNode& node = tree.nodes[waiting[--count]];
    unsigned near = bits(squared_distances_to_boxes(node, single) <= bound);
    while (near != 0) {
      const int32_t child = node.child[__builtin_ctz(near)];
      near &= near - 1;
      if (child >= 0) {
        waiting[count++] = child;
      } else if (blocks == most) {
        return -1;
      } else {
        found[blocks++] = ~child;
      }
    }
  }
  return blocks;
}

/// Triangles, and how many blocks they fill.
struct Triangles {
  const float* fields;
  int32_t blocks;
};

/// Tells a block's triangles from (x, y, z).
inline void move_block(const float* from, float x, float y, float z, float* to) {
  const auto shift = [&](int direction, int offset) {
    const F8 by = load<F8>(from + 8 * direction) * x + load<F8>(from + 8 * direction + 8) * y +
                  load<F8>(from + 8 * direction + 16) * z;
    store(to + 8 * offset, load<F8>(from + 8 * offset) - by);
  };
  memcpy(to, from, kBlockFloats * sizeof(float));
  shift(kNormal, kHeight);
  for (int edge = 0; edge < 3; ++edge) {
    const int f = kFirstEdge + edge * kEdgeFields;
    shift(f + kAlong, f + kLow);
    shift(f + kAlong, f + kHigh);
    shift(f + kInward, f + kSide);
  }
}

/// Writes the numbers of the triangles that may be nearest to a point within `radius` of (x, y, z),
/// and returns how many they are.
inline int32_t find_nearby(const Triangles& triangles, float x, float y, float z, float radius,
                           float* squared, int32_t* found) {
  F8 least = F8{} + 1e30f;
  for (int32_t block = 0; block < triangles.blocks; ++block) {
    const F8 d = squared_distances_of_block(triangles.fields + block * kBlockFloats, x, y, z);
    store(squared + 8 * block, d);
    least = minimum<F8>(least, d);
  }
  const float reach = square_root(least_of(least)) * (1.0f + 1e-6f) + 2.0f * radius + kCullSlack;
  const float bound = reach * reach;
  int32_t count = 0;
  for (int32_t block = 0; block < triangles.blocks; ++block) {
    unsigned near = bits(load<F8>(squared + 8 * block) <= bound);
    while (near != 0) {
      found[count++] = 8 * block + __builtin_ctz(near);
      near &= near - 1;
    }
  }
  return count;
}

/// Copies some triangles next to one another.
inline Triangles gather_triangles(const Triangles& from, const int32_t* which, int32_t count,
                                  float* to) {
  const int32_t blocks = (count + 7) / 8;
  for (int32_t block = 0; block < blocks; ++block) {
    float* target = to + block * kBlockFloats;
    I8 place;
    const int32_t present = count - 8 * block < 8 ? count - 8 * block : 8;
    for (int lane = 0; lane < 8; ++lane) {
      // The last block is filled up with the last triangle: it changes no least distance.
      const int32_t i = which[8 * block + (lane < present ? lane : present - 1)];
      set_lane(place, lane, static_cast<int32_t>(i / 8 * kBlockFloats + i % 8));
    }
    for (int f = 0; f < kTriangleFields; ++f) {
      store(target + 8 * f, gather(from.fields + 8 * f, place));
    }
  }
  return {to, blocks};
}

/// Nodes first to last along each axis.
struct NodeRange {
  int first[3];
  int last[3];
};

struct Ball {
  float center[3];
  float radius;
};

/// The ball around nodes of a brick, voxels from its center.
inline Ball enclose(const NodeRange& nodes) {
  Ball ball;
  float squared = 0.0f;
  for (int axis = 0; axis < 3; ++axis) {
    const float sum = static_cast<float>(nodes.first[axis] + nodes.last[axis]);
    const float half = 0.5f * static_cast<float>(nodes.last[axis] - nodes.first[axis]);
    ball.center[axis] = 0.5f * sum - 0.5f * kCells;
    squared += half * half;
  }
  ball.radius = square_root(squared);
  return ball;
}

/// Distances of up to eight nodes, 2 along each axis.
inline void measure_packet(const Triangles& triangles, const NodeRange& nodes, float* squared,
                           int32_t* nearest, float* distances) {
  const Ball ball = enclose(nodes);
  const int32_t count = find_nearby(triangles, ball.center[0], ball.center[1], ball.center[2],
                                    ball.radius, squared, nearest);
  const float origin = -0.5f * kCells;
  const I8 lane{0, 1, 2, 3, 4, 5, 6, 7};
  const auto place = [&](int axis) {
    const F8 first = F8{} + (origin + static_cast<float>(nodes.first[axis]));
    const F8 last = F8{} + (origin + static_cast<float>(nodes.last[axis]));
    return select((lane & static_cast<int32_t>(1 << axis)) != 0, last, first);
  };
  const F8 x = place(0);
  const F8 y = place(1);
  const F8 z = place(2);
  F8 least = F8{} + 1e30f;
  for (int32_t k = 0; k < count; ++k) {
    const float* triangle = triangles.fields + nearest[k] / 8 * kBlockFloats + nearest[k] % 8;
    const auto field = [&](int f) { return triangle[8 * f]; };
    least = minimum<F8>(least, squared_distance(field, x, y, z));
  }
  float distance[8];
  store(distance, square_root(least));
  for (int i = 0; i < 8; ++i) {
    const int a = (i & 1) != 0 ? nodes.last[0] : nodes.first[0];
    const int b = (i & 2) != 0 ? nodes.last[1] : nodes.first[1];
    const int c = (i & 4) != 0 ? nodes.last[2] : nodes.first[2];
    distances[a + (kCells + 1) * (b + (kCells + 1) * c)] = distance[i];
  }
}

inline bool measure_brick(const MeshTreeView& tree, const double* center, float at_center,
                          const BrickScratch& scratch, float* distances) {
  const float half_diagonal = 0.5f * kCells * square_root(3.0f);
  const float radius = at_center + 2.0f * half_diagonal + kCullSlack;
  const int32_t found = find_blocks(tree, center, radius, scratch.most_blocks, scratch.blocks);
  if (found < 0) return false;
  Triangles triangles{scratch.moved, 0};
  for (int32_t i = 0; i < found; ++i) {
    const int32_t block = scratch.blocks[i];
    const float* fields = tree.blocks + block * kBlockFloats;
    float local[3];
    subtract(center, tree.centers + 3 * block, local);
    const F8 squared = squared_distances_of_block(fields, local[0], local[1], local[2]);
    if (!any(squared <= radius * radius)) continue;
    move_block(fields, local[0], local[1], local[2],
               scratch.moved + triangles.blocks++ * kBlockFloats);
  }

  constexpr int kPackets = kCells / kPacketNodes + 1;
  const auto range_of = [&](const int* first, const int* end) {
    NodeRange nodes;
    for (int axis = 0; axis < 3; ++axis) {
      nodes.first[axis] = kPacketNodes * first[axis];
      const int last = kPacketNodes * end[axis] - 1;
      nodes.last[axis] = last < kCells ? last : kCells;
    }
    return nodes;
  };
  // Eight groups of packets share what lies near them.
  for (int group = 0; group < 8; ++group) {
    int first[3];
    int end[3];
    for (int axis = 0; axis < 3; ++axis) {
      const bool upper = (group >> axis & 1) != 0;
      first[axis] = upper ? kPackets / 2 : 0;
      end[axis] = upper ? kPackets : kPackets / 2;
    }
    const Ball ball = enclose(range_of(first, end));
    const int32_t count = find_nearby(triangles, ball.center[0], ball.center[1], ball.center[2],
                                      ball.radius, scratch.squared, scratch.nearby);
    const Triangles nearby = gather_triangles(triangles, scratch.nearby, count, scratch.gathered);
    for (int c = first[2]; c < end[2]; ++c) {
      for (int b = first[1]; b < end[1]; ++b) {
        for (int a = first[0]; a < end[0]; ++a) {
          const int from[3] = {a, b, c};
          const int to[3] = {a + 1, b + 1, c + 1};
          measure_packet(nearby, range_of(from, to), scratch.squared, scratch.nearest, distances);
        }
      }
    }
  }
  return true;
}

inline void measure_listed(const float* records, const uint32_t* listed, uint32_t count,
                           const float* p, float* squared) {
  const Triple<F8> place{splat<F8>(p[0]), splat<F8>(p[1]), splat<F8>(p[2])};
  const ListedTriangles list{listed, count, records, nullptr};
  for (uint32_t first = 0; first < count; first += kLanes) {
    store(squared + first, measure_eight_triangles(list, first, place));
  }
}

inline void compare_listed(const float* records, const uint32_t* listed, uint32_t count,
                           const float* places, float reach, float* work, uint8_t* may_be_nearest,
                           float* squared, int32_t* nearest, float* squared_chord) {
  const Triple<F8> all{load<F8>(places), load<F8>(places + 8), load<F8>(places + 16)};
  const auto row = [&](uint32_t i, int k) {
    const float* record = records + uint64_t{listed[i]} * kTriangleFloats + k;
    return Triple<F8>{splat<F8>(record[0]), splat<F8>(record[1]), splat<F8>(record[2])};
  };
  F8 least = splat<F8>(__builtin_inff());
  I8 at_least{};
  for (uint32_t i = 0; i < count; ++i) {
    const F8 d =
        find_on_triangle(subtract(all, row(i, 0)), row(i, 3), row(i, 6), row(i, kRecordNormal))
            .squared_distance;
    const I8 is_nearer = d < least;
    least = select(is_nearer, d, least);
    at_least = select(is_nearer, I8{} + static_cast<int32_t>(i), at_least);
    store(work + 8 * uint64_t{i}, d);
  }
  Triple<F8> normal{};
  for (int lane = 0; lane < kLanes; ++lane) {
    const auto triangle = uint64_t{listed[at_least[lane]]};
    const float* record = records + triangle * kTriangleFloats + kRecordNormal;
    set_lane(normal, lane, Triple<float>{record[0], record[1], record[2]});
  }
  const F8 farthest = square_root(least) + reach;
  const F8 limit = farthest * farthest;
  F8 chord{};
  for (uint32_t i = 0; i < count; ++i) {
    const I8 is_near = load<F8>(work + 8 * uint64_t{i}) <= limit;
    if (bits(is_near) == 0) continue;
    may_be_nearest[i] = 1;
    const Triple<F8> between = subtract(row(i, kRecordNormal), normal);
    chord = maximum(chord, select(is_near, dot(between, between), F8{}));
  }
  store(squared, least);
  memcpy(nearest, &at_least, sizeof at_least);
  store(squared_chord, chord);
}

inline void evaluate_listed(const float* records, const float* feature_normals,
                            const uint32_t* listed, uint32_t count, const float* places,
                            uint32_t place_count, float* distances) {
  const ListedTriangles list{listed, count, records, feature_normals};
  constexpr uint32_t kMost = 256;
  uint32_t first = 0;
  if (count <= kMost) {
    // Of triangles that are equally near, evaluate_triangles() takes the first in this order.
    uint32_t ordered[kMost];
    uint32_t next = 0;
    for (uint32_t lane = 0; lane < kLanes; ++lane) {
      for (uint32_t i = lane; i < count; i += kLanes) ordered[next++] = listed[i];
    }
    const ListedTriangles in_order{ordered, count, records, feature_normals};
    for (; first + kLanes <= place_count; first += kLanes) {
      float by_axis[3][kLanes];
      for (uint32_t lane = 0; lane < kLanes; ++lane) {
        const float* p = places + 3 * uint64_t{first + lane};
        for (int axis = 0; axis < 3; ++axis) by_axis[axis][lane] = p[axis];
      }
      const Triple<F8> eight{load<F8>(by_axis[0]), load<F8>(by_axis[1]), load<F8>(by_axis[2])};
      store(distances + first, evaluate_triangles_at(in_order, eight).distance);
    }
  }
  for (uint32_t i = first; i < place_count; ++i) {
    const float* p = places + 3 * uint64_t{i};
    distances[i] = evaluate_triangles(list, p[0], p[1], p[2]).distance;
  }
}

}  // namespace voxshell::simd::VOXSHELL_ISA
