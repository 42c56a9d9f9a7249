#pragma once

// Kernels about places that move a little: bounds of the field near each, without the error of the
// cells between which it is not continuous.

#include "simd/edge_body.h"
#include "simd/list_body.h"

namespace voxshell::simd::VOXSHELL_ISA {

/// Of a cell's trilinear function: the least that it can be within `radius` meters of a place whose
/// coordinates in the cell are `cell.t`, which may lie beyond the cell by `beyond` of its edge.
/// Along each axis a function is no steeper than its steepest edge, and beyond the cell by little
/// more.
VOXSHELL_INLINE F8 bound_cell(const GridView& grid, const GridCell<F8>& cell, F8 beyond,
                              float radius) {
  const auto& c = cell.c;
  const auto steepest = [&](int step, int i, int j, int k) {
    const auto rise = [&](int from) { return absolute(c[from + step] - c[from]); };
    return maximum(maximum(rise(0), rise(i)), maximum(rise(j), rise(k)));
  };
  const Triple<F8> rises{steepest(1, 2, 4, 6), steepest(2, 1, 4, 5), steepest(4, 1, 2, 3)};
  const F8 farther = 1.0f + 2.0f * beyond;
  const F8 slope =
      length(rises) * (farther * farther) * cell.scale * (grid.inverse_voxel_size / cell.size);
  return interpolate(cell) - slope * radius;
}

/// Puts bounds by the triangles of exact cells, where corners lie in such, in place of others. The
/// distance from triangles changes by no more than the way. On which side of them a place lies is
/// known in their cell alone: where the surface may pass between a corner and the place, the place
/// counts as inside.
VOXSHELL_INLINE void bound_exact_cells(const ExactGridView& grid, const GridPlace<F8>& place,
                                       const Triple<F8>& corners, const Triple<float>& p,
                                       float radius, F8& bound) {
  const I8 lists = find_exact_lists(grid, place, find_exact_bricks(grid, place));
  constexpr float kDiagonal = 1.7321f;  // of a cube, in its sides
  const float fall = kDiagonal * radius;
  for (unsigned left = bits(lists != 0); left != 0;) {
    const int lane = __builtin_ctz(left);
    const I8 is_same = lists == lists[lane];
    const ListedTriangles triangles = triangles_of(grid, static_cast<uint32_t>(lists[lane]));
    const float distance = evaluate_triangles(triangles, p.x, p.y, p.z).distance;
    const float away = __builtin_fabsf(distance);
    const bool is_known =
        away > fall &&
        evaluate_triangles(triangles, corners.x[lane], corners.y[lane], corners.z[lane]).distance *
                distance >
            0.0f;
    bound = select(is_same, splat<F8>((is_known ? distance : -away) - fall), bound);
    left &= ~bits(is_same);
  }
}
VOXSHELL_INLINE void bound_exact_cells(const GridView&, const GridPlace<F8>&, const Triple<F8>&,
                                       const Triple<float>&, float, F8&) {}

/// No place within `radius` of p, the shell's frame, has a smaller distance; minus infinity where
/// no more is known than bound_points() says.
template <class V>
VOXSHELL_INLINE float bound_small_ball(const PosedView<V>&, const Triple<float>&, float) {
  return -__builtin_inff();
}
/// A cube that is smaller than the cells that it meets has a corner in each of them. The field is
/// continuous within each, so it is bounded by what each says of the cube's middle. Where that lies
/// beyond the grid, so is the nearest point of the grid, as the cube seen from there is no larger.
template <class G>
  requires kIsGrid<G>
VOXSHELL_INLINE float bound_small_ball(const PosedView<G>& posed, const Triple<float>& p,
                                       float radius) {
  constexpr F8 kX = {-1, 1, -1, 1, -1, 1, -1, 1};
  constexpr F8 kY = {-1, -1, 1, 1, -1, -1, 1, 1};
  constexpr F8 kZ = {-1, -1, -1, -1, 1, 1, 1, 1};
  constexpr float kMost = 0.499f;  // half of the cube's side, in cells
  const G& grid = posed.field;
  const float half_side = radius + posed.slack;
  const float in_voxels = half_side * grid.inverse_voxel_size;
  if (in_voxels > kMost * kBrickCells) return -__builtin_inff();
  const Triple<float> q = to_field(posed, p);
  const Triple<F8> corners{q.x + half_side * kX, q.y + half_side * kY, q.z + half_side * kZ};
  const auto place = locate(grid, corners);
  const I8 entry = gather(grid.entries, place.brick);
  const I8 is_plane = (entry & kPlaneBit) != 0;
  GridCell<F8> cell = load_cell<F8>(grid, place, entry, /*is_one_brick=*/false);
  F8 size = select(is_plane, splat<F8>(kBrickCells), cell.size);
  if constexpr (kHasExactCells<G>) {
    size = select(find_exact_bricks(grid, place) != 0, splat<F8>(1.0f), size);
  }
  if (in_voxels > kMost * find_least(size)) return -__builtin_inff();

  const auto of_middle = locate(grid, q);
  const Triple<float> outside = measure_outside(grid, of_middle);
  const Triple<float> middle = subtract(q, outside);
  // From the middle to the corners, as far as the grid reaches.
  const F8 beyond = in_voxels / cell.size;
  cell.t = {cell.t.x - (in_voxels * kX - place.outside.x + of_middle.outside.x) / cell.size,
            cell.t.y - (in_voxels * kY - place.outside.y + of_middle.outside.y) / cell.size,
            cell.t.z - (in_voxels * kZ - place.outside.z + of_middle.outside.z) / cell.size};
  F8 bound = bound_cell(grid, cell, beyond, half_side);
  if (any(is_plane)) {
    const I8 index = select(is_plane, as_payload(entry) * 4, I8{});
    const F8 along = gather(grid.planes, index) * middle.x +
                     gather(grid.planes, index + 1) * middle.y +
                     gather(grid.planes, index + 2) * middle.z;
    bound = select(is_plane, along - gather(grid.planes, index + 3) - half_side, bound);
  }
  const Triple<F8> places = subtract(corners, measure_outside(grid, place));
  bound_exact_cells(grid, place, places, middle, half_side, bound);
  const float least = find_least(bound) - posed.slack;
  const float away = length(outside) - half_side;
  if (!(least > 0.0f) || !(away > 0.0f)) return least;
  return square_root(least * least + away * away) - posed.slack;
}

/// Whether a place within `radius` of one that bound_points() does not clear may be below the
/// margin.
template <class V>
VOXSHELL_INLINE bool may_be_below(const PosedView<V>& posed, const Triple<float>& p, float margin,
                                  float radius) {
  return !(bound_small_ball(posed, p, radius) >= margin);
}

template <class V>
bool may_come_below(const PosedView<V>& posed, const PointList& points, float margin,
                    float growth) {
  for (uint32_t i = 0; i < points.count; ++i) {
    const Triple<float> p{points.x[i], points.y[i], points.z[i]};
    // Planes have told all.
    if (points.tag[i] != 0 || may_be_below(posed, p, margin, growth)) return true;
  }
  return false;
}

/// Whether a piece of an edge may come below the margin: by balls about eight places along it, and
/// of those that may, by eight along each, until they are no larger than the motion.
template <class V>
VOXSHELL_INLINE bool may_piece_come_below(const PosedView<V>& posed, const Triple<float>& middle,
                                          const Triple<float>& half, float margin, float growth) {
  struct Part {
    float t;
    float width;
  };
  constexpr F8 kCenters = {-0.875f, -0.625f, -0.375f, -0.125f, 0.125f, 0.375f, 0.625f, 0.875f};
  constexpr float kFraction = 0.1251f;
  constexpr int kMostParts = 64;
  const float length = square_root(half.x * half.x + half.y * half.y + half.z * half.z);
  Part parts[kMostParts];
  int count = 0;
  parts[count++] = {0.0f, 1.0f};
  while (count > 0) {
    const Part part = parts[--count];
    const float reach = kFraction * part.width * length;
    const float radius = reach + growth;
    const F8 t = part.t + part.width * kCenters;
    const Triple<F8> places = place_on_edge(middle, half, t);
    const F8 bound = bound_points(posed, places, 0, radius, margin);
    for (unsigned lanes = lanes_below(bound, margin); lanes != 0; lanes &= lanes - 1) {
      const int lane = __builtin_ctz(lanes);
      const Triple<float> p{places.x[lane], places.y[lane], places.z[lane]};
      if (!may_be_below(posed, p, margin, radius)) continue;
      if (reach <= growth || count == kMostParts) return true;
      parts[count++] = {t[lane], 0.125f * part.width};
    }
  }
  return false;
}

template <class V>
bool may_edges_come_below(const PosedView<V>& posed, const EdgeView& edges, const PointList& pieces,
                          float margin, float growth) {
  for (uint32_t i = 0; i < pieces.count; ++i) {
    const Triple<float> middle{pieces.x[i], pieces.y[i], pieces.z[i]};
    const Triple<float> half = half_of(edges, pieces.id[i]);
    if (may_piece_come_below(posed, middle, half, margin, growth)) return true;
  }
  return false;
}

}  // namespace voxshell::simd::VOXSHELL_ISA
