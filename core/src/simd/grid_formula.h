#pragma once

#include "simd/exact_formula.h"
#include "simd/grid_view.h"
#include "simd/wide.h"

namespace voxshell::simd::VOXSHELL_ISA {

template <class G>
inline constexpr bool kIsGrid = false;
template <>
inline constexpr bool kIsGrid<GridView> = true;
template <>
inline constexpr bool kIsGrid<ExactGridView> = true;
template <class G>
inline constexpr bool kHasExactCells = false;
template <>
inline constexpr bool kHasExactCells<ExactGridView> = true;

/// Where points fall: the nearest point of the grid and its brick.
template <class F>
struct GridPlace {
  Triple<F> outside;  ///< from the nearest point of the grid to the point, voxels
  Triple<F> within;   ///< position in the brick, voxels, 0 to kBrickCells
  Integer<F> brick;
};

/// In this order, not-a-number becomes 0 here and stays what it is in `outside`.
template <class F>
VOXSHELL_INLINE Integer<F> clamp_to_axis(const GridView& grid, int axis, F p, F& outside,
                                         F& within) {
  const F unclamped = (p - grid.origin[axis]) * grid.inverse_voxel_size;
  const F clamped = minimum(maximum(unclamped, splat<F>(0.0f)), splat<F>(grid.cells[axis]));
  outside = unclamped - clamped;
  const Integer<F> last = Integer<F>{} + grid.last_brick[axis];
  const Integer<F> brick = minimum(to_int(clamped) >> kBrickShift, last);
  within = clamped - to_float(brick << kBrickShift);
  return brick;
}

template <class F>
VOXSHELL_INLINE GridPlace<F> locate(const GridView& grid, const Triple<F>& p) {
  GridPlace<F> place;
  const auto x = clamp_to_axis(grid, 0, p.x, place.outside.x, place.within.x);
  const auto y = clamp_to_axis(grid, 1, p.y, place.outside.y, place.within.y);
  const auto z = clamp_to_axis(grid, 2, p.z, place.outside.z, place.within.z);
  place.brick = x + grid.bricks_x * y + grid.bricks_xy * z;
  return place;
}

/// From the nearest point of the grid, meters.
template <class F>
VOXSHELL_INLINE Triple<F> measure_outside(const GridView& grid, const GridPlace<F>& place) {
  return {place.outside.x * grid.voxel_size, place.outside.y * grid.voxel_size,
          place.outside.z * grid.voxel_size};
}

/// The corners of the cell that a point falls in, in quanta: c[x + 2 y + 4 z], and where in it.
template <class F>
struct GridCell {
  F c[8];
  Triple<F> t;  ///< 0 to 1
  F scale;      ///< meters of one quantum
  F size;       ///< edge of the cell, voxels
  bool is_one;  ///< all places fall in one cell
};

/// The number that follows an entry's fields; entries are unsigned.
template <class I>
VOXSHELL_INLINE I as_payload(I entry) {
  return shift_down(entry, kPayloadShift);
}

/// The lanes whose entries say that there is a plane.
VOXSHELL_INLINE unsigned find_planes(int32_t entry) { return bits((entry & kPlaneBit) != 0); }
VOXSHELL_INLINE unsigned find_planes(I8 entry) {
  static_assert(kPlaneBit == 4);
  return bits(entry << 29);
}

template <class F>
VOXSHELL_INLINE F lerp(F a, F b, F t) {
  return a + t * (b - a);
}

/// From the first sample of each cell: the four pairs along x that make up its corners.
template <class F>
VOXSHELL_INLINE void load_corners(const GridView& grid, Integer<F> first, Integer<F> row,
                                  Integer<F> layer, GridCell<F>& cell) {
  using I = Integer<F>;
  const I pairs[4] = {gather_pair(grid.samples, first), gather_pair(grid.samples, first + row),
                      gather_pair(grid.samples, first + layer),
                      gather_pair(grid.samples, first + layer + row)};
  for (int i = 0; i < 4; ++i) {
    cell.c[2 * i] = to_float((pairs[i] << 16) >> 16);
    cell.c[2 * i + 1] = to_float(pairs[i] >> 16);
  }
}
/// The same of one cell that all eight places fall in.
VOXSHELL_INLINE void repeat_corners(const GridView& grid, int32_t first, int32_t row, int32_t layer,
                                    GridCell<F8>& cell) {
  GridCell<float> one;
  load_corners<float>(grid, first, row, layer, one);
  for (int i = 0; i < 8; ++i) cell.c[i] = splat<F8>(one.c[i]);
}

/// Tables of the lowest three bits of an entry, which describe its samples: how many cells there
/// are to a side, less one; how many to a voxel; how large they are, voxels; where the index of the
/// first is; and how far samples are apart along y and z, a pair, where there is more than one
/// cell. One path for all of them: branches on what lanes meet would be guessed wrong.
struct CellTables {
  static_assert(kSampleAlignment == 4);
  static constexpr int32_t kPayload = INT32_MAX >> (kPayloadShift - 3) & ~3;
  static constexpr int32_t kCorner = INT32_MAX >> (kPayloadShift - 1);
  int32_t last_cell[8] = {0, 1, 3, 7, 0, 0, 0, 0};
  float per_voxel[8] = {0.125f, 0.25f, 0.5f, 1.0f, 0.0f, 0.0f, 0.0f, 0.0f};
  float size[8] = {8.0f, 4.0f, 2.0f, 1.0f, 1.0f, 1.0f, 1.0f, 1.0f};
  int32_t shift[8] = {kPayloadShift, kPayloadShift - 2, kPayloadShift - 2, kPayloadShift - 2};
  int32_t payload[8] = {kCorner, kPayload, kPayload, kPayload};
  int32_t strides[8] = {0, 3 | 9 << 16, 5 | 25 << 16, 9 | 81 << 16};
};
inline constexpr CellTables kCellTables;

/// Lanes whose brick holds a plane get some cell or other.
/// @param is_one_brick  That all places fall in.
template <class F>
VOXSHELL_INLINE GridCell<F> load_cell(const GridView& grid, const GridPlace<F>& place,
                                      Integer<F> entry, bool is_one_brick) {
  using I = Integer<F>;
  const F per_voxel = look_up(kCellTables.per_voxel, entry);
  const I last = look_up(kCellTables.last_cell, entry);
  const auto find_cell = [&](F within, F& t) {
    const F position = within * per_voxel;
    const I cell = minimum(to_int(position), last);
    t = position - to_float(cell);
    return cell;
  };
  GridCell<F> cell;
  const I x = find_cell(place.within.x, cell.t.x);
  const I y = find_cell(place.within.y, cell.t.y);
  const I z = find_cell(place.within.z, cell.t.z);
  const I brick =
      shift_down(entry, look_up(kCellTables.shift, entry)) & look_up(kCellTables.payload, entry);
  const I first = brick + x + dot_pairs(make_pair(y, z), look_up(kCellTables.strides, entry));
  cell.is_one = is_one_brick && is_uniform(first);
  if constexpr (sizeof(F) == sizeof(F8)) {
    if (cell.is_one) {
      const int32_t kind = entry[0] & 7;
      repeat_corners(grid, first[0], grid.rows[kind], grid.layers[kind], cell);
    } else {
      load_corners(grid, first, look_up(grid.rows, entry), look_up(grid.layers, entry), cell);
    }
  } else {
    load_corners(grid, first, look_up(grid.rows, entry), look_up(grid.layers, entry), cell);
  }
  // The exponent is added to that of the quantum: cheaper than a product, and the same.
  cell.scale = as_float(as_int(splat<F>(grid.quantum)) +
                        ((entry & (kFieldMask << kFieldShift)) << (23 - kFieldShift)));
  cell.size = look_up(kCellTables.size, entry);
  return cell;
}

template <class F>
VOXSHELL_INLINE F interpolate(const GridCell<F>& cell) {
  const auto& c = cell.c;
  const auto& t = cell.t;
  const F low = lerp(lerp(c[0], c[1], t.x), lerp(c[2], c[3], t.x), t.y);
  const F high = lerp(lerp(c[4], c[5], t.x), lerp(c[6], c[7], t.x), t.y);
  return lerp(low, high, t.z) * cell.scale;
}

/// The gradient of interpolate().
template <class F>
VOXSHELL_INLINE Triple<F> differentiate(const GridCell<F>& cell, float inverse_voxel_size) {
  const auto& c = cell.c;
  const auto& t = cell.t;
  const F scale = cell.scale * inverse_voxel_size / cell.size;
  const F x = lerp(lerp(c[1] - c[0], c[3] - c[2], t.y), lerp(c[5] - c[4], c[7] - c[6], t.y), t.z);
  const F y = lerp(lerp(c[2] - c[0], c[3] - c[1], t.x), lerp(c[6] - c[4], c[7] - c[5], t.x), t.z);
  const F z = lerp(lerp(c[4] - c[0], c[5] - c[1], t.x), lerp(c[6] - c[2], c[7] - c[3], t.x), t.y);
  return {x * scale, y * scale, z * scale};
}

/// How much farther apart the values of two corners of a cell may be than the corners are, in the
/// steepest direction: along each axis no edge is steeper than the steepest.
VOXSHELL_INLINE F8 find_steepness(const GridView& grid, const GridCell<F8>& cell) {
  float c[8];
  for (int i = 0; i < 8; ++i) c[i] = cell.c[i][0];
  const auto steepest = [&](int step, int i, int j, int k) {
    const auto rise = [&](int from) { return absolute(c[from + step] - c[from]); };
    return maximum(maximum(rise(0), rise(i)), maximum(rise(j), rise(k)));
  };
  const float x = steepest(1, 2, 4, 6);
  const float y = steepest(2, 1, 4, 5);
  const float z = steepest(4, 1, 2, 3);
  return square_root(x * x + y * y + z * z) * cell.scale * (grid.inverse_voxel_size / cell.size);
}
VOXSHELL_INLINE float find_steepness(const GridView&, const GridCell<float>&) {
  return __builtin_inff();
}

/// How far a place is within its cell from the nearest side, voxels, rounding left out.
template <class F>
VOXSHELL_INLINE F find_room(const GridCell<F>& cell) {
  constexpr float kSafety = 0.001f;  // voxels
  const auto along = [](F t) { return absolute(t - 0.5f); };
  return cell.size * (0.5f - maximum(maximum(along(cell.t.x), along(cell.t.y)), along(cell.t.z))) -
         kSafety;
}

template <class F>
struct GridValue {
  Integer<F> entry;
  F distance;          ///< at the nearest point of the grid
  F cell_size;         ///< voxels; 1 on planes
  Triple<F> gradient;  ///< there; only where asked for
  F steepness;         ///< how fast values change that are not farther away than the room
  F room;              ///< voxels; less than 0 where nothing is known of it
};

enum class Wanted { kDistance, kDistanceAndGradient };

VOXSHELL_INLINE float lane_of(float value, int) { return value; }
VOXSHELL_INLINE float lane_of(F8 value, int lane) { return value[lane]; }

/// The entries of a table for the bricks that places fall in. Where all fall in one brick, eight
/// loads take longer than to ask whether they do.
VOXSHELL_INLINE int32_t gather_of_brick(const uint32_t* table, int32_t brick, bool) {
  return gather(table, brick);
}
VOXSHELL_INLINE I8 gather_of_brick(const uint32_t* table, I8 brick, bool is_one) {
  return is_one ? I8{} + static_cast<int32_t>(table[brick[0]]) : gather(table, brick);
}

/// 0, or 1 + the index of the exact cells, of bricks that have such.
template <class F>
VOXSHELL_INLINE Integer<F> find_exact_bricks(const ExactGridView& grid, const GridPlace<F>& place) {
  return gather_of_brick(grid.exact_bricks, place.brick, is_uniform(place.brick));
}

/// The triangles of a lane's cell; none where it is not exact.
template <class F>
VOXSHELL_INLINE uint32_t find_exact_list(const ExactGridView& grid, const GridPlace<F>& place,
                                         int32_t brick, int lane) {
  if (brick == 0) return 0;
  const auto find_cell = [&](F within) {
    const int32_t cell = to_int(lane_of(within, lane));
    return static_cast<uint32_t>(cell < kBrickCells ? cell : kBrickCells - 1);
  };
  const uint32_t cell =
      find_cell(place.within.x) +
      kBrickCells * (find_cell(place.within.y) + kBrickCells * find_cell(place.within.z));
  const uint32_t* masks =
      grid.exact_masks + static_cast<uint64_t>(brick - 1) * (2 * kMaskWords) + cell / 32;
  const uint32_t bit = 1u << cell % 32;
  if ((*masks & bit) == 0) return 0;
  const uint32_t index =
      masks[kMaskWords] + static_cast<uint32_t>(__builtin_popcount(*masks & (bit - 1)));
  return grid.exact_lists[index];
}

VOXSHELL_INLINE ListedTriangles triangles_of(const ExactGridView& grid, uint32_t list) {
  return {grid.listed + (list >> kListCountBits), list & kMostInList, grid.triangles,
          grid.feature_normals};
}

/// The list of the cell that a place falls in; 0 where that is not exact.
VOXSHELL_INLINE int32_t find_exact_lists(const ExactGridView& grid, const GridPlace<float>& place,
                                         int32_t brick) {
  return static_cast<int32_t>(find_exact_list(grid, place, brick, 0));
}

/// The value of the triangles that are listed for a place.
VOXSHELL_INLINE ExactValue<float> evaluate_lists(const ExactGridView& grid, const Triple<float>& p,
                                                 int32_t list) {
  return evaluate_triangles(triangles_of(grid, static_cast<uint32_t>(list)), p.x, p.y, p.z);
}

/// The lists of the cells that eight places fall in; 0 where those are not exact.
VOXSHELL_INLINE I8 find_exact_lists(const ExactGridView& grid, const GridPlace<F8>& place,
                                    I8 bricks) {
  unsigned lanes = bits(bricks != 0);
  I8 lists{};
  if (lanes == 255u && is_uniform(bricks)) {
    // Of eight places, those in a row often are in one cell.
    const auto cell_along = [](F8 within) {
      return minimum(to_int(within), I8{} + (kBrickCells - 1));
    };
    const I8 cells =
        cell_along(place.within.x) +
        kBrickCells * (cell_along(place.within.y) + kBrickCells * cell_along(place.within.z));
    if (is_uniform(cells)) {
      return lists + static_cast<int32_t>(find_exact_list(grid, place, bricks[0], 0));
    }
  }
  for (; lanes != 0; lanes &= lanes - 1) {
    const int lane = __builtin_ctz(lanes);
    set_lane(lists, lane, static_cast<int32_t>(find_exact_list(grid, place, bricks[lane], lane)));
  }
  return lists;
}

/// The values of the triangles that are listed for eight places; of any sort where none are.
inline ExactValue<F8> evaluate_lists(const ExactGridView& grid, const Triple<F8>& p, I8 lists) {
  const unsigned listed = bits(lists != 0);
  const int32_t some = lists[__builtin_ctz(listed)];
  lists = select(lists != 0, lists, I8{} + some);
  const I8 counts = lists & static_cast<int32_t>(kMostInList);
  const bool is_one = is_uniform(lists);
  const bool are_short = !any(counts > kLanes);
  if (is_one && are_short) {
    return evaluate_triangles_at(triangles_of(grid, static_cast<uint32_t>(some)), p);
  }
  if (are_short) {
    const I8 first = shift_down(lists, kListCountBits);
    uint32_t longest = 1;
    while (any(counts > static_cast<int32_t>(longest))) ++longest;
    return evaluate_triangles_at(
        EightLists{first, first + counts - 1, grid.listed, grid.triangles, grid.feature_normals},
        longest, p);
  }
  ExactValue<F8> value{};
  for (unsigned lanes = listed; lanes != 0; lanes &= lanes - 1) {
    const int lane = __builtin_ctz(lanes);
    const ListedTriangles triangles = triangles_of(grid, static_cast<uint32_t>(lists[lane]));
    const ExactValue<float> exact = evaluate_triangles(triangles, p.x[lane], p.y[lane], p.z[lane]);
    set_lane(value.distance, lane, exact.distance);
    set_lane(value.gradient, lane, exact.gradient);
  }
  return value;
}

/// The values of samples and planes at the nearest point of the grid.
template <Wanted kWanted, class F>
VOXSHELL_INLINE GridValue<F> evaluate_samples(const GridView& grid, const Triple<F>& p,
                                              const GridPlace<F>& place) {
  constexpr unsigned kAllLanes = sizeof(F) == sizeof(float) ? 1u : 255u;
  GridValue<F> value;
  const bool is_one_brick = is_uniform(place.brick);
  value.entry = gather_of_brick(grid.entries, place.brick, is_one_brick);
  const unsigned planes = find_planes(value.entry);
  value.cell_size = splat<F>(1.0f);
  value.steepness = splat<F>(1.0f);
  value.room = splat<F>(-1.0f);
  if (planes != kAllLanes) {
    const GridCell<F> cell = load_cell<F>(grid, place, value.entry, is_one_brick);
    value.distance = interpolate(cell);
    value.cell_size = cell.size;
    if (cell.is_one) {
      value.steepness = find_steepness(grid, cell);
      value.room = find_room(cell);
    }
    if constexpr (kWanted == Wanted::kDistanceAndGradient) {
      value.gradient = differentiate(cell, grid.inverse_voxel_size);
    }
  }
  if (planes == 0) return value;
  const Triple<F> outside = measure_outside(grid, place);
  const Triple<F> nearest{p.x - outside.x, p.y - outside.y, p.z - outside.z};
  if (is_uniform(value.entry)) {
    const float* plane = grid.planes + 4 * as_payload(first_lane(value.entry));
    value.distance = plane[0] * nearest.x + plane[1] * nearest.y + plane[2] * nearest.z - plane[3];
    if constexpr (kWanted == Wanted::kDistanceAndGradient) {
      value.gradient = {splat<F>(plane[0]), splat<F>(plane[1]), splat<F>(plane[2])};
    }
    return value;
  }
  const auto is_plane = (value.entry & kPlaneBit) != 0;
  const Integer<F> index = select(is_plane, as_payload(value.entry) * 4, Integer<F>{});
  const Triple<F> normal{gather(grid.planes, index), gather(grid.planes, index + 1),
                         gather(grid.planes, index + 2)};
  const F distance = dot(normal, nearest) - gather(grid.planes, index + 3);
  const bool all_planes = planes == kAllLanes;
  value.distance = all_planes ? distance : select(is_plane, distance, value.distance);
  if constexpr (kWanted == Wanted::kDistanceAndGradient) {
    value.gradient = all_planes ? normal : select<F>(is_plane, normal, value.gradient);
  }
  return value;
}

/// How far a point is within its cell of one voxel from the nearest side, voxels, rounding left
/// out.
template <class F>
VOXSHELL_INLINE F find_room_in_cell(const GridPlace<F>& place) {
  constexpr float kSafety = 0.001f;  // voxels
  const auto along = [](F within) { return absolute(within - to_float(to_int(within)) - 0.5f); };
  const Triple<F>& w = place.within;
  return 0.5f - kSafety - maximum(maximum(along(w.x), along(w.y)), along(w.z));
}

/// The field at the nearest point of the grid.
template <Wanted kWanted, class G, class F>
VOXSHELL_INLINE GridValue<F> evaluate_in_grid(const G& grid, const Triple<F>& p,
                                              const GridPlace<F>& place) {
  if constexpr (kHasExactCells<G>) {
    const Integer<F> bricks = find_exact_bricks(grid, place);
    const Integer<F> lists = find_exact_lists(grid, place, bricks);
    const auto is_exact = lists != 0;
    GridValue<F> value;
    if (all(is_exact)) {
      // Nothing is wanted of samples but how large their cells are.
      value.entry = gather_of_brick(grid.entries, place.brick, is_uniform(place.brick));
      value.cell_size = select((value.entry & kPlaneBit) != 0, splat<F>(1.0f),
                               look_up(kCellTables.size, value.entry));
      value.steepness = splat<F>(1.0f);
      value.room = splat<F>(-1.0f);
    } else {
      value = evaluate_samples<kWanted>(grid, p, place);
    }
    const auto is_mixed = bricks != 0;
    if (!any(is_mixed)) return value;
    const F room = find_room_in_cell(place);
    value.room = select(is_mixed, minimum(value.room, room), value.room);
    if (!any(is_exact)) return value;
    const ExactValue<F> exact = evaluate_lists(grid, p, lists);
    value.distance = select(is_exact, exact.distance, value.distance);
    // The distance of triangles falls no faster than one comes nearer.
    value.steepness = select(is_exact, splat<F>(1.0f), value.steepness);
    value.room = select(is_exact, room, value.room);
    if constexpr (kWanted == Wanted::kDistanceAndGradient) {
      value.gradient = select<F>(is_exact, exact.gradient, value.gradient);
    }
    return value;
  } else {
    return evaluate_samples<kWanted>(grid, p, place);
  }
}

template <class F>
VOXSHELL_INLINE MaskOf<F> is_beyond(const Triple<F>& outside) {
  return as_float(as_int(outside.x) | as_int(outside.y) | as_int(outside.z)) != 0.0f;
}

/// From outside the grid the surface is where its nearest point, q, sees it: at q minus the
/// distance there along the gradient. It cannot be nearer than sqrt(|p - q|^2 + distance(q)^2): q
/// is the projection of p on a convex body that holds the surface.
template <class F>
VOXSHELL_INLINE F bound_outside(const Triple<F>& outside, F distance) {
  return square_root(dot(outside, outside) + distance * distance);
}

template <class F>
VOXSHELL_INLINE Triple<F> from_surface(const Triple<F>& outside, const GridValue<F>& value) {
  const Triple<F> direction = normalized(value.gradient);
  return {outside.x + value.distance * direction.x, outside.y + value.distance * direction.y,
          outside.z + value.distance * direction.z};
}

/// Exact below `limit`; where it is not below, neither is what is told.
template <class G, class F>
  requires kIsGrid<G>
VOXSHELL_INLINE F evaluate_distance(const G& grid, const Triple<F>& p,
                                    float limit = __builtin_inff()) {
  const auto place = locate(grid, p);
  const auto value = evaluate_in_grid<Wanted::kDistance>(grid, p, place);
  const auto beyond = is_beyond(place.outside);
  if (!any(beyond)) return value.distance;
  const Triple<F> outside = measure_outside(grid, place);
  const F bound = bound_outside(outside, value.distance);
  const MaskOf<F> is_wanted = beyond & (bound < limit);
  if (!any(is_wanted)) return select(beyond, bound, value.distance);
  const auto seen = evaluate_in_grid<Wanted::kDistanceAndGradient>(grid, p, place);
  const F distance = maximum(length(from_surface(outside, seen)), bound);
  return select(beyond, distance, value.distance);
}

/// Outside the grid unit length, inside as long as the interpolant is steep.
template <class G, class F>
  requires kIsGrid<G>
VOXSHELL_INLINE Triple<F> evaluate_gradient(const G& grid, const Triple<F>& p) {
  const auto place = locate(grid, p);
  const auto value = evaluate_in_grid<Wanted::kDistanceAndGradient>(grid, p, place);
  const auto beyond = is_beyond(place.outside);
  if (!any(beyond)) return value.gradient;
  const Triple<F> outside = measure_outside(grid, place);
  return select<F>(beyond, normalized(from_surface(outside, value)), value.gradient);
}

/// The largest cells that hold a value from zero up to `limit`, voxels.
VOXSHELL_INLINE float find_coarsest(const GridView& grid, float limit) {
  float size = 1.0f;
  for (int i = 0; i < kCoarseSizes; ++i) {
    if (limit >= grid.coarse_floors[i]) size = static_cast<float>(2 << i);
  }
  return size;
}

/// Bounds over a ball, meters: lower ones, but for the last.
template <class F>
struct GridBound {
  F of_distance;  ///< of the true distance
  F if_fine;      ///< of the value in planes and cells of one voxel
  F up_to_size;   ///< of the value in cells up to the size that was asked for
  F if_coarse;    ///< of the value in cells up to a whole brick
  F from_above;   ///< an upper bound of the value, where the ball is within the grid
};

/// From the value at the ball's center; `coarsest` as find_coarsest() says.
///
/// A value is a mean of the distances at nodes that are spread about its point. Between two points
/// apart by r, nodes can be paired so that the mean of their squared distances is at most r^2 plus
/// the spread of one (cells of one voxel) or of both (others); so the values differ by at most the
/// square root of that (docs/decisions/0014).
template <class F>
VOXSHELL_INLINE GridBound<F> bound_ball(const GridView& grid, const GridPlace<F>& place,
                                        const GridValue<F>& value, F radius, float coarsest) {
  constexpr float kCoarse = kBrickCells;
  const F size = value.cell_size;
  const F squared = radius * radius + grid.gap + grid.spread * (size * size);
  // How far values may fall is summed up while the samples are waited for.
  const F fall = grid.node_error * size + square_root(squared);
  const F fine_fall =
      fall + select(size > 1.0f, splat<F>(grid.fine_error), splat<F>(grid.node_error));
  // Cells of one voxel on both sides are spread alike.
  const float spread = coarsest > 1.0f ? coarsest * coarsest * grid.spread : 0.0f;
  const F fall_to_size =
      maximum(fine_fall, grid.node_error * (size + coarsest) + square_root(squared + spread));
  const F coarse_fall =
      grid.node_error * (size + kCoarse) + square_root(squared + kCoarse * kCoarse * grid.spread);
  GridBound<F> bound{value.distance - fall, value.distance - fine_fall,
                     value.distance - fall_to_size, value.distance - coarse_fall,
                     value.distance + coarse_fall};
  const auto beyond = is_beyond(place.outside);
  if (any(beyond)) {
    // Nor is the surface nearer than the grid.
    const Triple<F> outside = measure_outside(grid, place);
    const F seen = bound_outside(outside, value.distance) - grid.fine_error * size;
    const F d = maximum(seen, length(outside)) - radius - square_root(splat<F>(grid.gap));
    bound.of_distance = select(beyond, d, bound.of_distance);
    bound.if_fine = select(beyond, d - grid.fine_error, bound.if_fine);
    bound.up_to_size = select(beyond, d - coarsest * grid.fine_error, bound.up_to_size);
    bound.if_coarse = select(beyond, d - kCoarse * grid.fine_error, bound.if_coarse);
  }
  return bound;
}

/// Whether the bound up to the coarsest size decides alone which balls hold a value below `limit`:
/// larger cells hold values beyond it, or lie so deep that the bound of the distance tells.
VOXSHELL_INLINE bool is_decided_by_size(const GridView& grid, float limit) {
  return -grid.coarse_floors[0] < limit;
}

/// Of those values over the ball that the coarsest size was found for.
template <class F>
VOXSHELL_INLINE F combine(const GridView& grid, const GridBound<F>& bound) {
  // Large cells can be met only where the true distance allows it, with values beyond the floor.
  const F d = bound.of_distance;
  const F floor = splat<F>(grid.coarse_floors[0]);
  const F above = maximum(bound.up_to_size, minimum(bound.if_fine, floor));
  const F far = select(d > 0.0f, above, bound.if_coarse);
  return select(absolute(d) <= floor, bound.if_fine, far);
}

template <class F>
VOXSHELL_INLINE MaskOf<F> is_in_grid(const GridView& grid, const Triple<F>& p, F radius) {
  const auto room = [&](int axis, F coordinate) {
    const F along = coordinate - grid.origin[axis];
    return minimum(along, grid.cells[axis] * grid.voxel_size - along);
  };
  return minimum(minimum(room(0, p.x), room(1, p.y)), room(2, p.z)) > radius;
}

/// How far a point is within its brick from the nearest side, voxels, rounding left out.
template <class F>
VOXSHELL_INLINE F find_room(const GridPlace<F>& place) {
  constexpr float kHalf = 0.5f * kBrickCells;
  constexpr float kSafety = 0.01f;  // voxels
  const Triple<F>& w = place.within;
  return kHalf - kSafety -
         maximum(maximum(absolute(w.x - kHalf), absolute(w.y - kHalf)), absolute(w.z - kHalf));
}

/// Of balls within which the field is continuous: those in one brick, or in one cell of a brick
/// that has exact cells. From the value at the center: along each axis it is no steeper than two
/// nodes next to each other allow, nor is an exact one. For others, infinity.
template <class G, class F>
VOXSHELL_INLINE F bound_fall_in_brick(const G& grid, const GridPlace<F>& place,
                                      const GridValue<F>& value, F radius) {
  F room = find_room(place);
  if constexpr (kHasExactCells<G>) {
    room = select(find_exact_bricks(grid, place) != 0, find_room_in_cell(place), room);
  }
  const auto is_within =
      (radius * grid.inverse_voxel_size <= room) & (is_beyond(place.outside) == 0);
  constexpr float kDiagonal = 1.7321f;  // of a cube
  constexpr float kRounding = 1e-3f;    // of a value, in cells
  const F edge = value.cell_size * grid.voxel_size;
  const F rise = square_root(edge * edge + grid.gap) + 2.0f * grid.node_error * value.cell_size;
  const F fall = kDiagonal * radius * (rise / edge) + kRounding * edge;
  return select(is_within, fall, splat<F>(__builtin_inff()));
}

/// Of balls within one cell whose values are known to be no steeper. For others, infinity.
template <class F>
VOXSHELL_INLINE F bound_fall_in_cell(const GridView& grid, const GridPlace<F>& place,
                                     const GridValue<F>& value, F radius) {
  // float32 loses some at coordinates of the grid's size.
  constexpr float kOfSize = 1e-6f;
  const float size = (grid.cells[0] + grid.cells[1] + grid.cells[2]) * grid.voxel_size;
  const auto is_within =
      (radius * grid.inverse_voxel_size <= value.room) & (is_beyond(place.outside) == 0);
  const F fall = (1.0001f * value.steepness) * radius + kOfSize * size;
  return select(is_within, fall, splat<F>(__builtin_inff()));
}

/// Of the value over a ball, from that at its center; of values up to a limit alone where
/// `coarsest` is what find_coarsest() says of it.
template <class G, class F>
VOXSHELL_INLINE F find_lower_bound(const G& grid, const GridPlace<F>& place,
                                   const GridValue<F>& value, F radius,
                                   float coarsest = kBrickCells) {
  return maximum(combine(grid, bound_ball(grid, place, value, radius, coarsest)),
                 value.distance - bound_fall_in_brick(grid, place, value, radius));
}

/// The same, as near to the value as is known. A walk by such bounds would end elsewhere.
template <class G, class F>
VOXSHELL_INLINE F find_tight_bound(const G& grid, const GridPlace<F>& place,
                                   const GridValue<F>& value, F radius, float coarsest) {
  return maximum(find_lower_bound(grid, place, value, radius, coarsest),
                 value.distance - bound_fall_in_cell(grid, place, value, radius));
}

/// The distances of places, and tight bounds of those in balls about them.
template <class F>
struct BoundedDistance {
  F distance;
  F bound;
};
template <class G, class F>
  requires kIsGrid<G>
VOXSHELL_INLINE BoundedDistance<F> evaluate_with_bound(const G& grid, const Triple<F>& p, F radius,
                                                       float coarsest) {
  const auto place = locate(grid, p);
  const auto value = evaluate_in_grid<Wanted::kDistance>(grid, p, place);
  const F bound = find_tight_bound(grid, place, value, radius, coarsest);
  if (!any(is_beyond(place.outside))) return {value.distance, bound};
  return {evaluate_distance(grid, p), bound};
}

template <class G, class F>
  requires kIsGrid<G>
VOXSHELL_INLINE F evaluate_lower_bound(const G& grid, const Triple<F>& p, F radius,
                                       float coarsest = kBrickCells) {
  const auto place = locate(grid, p);
  const auto value = evaluate_in_grid<Wanted::kDistance>(grid, p, place);
  return find_lower_bound(grid, place, value, radius, coarsest);
}

template <class G, class F>
  requires kIsGrid<G>
VOXSHELL_INLINE F evaluate_tight_bound(const G& grid, const Triple<F>& p, F radius,
                                       float coarsest) {
  const auto place = locate(grid, p);
  const auto value = evaluate_in_grid<Wanted::kDistance>(grid, p, place);
  return find_tight_bound(grid, place, value, radius, coarsest);
}

}  // namespace voxshell::simd::VOXSHELL_ISA
