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
  int least = 0;
  for (int i = 1; i < kLanes; ++i) {
    if (distance[i] < distance[least]) least = i;
  }
  const float limit = distance[least] + tie;
  float weights = 0.0f;
  float sum = 0.0f;
  const auto add = [&](int i) {
    const float weight = limit - distance[i];
    if (!(weight > 0.0f)) return false;
    weights += weight;
    sum += weight * t[i];
    return true;
  };
  for (int i = least; i >= 0 && add(i); --i) {
  }
  for (int i = least + 1; i < kLanes && add(i); ++i) {
  }
  return weights > 0.0f ? sum / weights : t[least];
}

/// From -1 to 1 along the piece. Eight samples over all of it, then twice eight about the best
/// place so far.
template <class V>
VOXSHELL_INLINE float find_place_on_edge(const PosedView<V>& posed, const Triple<float>& middle,
                                         const Triple<float>& half, float tie) {
  constexpr int kRounds = 3;
  constexpr float kNarrower = 2.0f / 7.0f;
  float centre = 0.0f;
  float width = 1.0f;
  for (int round = 0; round < kRounds; ++round) {
    const F8 t = minimum(maximum(centre + width * kEdgeSamples, splat<F8>(-1.0f)), splat<F8>(1.0f));
    centre = balance(t, posed_distance(posed, place_on_edge(middle, half, t)), tie);
    width *= kNarrower;
  }
  return centre;
}

}  // namespace voxshell::simd::VOXSHELL_ISA
