#pragma once

#include <cmath>
#include <optional>

#include "contact_constants.h"

namespace voxshell::bullet {

/// Where a function of growing value is zero, from a first guess on: by secants, and by halves
/// where these leave what holds the zero or come no nearer, as where the function jumps. None where
/// it does not grow by `least` within a number of steps, each twice as long as the last, or is not
/// found.
template <class F>
std::optional<double> find_zero(const F& value_at, double first_step, double least, double within) {
  double at = 0.0;
  std::optional<double> value = value_at(at);
  if (!value) return std::nullopt;
  std::optional<double> below;
  std::optional<double> above;
  double slope = 0.0;
  bool is_slow = false;
  for (int i = 0; i < kMostZeroSteps; ++i) {
    if (std::abs(*value) <= within) return at;
    (*value < 0.0 ? below : above) = at;
    double step = slope > 0.0 ? -*value / slope : std::copysign(first_step, -*value);
    double next = at + step;
    if (below && above && (is_slow || !(next > *below && next < *above))) {
      next = 0.5 * (*below + *above);
    }
    const std::optional<double> value_there = value_at(next);
    if (!value_there || next == at) return std::nullopt;
    const double steepness = (*value_there - *value) / (next - at);
    // Facets that are seen from afar have the same normal over some way.
    if (steepness >= least) {
      slope = steepness;
    } else if (!(slope > 0.0)) {
      if (i >= kMostFlatSteps) return std::nullopt;
      first_step *= 2.0;
    }
    is_slow = std::abs(*value_there) > 0.5 * std::abs(*value);
    at = next;
    value = value_there;
  }
  return std::nullopt;
}

}  // namespace voxshell::bullet
