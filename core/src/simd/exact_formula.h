#pragma once

#include "simd/exact_view.h"
#include "simd/wide.h"

namespace voxshell::simd::VOXSHELL_ISA {

/// How far a point is from one triangle, or from eight, and where that triangle is nearest.
template <class F>
struct NearestOnTriangle {
  F squared_distance;
  Triple<F> offset;    ///< from the nearest place to the point
  Integer<F> feature;  ///< see kFeatureNormalFloats
};

template <class F>
VOXSHELL_INLINE Triple<F> subtract(const Triple<F>& a, const Triple<F>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

template <class F>
VOXSHELL_INLINE Triple<F> cross_product(const Triple<F>& a, const Triple<F>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// `p`, `ab`, `ac` from the corner a. A point is above the face where it is on the inner side of
/// all three edges; elsewhere the nearest edge has the nearest place.
template <class F>
VOXSHELL_INLINE NearestOnTriangle<F> find_on_triangle(const Triple<F>& p, const Triple<F>& ab,
                                                      const Triple<F>& ac,
                                                      const Triple<F>& normal) {
  const F zero = splat<F>(0.0f);
  const F one = splat<F>(1.0f);
  const Triple<F> bc = subtract(ac, ab);
  const Triple<F> bp = subtract(p, ab);
  const auto is_inside = [&](const Triple<F>& edge, const Triple<F>& from) {
    return dot(cross_product(normal, edge), from) >= zero;
  };
  const Triple<F> ca{zero - ac.x, zero - ac.y, zero - ac.z};
  const auto is_above = both(both(is_inside(ab, p), is_inside(bc, bp)), is_inside(ca, p));
  const F height = dot(normal, p);

  NearestOnTriangle<F> nearest;
  nearest.squared_distance = height * height;
  nearest.offset = {height * normal.x, height * normal.y, height * normal.z};
  nearest.feature = Integer<F>{};
  if (all(is_above)) return nearest;
  const NearestOnTriangle<F> on_face = nearest;
  const auto along = [&](const Triple<F>& edge, const Triple<F>& from, F& t) {
    t = minimum(maximum(dot(edge, from) / dot(edge, edge), zero), one);
    return Triple<F>{from.x - t * edge.x, from.y - t * edge.y, from.z - t * edge.z};
  };
  const auto code = [&](F t, int edge, int start, int end) {
    const Integer<F> none{};
    return select(t <= zero, none + start, select(t >= one, none + end, none + edge));
  };
  const auto take = [&](const Triple<F>& offset, Integer<F> feature, bool is_first) {
    const F squared = dot(offset, offset);
    if (is_first) {
      nearest = {squared, offset, feature};
      return;
    }
    const auto is_nearer = squared < nearest.squared_distance;
    nearest.squared_distance = select(is_nearer, squared, nearest.squared_distance);
    nearest.offset = select<F>(is_nearer, offset, nearest.offset);
    nearest.feature = select(is_nearer, feature, nearest.feature);
  };
  F t;
  const Triple<F> from_ab = along(ab, p, t);
  take(from_ab, code(t, 1, 4, 5), true);
  const Triple<F> from_bc = along(bc, bp, t);
  take(from_bc, code(t, 2, 5, 6), false);
  const Triple<F> from_ac = along(ac, p, t);
  take(from_ac, code(t, 3, 4, 6), false);

  nearest.squared_distance = select(is_above, on_face.squared_distance, nearest.squared_distance);
  nearest.offset = select<F>(is_above, on_face.offset, nearest.offset);
  nearest.feature = select(is_above, on_face.feature, nearest.feature);
  return nearest;
}

/// Signed distance and gradient, of one place or eight.
template <class F>
struct ExactValue {
  F distance;
  Triple<F> gradient;  ///< unit length
};

/// Triangles as they lie in memory, see simd/exact_view.h.
struct ListedTriangles {
  const uint32_t* listed;  ///< the list's first
  uint32_t count;          ///< 1 at least
  const float* triangles;
  const float* feature_normals;

  uint32_t index(uint32_t i) const { return listed[i < count ? i : count - 1]; }
  const float* record(uint32_t i) const {
    return triangles + static_cast<uint64_t>(index(i)) * kTriangleFloats;
  }
};

/// Eight triangles, one a lane.
struct EightTriangles {
  Triple<F8> a, ab, ac, normal;
};

VOXSHELL_INLINE EightTriangles load_triangles(const float* triangles, I8 index) {
  F8 rows[kLanes];
  F8 others[kLanes];
  for (int i = 0; i < kLanes; ++i) {
    const float* record =
        triangles + static_cast<uint64_t>(static_cast<uint32_t>(index[i])) * kTriangleFloats;
    rows[i] = load<F8>(record);
    others[i] = load<F8>(record + kLanes);
  }
  transpose(rows);
  transpose(others);
  return {{rows[0], rows[1], rows[2]},
          {rows[3], rows[4], rows[5]},
          {rows[6], rows[7], others[0]},
          {others[1], others[2], others[3]}};
}

/// One triangle in all lanes.
VOXSHELL_INLINE EightTriangles repeat_triangle(const float* record) {
  const auto pick = [&](int k) {
    return Triple<F8>{splat<F8>(record[k]), splat<F8>(record[k + 1]), splat<F8>(record[k + 2])};
  };
  return {pick(0), pick(3), pick(6), pick(kRecordNormal)};
}

VOXSHELL_INLINE NearestOnTriangle<F8> find_on_triangles(const EightTriangles& triangles,
                                                        const Triple<F8>& places) {
  return find_on_triangle(subtract(places, triangles.a), triangles.ab, triangles.ac,
                          triangles.normal);
}

/// Squared distances of a place to eight of the listed triangles from `first` on; beyond the list's
/// end the last is repeated.
VOXSHELL_INLINE F8 measure_eight_triangles(const ListedTriangles& list, uint32_t first,
                                           const Triple<F8>& place) {
  I8 index{};
  for (int i = 0; i < kLanes; ++i) {
    set_lane(index, i, static_cast<int32_t>(list.index(first + static_cast<uint32_t>(i))));
  }
  return find_on_triangles(load_triangles(list.triangles, index), place).squared_distance;
}

/// The signed distance where `nearest` is of a triangle with that normal and the feature normals
/// that begin at `feature_normals[first]`.
template <class F>
VOXSHELL_INLINE ExactValue<F> sign_distance(const Triple<F>& place,
                                            const NearestOnTriangle<F>& nearest,
                                            const Triple<F>& normal, const float* feature_normals,
                                            Integer<F> first) {
  const Triple<F>& offset = nearest.offset;
  const auto is_on_face = nearest.feature == 0;
  const F height = dot(normal, offset);
  if (all(is_on_face)) return {height, normal};
  const Integer<F> index = first + 3 * nearest.feature;
  const Triple<F> outward{gather(feature_normals, index), gather(feature_normals, index + 1),
                          gather(feature_normals, index + 2)};
  const F length = square_root(nearest.squared_distance);
  const F one = splat<F>(1.0f);
  const F sign = select(dot(outward, offset) < splat<F>(0.0f), splat<F>(-1.0f), one);
  // So near, rounding would say which way the offset points.
  constexpr float kNear = 1e-6f;
  const F size = absolute(place.x) + absolute(place.y) + absolute(place.z);
  const auto is_near = length <= kNear * size;
  const F scale = sign / length;
  const Triple<F> along{scale * offset.x, scale * offset.y, scale * offset.z};
  const Triple<F> gradient = select<F>(is_near, normalized(outward), along);
  return {select(is_on_face, height, sign * length), select<F>(is_on_face, normal, gradient)};
}

/// The signed distance where the triangle at `found` of the list is the nearest.
inline ExactValue<float> evaluate_triangle(const ListedTriangles& list, uint32_t found, float x,
                                           float y, float z) {
  const float* record = list.record(found);
  const auto pick = [&](int i) { return Triple<float>{record[i], record[i + 1], record[i + 2]}; };
  const Triple<float> place{x, y, z};
  const Triple<float> normal = pick(kRecordNormal);
  const auto nearest = find_on_triangle<float>(subtract(place, pick(0)), pick(3), pick(6), normal);
  return sign_distance<float>(
      place, nearest, normal,
      list.feature_normals + static_cast<uint64_t>(list.index(found)) * kFeatureNormalFloats, 0);
}

/// The signed distance to the nearest of a few triangles.
inline ExactValue<float> evaluate_triangles(const ListedTriangles& list, float x, float y,
                                            float z) {
  if (list.count == 1) return evaluate_triangle(list, 0, x, y, z);
  F8 least = splat<F8>(__builtin_inff());
  I8 least_index{};
  const Triple<F8> place{splat<F8>(x), splat<F8>(y), splat<F8>(z)};
  for (uint32_t first = 0; first < list.count; first += kLanes) {
    const F8 squared = measure_eight_triangles(list, first, place);
    const I8 is_nearer = squared < least;
    least = select(is_nearer, squared, least);
    least_index = select(is_nearer, kLaneIndex + static_cast<int32_t>(first), least_index);
  }
  int lane = 0;
  for (int other = 1; other < kLanes; ++other) {
    if (least[other] < least[lane]) lane = other;
  }
  return evaluate_triangle(list, static_cast<uint32_t>(least_index[lane]), x, y, z);
}

/// The same of eight places: triangle by triangle, of which the first of the nearest counts, as in
/// evaluate_triangles() where there are at most eight. `index_at(i)` tells the i-th of each place,
/// and `triangles_at` loads those.
template <class IndexAt, class TrianglesAt>
VOXSHELL_INLINE ExactValue<F8> evaluate_eight_places(const Triple<F8>& places, uint32_t count,
                                                     const float* feature_normals,
                                                     const IndexAt& index_at,
                                                     const TrianglesAt& triangles_at) {
  I8 index = index_at(0);
  EightTriangles triangles = triangles_at(index);
  NearestOnTriangle<F8> nearest = find_on_triangles(triangles, places);
  Triple<F8> normal = triangles.normal;
  for (uint32_t i = 1; i < count; ++i) {
    const I8 of_this = index_at(i);
    triangles = triangles_at(of_this);
    const auto found = find_on_triangles(triangles, places);
    const I8 is_nearer = found.squared_distance < nearest.squared_distance;
    nearest.squared_distance = select(is_nearer, found.squared_distance, nearest.squared_distance);
    nearest.offset = select<F8>(is_nearer, found.offset, nearest.offset);
    nearest.feature = select(is_nearer, found.feature, nearest.feature);
    normal = select<F8>(is_nearer, triangles.normal, normal);
    index = select(is_nearer, of_this, index);
  }
  return sign_distance<F8>(places, nearest, normal, feature_normals, index * kFeatureNormalFloats);
}

/// Of eight places with one list.
inline ExactValue<F8> evaluate_triangles_at(const ListedTriangles& list, const Triple<F8>& places) {
  return evaluate_eight_places(
      places, list.count, list.feature_normals,
      [&](uint32_t i) { return I8{} + static_cast<int32_t>(list.index(i)); },
      [&](I8 index) {
        return repeat_triangle(list.triangles +
                               static_cast<uint64_t>(static_cast<uint32_t>(index[0])) *
                                   kTriangleFloats);
      });
}

/// The lists of eight places, one each, of which none is empty.
struct EightLists {
  I8 first;  ///< where they begin in `listed`
  I8 last;   ///< where their last triangles are
  const uint32_t* listed;
  const float* triangles;
  const float* feature_normals;
};

/// `count` is that of the longest list.
inline ExactValue<F8> evaluate_triangles_at(const EightLists& lists, uint32_t count,
                                            const Triple<F8>& places) {
  return evaluate_eight_places(
      places, count, lists.feature_normals,
      [&](uint32_t i) {
        return gather(lists.listed, minimum(lists.first + static_cast<int32_t>(i), lists.last));
      },
      [&](I8 index) { return load_triangles(lists.triangles, index); });
}

}  // namespace voxshell::simd::VOXSHELL_ISA
