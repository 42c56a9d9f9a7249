#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "pair_step.h"
#include "voxshell/manifold.h"

namespace voxshell::bullet {

/// Where one of two models may arrive within a step in which nothing rebounds, as the other one
/// sees it, and how far from there the solver may take its places. Decision 51.
class Arrivals {
 public:
  /// @param is_of_field  Of the field's side, as the shell's sees it.
  /// @param reach        Places as near as this count as touching, meters.
  Arrivals(const PairStep& step, bool is_of_field, double reach);

  std::span<const Arrival> all() const { return std::span(all_).first(count_); }

 private:
  std::array<Arrival, kMostArrivals> all_;
  std::size_t count_ = 0;
};

}  // namespace voxshell::bullet
