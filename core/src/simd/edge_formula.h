#pragma once

// Where along a straight piece of an edge a field is least: a function of the pose alone.

#include "simd/edge_view.h"
#include "simd/posed_view.h"

namespace voxshell::simd::VOXSHELL_ISA {

inline constexpr F8 kEdgeSamples = {-1.0f,       -5.0f / 7.0f, -3.0f / 7.0f, -1.0f / 7.0f,
                                    1.0f / 7.0f, 3.0f / 7.0f,  5.0f / 7.0f,  1.0f};

template <class F>
VOXSHELL_INLINE Triple<F> place_on_edge(const Triple<float>& middle, const Triple<float>& half,
                                        F t) {
  return {middle.x + t * half.x, middle.y + t * half.y, middle.z + t * half.z};
}

/// The mean of samples next to the least one that are less than `tie` above it, by how far they are
/// below that. Without jumps as the distances change, unless two places far apart are equally deep.
VOXSHELL_INLINE float balance(F8 t, F8 distance, float tie) {
  const float least = find_least(distance);
  const unsigned at_least = bits(distance == least);
  if (at_least == 0) return t[0];  // not a number
  const int first = __builtin_ctz(at_least);
  const float limit = least + tie;
  const unsigned below = bits(distance < limit) | (1u << first);
  const int end = first + __builtin_ctz(~(below >> first));
  const int begin = first + 1 - __builtin_clz(~(below << (31 - first)));
  const I8 is_next = (kLaneIndex >= begin) & (kLaneIndex < end);
  const F8 weights = select(is_next, limit - distance, F8{});
  const float sum = add_up(weights);
  return sum > 0.0f ? add_up(weights * t) / sum : t[first];
}

/// A search for the best place on a piece: eight samples over all of it, then twice eight about the
/// best place so far. It ends early where all eight are equally deep: places among them are, too.
/// From -1 to 1 along the piece.
struct EdgeSearch {
  static constexpr int kRounds = 3;
  static constexpr float kNarrower = 2.0f / 7.0f;

  Triple<float> middle;
  Triple<float> half;
  float place = 0.0f;
  float width = 1.0f;
  bool is_done = false;

  /// `distance_at` tells how deep eight places are.
  template <class DistanceAt>
  VOXSHELL_INLINE void go_on(float tie, const DistanceAt& distance_at) {
    if (is_done) return;
    const F8 t = minimum(maximum(place + width * kEdgeSamples, splat<F8>(-1.0f)), splat<F8>(1.0f));
    take(t, distance_at(place_on_edge(middle, half, t)), tie);
  }
  /// A round of which the places, and how deep they are, are known.
  VOXSHELL_INLINE void take(F8 t, F8 distance, float tie) {
    place = balance(t, distance, tie);
    width *= kNarrower;
    is_done = all(distance < find_least(distance) + tie);
  }
};

template <class V>
VOXSHELL_INLINE float find_place_on_edge(const PosedView<V>& posed, const Triple<float>& middle,
                                         const Triple<float>& half, float tie) {
  EdgeSearch search{middle, half};
  const auto distance_at = [&](const Triple<F8>& p) { return posed_distance(posed, p); };
  for (int round = 0; round < EdgeSearch::kRounds; ++round) search.go_on(tie, distance_at);
  return search.place;
}

}  // namespace voxshell::simd::VOXSHELL_ISA
