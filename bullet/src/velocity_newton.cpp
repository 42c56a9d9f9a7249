#include "velocity_newton.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "solver_constants.h"

namespace voxshell::bullet {
namespace {

constexpr std::size_t kSix = 6;

std::size_t index(int body) { return static_cast<std::size_t>(body); }

bool joins_bodies(const VelocityRow& row) {
  return row.body_a != VelocityRow::kFixed && row.body_b != VelocityRow::kFixed;
}

std::size_t row_count(const VelocityRow& first) {
  return 1 + static_cast<std::size_t>(first.friction_rows);
}

/// Calls `visit(offset, along)` for each body of the row that moves.
template <class Visit>
void for_each_body(const VelocityRow& row, std::span<const std::size_t> offsets,
                   const Visit& visit) {
  if (row.body_a != VelocityRow::kFixed) visit(offsets[index(row.body_a)], row.along_a);
  if (row.body_b != VelocityRow::kFixed) visit(offsets[index(row.body_b)], row.along_b);
}

double velocity_along(const VelocityRow& row, std::span<const std::size_t> offsets,
                      std::span<const double> velocities) {
  double sum = 0.0;
  for_each_body(row, offsets, [&](std::size_t offset, const std::array<double, kSix>& along) {
    for (std::size_t k = 0; k < kSix; ++k) sum += along[k] * velocities[offset + k];
  });
  return sum;
}

void add_impulse(const VelocityRow& row, std::span<const std::size_t> offsets, double impulse,
                 std::span<double> velocities) {
  for_each_body(row, offsets, [&](std::size_t offset, const std::array<double, kSix>& along) {
    for (std::size_t k = 0; k < kSix; ++k) velocities[offset + k] += along[k] * impulse;
  });
}

double squared_length(const std::vector<double>& numbers) {
  return std::inner_product(numbers.begin(), numbers.end(), numbers.begin(), 0.0);
}

/// Whether a contact's impulse is one that Coulomb's friction allows.
bool is_in_cone(double normal, double aside, double friction) {
  return normal >= 0.0 && aside <= friction * normal;
}

/// The root of by how much less than friction a contact's normal impulse answers to a velocity.
double scale_of(const VelocityRow& normal, double stiffness) {
  return std::sqrt(1.0 + stiffness * normal.unit_impulse * normal.softness);
}

/// A row along a combination of two rows of the same bodies.
VelocityRow combine(const VelocityRow& p, double of_p, const VelocityRow& q, double of_q) {
  VelocityRow sum;
  sum.body_a = p.body_a;
  sum.body_b = p.body_b;
  for (std::size_t k = 0; k < kSix; ++k) {
    sum.along_a[k] = of_p * p.along_a[k] + of_q * q.along_a[k];
    sum.along_b[k] = of_p * p.along_b[k] + of_q * q.along_b[k];
  }
  return sum;
}

/// For each body, those that rows join it with.
std::vector<std::vector<int>> find_neighbors(std::size_t body_count,
                                             std::span<const VelocityRow> rows) {
  std::vector<std::vector<int>> neighbors(body_count);
  for (const VelocityRow& row : rows) {
    if (!joins_bodies(row)) continue;
    std::vector<int>& of_a = neighbors[index(row.body_a)];
    if (std::ranges::find(of_a, row.body_b) != of_a.end()) continue;
    of_a.push_back(row.body_b);
    neighbors[index(row.body_b)].push_back(row.body_a);
  }
  return neighbors;
}

}  // namespace

/// Cuthill and McKee's order: neighbors follow each other, those with few neighbors first.
void VelocityNewton::order(std::size_t body_count, std::span<const VelocityRow> rows) {
  constexpr auto kNone = static_cast<std::size_t>(-1);
  std::vector<std::vector<int>> neighbors = find_neighbors(body_count, rows);
  const auto has_fewer = [&](int a, int b) {
    return neighbors[index(a)].size() < neighbors[index(b)].size();
  };
  std::vector<int> starts(body_count);
  std::iota(starts.begin(), starts.end(), 0);
  std::ranges::stable_sort(starts, has_fewer);
  offset_.assign(body_count, kNone);
  std::vector<int> ordered;
  const auto append = [&](int body) {
    if (offset_[index(body)] != kNone) return;
    offset_[index(body)] = kSix * ordered.size();
    ordered.push_back(body);
  };
  std::size_t next = 0;
  for (const int start : starts) {
    append(start);
    for (; next < ordered.size(); ++next) {
      std::vector<int>& others = neighbors[index(ordered[next])];
      std::ranges::stable_sort(others, has_fewer);
      for (const int other : others) append(other);
    }
  }
}

double VelocityNewton::prepare(std::size_t body_count, std::span<const VelocityRow> rows) {
  order(body_count, rows);
  size_ = kSix * body_count;
  last_.resize(size_);
  for (std::size_t i = 0; i < size_; ++i) last_[i] = i - i % kSix + kSix - 1;
  for (const VelocityRow& row : rows) {
    if (!joins_bodies(row)) continue;
    const auto [upper, lower] = std::minmax(offset_[index(row.body_a)], offset_[index(row.body_b)]);
    for (std::size_t k = 0; k < kSix; ++k) {
      last_[upper + k] = std::max(last_[upper + k], lower + kSix - 1);
    }
  }
  double cost = 0.0;
  row_starts_.resize(size_);
  std::size_t end = 0;
  for (std::size_t i = 0; i < size_; ++i) {
    // Elimination fills each row as far as the ones above it reach.
    if (i > 0) last_[i] = std::max(last_[i], last_[i - 1]);
    row_starts_[i] = end - i;
    end += last_[i] - i + 1;
    const auto width = static_cast<double>(last_[i] - i);
    cost += 0.5 * width * width;
  }
  entry_count_ = end;
  return cost;
}

bool VelocityNewton::solve(std::span<VelocityRow> rows, double stiffness, int most_steps) {
  start(rows, stiffness);
  // Not ">", which NaN would end.
  for (int step = 0; !(find_gradient(rows) <= kConvergedGradient * squared_length(velocities_));
       ++step) {
    if (step == most_steps) return false;
    find_direction(rows);
    const double fraction = search_line();
    if (!(fraction > 0.0)) return false;
    for (std::size_t i = 0; i < size_; ++i) velocities_[i] += fraction * direction_[i];
    for (std::size_t i = 0; i < rows.size(); ++i) along_[i] += fraction * along_step_[i];
  }
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].impulse = impulses_[i];
  return true;
}

double VelocityNewton::error(std::span<const VelocityRow> rows) {
  start(rows, 1.0);
  double largest = 0.0;
  for (std::size_t i = 0; i < rows.size();) {
    const std::size_t end = i + row_count(rows[i]);
    const double unit_impulse = rows[i].unit_impulse;
    for (; i < end; ++i) {
      if (!(unit_impulse > 0.0)) continue;
      const double missing = std::abs(impulses_[i] - rows[i].impulse) / unit_impulse;
      // Not std::max(), which would lose NaN.
      if (!(missing <= largest)) largest = missing;
    }
  }
  return largest;
}

/// Starts from the velocities that the rows' impulses give.
void VelocityNewton::start(std::span<const VelocityRow> rows, double stiffness) {
  stiffness_ = stiffness;
  matrix_.resize(entry_count_);
  velocities_.assign(size_, 0.0);
  direction_.resize(size_);
  for (auto* of_rows : {&along_, &unlimited_, &impulses_}) of_rows->resize(rows.size());
  along_step_.assign(rows.size(), 0.0);
  aims_.clear();
  groups_.clear();
  for (std::size_t i = 0; i < rows.size();) {
    const VelocityRow& first = rows[i];
    const Group group{
        i,           row_count(first), stiffness_ * first.unit_impulse, first.lower,
        first.upper, first.friction,   scale_of(first, stiffness_),     first.is_contact};
    for (const std::size_t end = i + group.count; i < end; ++i) {
      aims_.push_back({rows[i].impulse, rows[i].target, 1.0 + group.impulse * rows[i].softness});
    }
    groups_.push_back(group);
  }
  for (const VelocityRow& row : rows) add_impulse(row, offset_, row.impulse, velocities_);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    along_[i] = velocity_along(rows[i], offset_, velocities_);
  }
  project_all(0.0);
}

/// Sets `direction_` to minus the gradient.
///
/// @return Its square.
double VelocityNewton::find_gradient(std::span<const VelocityRow> rows) {
  for (std::size_t i = 0; i < size_; ++i) direction_[i] = -velocities_[i];
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (impulses_[i] != 0.0) add_impulse(rows[i], offset_, impulses_[i], direction_);
  }
  return squared_length(direction_);
}

void VelocityNewton::find_direction(std::span<const VelocityRow> rows) {
  assemble(rows);
  factorize();
  substitute();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    along_step_[i] = velocity_along(rows[i], offset_, direction_);
  }
}

// ---- curvature
// -----------------------------------------------------------------------------------

void VelocityNewton::assemble(std::span<const VelocityRow> rows) {
  for (std::size_t i = 0; i < size_; ++i) {
    double* const entries = &matrix_[row_starts_[i]];
    std::fill(entries + i, entries + last_[i] + 1, 0.0);
    entries[i] = 1.0;
  }
  for (std::size_t i = 0; i < rows.size(); i += row_count(rows[i])) {
    const VelocityRow& row = rows[i];
    if (row.is_contact) {
      add_contact(rows, i);
    } else if (unlimited_[i] > row.lower && unlimited_[i] < row.upper) {
      const double impulse = stiffness_ * row.unit_impulse;
      add_square(row, impulse / (1.0 + impulse * row.softness));
    }
  }
}

/// The derivative of the projection on a contact's cone: all of it inside, none where the contact
/// is open, and along the cone's surface and its rim where it slides.
void VelocityNewton::add_contact(std::span<const VelocityRow> rows, std::size_t normal) {
  const VelocityRow& row = rows[normal];
  const double impulse = stiffness_ * row.unit_impulse;
  const double aside = friction_at(normal, row_count(row));
  const double scale = scale_of(row, stiffness_);
  if (is_in_cone(unlimited_[normal], aside, row.friction)) {
    add_square(row, impulse / (scale * scale));
    for (std::size_t k = 1; k < row_count(row); ++k) add_square(rows[normal + k], impulse);
    return;
  }
  if (!(impulses_[normal] > 0.0)) return;
  const double friction = row.friction / scale;
  const double onto_cone = impulse / (1.0 + friction * friction);
  const double x = unlimited_[normal + 1] / aside;
  if (row.friction_rows == 1) {
    add_square(combine(row, 1.0 / scale, rows[normal + 1], friction * x), onto_cone);
    return;
  }
  const double y = unlimited_[normal + 2] / aside;
  const VelocityRow slide = combine(rows[normal + 1], x, rows[normal + 2], y);
  const VelocityRow across = combine(rows[normal + 1], -y, rows[normal + 2], x);
  add_square(combine(row, 1.0 / scale, slide, friction), onto_cone);
  add_square(across, impulse * row.friction * impulses_[normal] / aside);
}

/// Adds the outer product of the row with itself to the matrix.
void VelocityNewton::add_square(const VelocityRow& row, double factor) {
  const auto add_block = [&](std::size_t offset_p, const std::array<double, kSix>& p,
                             std::size_t offset_q, const std::array<double, kSix>& q) {
    for (std::size_t k = 0; k < kSix; ++k) {
      double* const entries = &matrix_[row_starts_[offset_p + k] + offset_q];
      const double scaled = factor * p[k];
      for (std::size_t l = offset_p == offset_q ? k : 0; l < kSix; ++l) {
        entries[l] += scaled * q[l];
      }
    }
  };
  for_each_body(row, offset_, [&](std::size_t offset_p, const std::array<double, kSix>& p) {
    for_each_body(row, offset_, [&](std::size_t offset_q, const std::array<double, kSix>& q) {
      if (offset_p <= offset_q) add_block(offset_p, p, offset_q, q);
    });
  });
}

/// Cholesky's factor, in place: matrix = transpose(factor) * factor.
void VelocityNewton::factorize() {
  for (std::size_t k = 0; k < size_; ++k) {
    double* const pivot = &matrix_[row_starts_[k]];
    const double root = std::sqrt(pivot[k]);
    for (std::size_t j = k; j <= last_[k]; ++j) pivot[j] /= root;
    for (std::size_t i = k + 1; i <= last_[k]; ++i) {
      const double factor = pivot[i];
      if (factor == 0.0) continue;
      double* const entries = &matrix_[row_starts_[i]];
      for (std::size_t j = i; j <= last_[k]; ++j) entries[j] -= factor * pivot[j];
    }
  }
}

/// Solves for `direction_` by the factor.
void VelocityNewton::substitute() {
  for (std::size_t k = 0; k < size_; ++k) {
    const double* const entries = &matrix_[row_starts_[k]];
    direction_[k] /= entries[k];
    for (std::size_t j = k + 1; j <= last_[k]; ++j) direction_[j] -= entries[j] * direction_[k];
  }
  for (std::size_t k = size_; k-- > 0;) {
    const double* const entries = &matrix_[row_starts_[k]];
    for (std::size_t j = k + 1; j <= last_[k]; ++j) direction_[k] -= entries[j] * direction_[j];
    direction_[k] /= entries[k];
  }
}

// ---- line search
// ---------------------------------------------------------------------------------

/// Finds the fraction of the step at which the function's slope, which rises along it, is near 0,
/// and leaves the impulses of that place. Never beyond the least value by more than that: a step
/// that goes farther may lead uphill.
double VelocityNewton::search_line() {
  constexpr int kMostDoublings = 3;
  constexpr int kMostCuts = 40;
  const double start = slope_at(0.0);
  const auto is_flat = [&](double slope) {
    return std::abs(slope) <= kFlatSlope * std::abs(start);
  };
  double low = 0.0;
  double low_slope = start;
  double high = 1.0;
  project_all(high);
  double high_slope = slope_at(high);
  for (int i = 0; i < kMostDoublings && high_slope < 0.0 && !is_flat(high_slope); ++i) {
    low = high;
    low_slope = high_slope;
    high *= 2.0;
    project_all(high);
    high_slope = slope_at(high);
  }
  if (high_slope <= 0.0 || is_flat(high_slope)) return high;
  find_pressed();
  for (int i = 0; i < kMostCuts; ++i) {
    // Secants alone creep where the slope has kinks.
    const double fraction =
        i % 2 == 0 ? low + (high - low) * low_slope / (low_slope - high_slope) : 0.5 * (low + high);
    const double slope = slope_of_pressed_at(fraction);
    if (is_flat(slope)) return fraction;
    if (slope < 0.0) {
      low = fraction;
      low_slope = slope;
    } else {
      high = fraction;
      high_slope = slope;
    }
  }
  slope_of_pressed_at(low);
  return low;
}

/// Of what the impulses do not change.
double VelocityNewton::slope_of_bodies_at(double fraction) const {
  double slope = 0.0;
  for (std::size_t i = 0; i < size_; ++i) {
    slope += (velocities_[i] + fraction * direction_[i]) * direction_[i];
  }
  return slope;
}

/// Where all impulses are those of that place.
double VelocityNewton::slope_at(double fraction) const {
  double slope = slope_of_bodies_at(fraction);
  for (std::size_t i = 0; i < impulses_.size(); ++i) slope -= impulses_[i] * along_step_[i];
  return slope;
}

/// Leaves the impulses of that place.
double VelocityNewton::slope_of_pressed_at(double fraction) {
  double slope = slope_of_bodies_at(fraction);
  for (const std::uint32_t i : pressed_) {
    const Group& group = groups_[i];
    project(group, fraction);
    for (std::size_t k = group.first; k < group.first + group.count; ++k) {
      slope -= impulses_[k] * along_step_[k];
    }
  }
  return slope;
}

// ---- limits
// --------------------------------------------------------------------------------------

/// The impulses by which all rows answer to the velocities at a fraction of the step. What they
/// were before is kept for find_pressed().
void VelocityNewton::project_all(double fraction) {
  std::swap(impulses_, before_);
  impulses_.resize(before_.size());
  for (const Group& group : groups_) project(group, fraction);
}

/// Finds the groups that may have impulses between the last two places that all were projected at.
/// A contact without an impulse at either end has none between them: its normal velocity changes
/// linearly along the way, and how much friction exceeds it by is convex.
void VelocityNewton::find_pressed() {
  pressed_.clear();
  for (std::uint32_t i = 0; i < groups_.size(); ++i) {
    const std::size_t first = groups_[i].first;
    const bool is_open = impulses_[first] == 0.0 && before_[first] == 0.0;
    if (!groups_[i].is_contact || !is_open) pressed_.push_back(i);
  }
}

void VelocityNewton::project(const Group& group, double fraction) {
  for (std::size_t k = group.first; k < group.first + group.count; ++k) {
    const Aim& aim = aims_[k];
    const double velocity = along_[k] + fraction * along_step_[k];
    double impulse = aim.impulse - group.impulse * (velocity - aim.target);
    if (aim.divisor != 1.0) impulse /= aim.divisor;
    unlimited_[k] = impulse;
    impulses_[k] = impulse;
  }
  if (group.is_contact) {
    project_contact(group);
  } else {
    impulses_[group.first] = std::clamp(unlimited_[group.first], group.lower, group.upper);
  }
}

/// The place of the cone that is nearest to the contact's unlimited impulse.
void VelocityNewton::project_contact(const Group& contact) {
  const double normal = contact.scale * unlimited_[contact.first];
  const double friction = contact.friction / contact.scale;
  const bool has_first = contact.count > 1;
  const bool has_second = contact.count > 2;
  const double x = has_first ? unlimited_[contact.first + 1] : 0.0;
  const double y = has_second ? unlimited_[contact.first + 2] : 0.0;
  double onto = 0.0;
  double fraction = 0.0;
  // Most are open, and need no root to tell.
  if (normal + friction * (std::abs(x) + std::abs(y)) > 0.0) {
    const double aside = std::sqrt(x * x + y * y);
    if (is_in_cone(normal, aside, friction)) return;
    onto = std::max((normal + friction * aside) / (1.0 + friction * friction), 0.0);
    if (aside > 0.0) fraction = friction * onto / aside;
  }
  impulses_[contact.first] = onto / contact.scale;
  if (has_first) impulses_[contact.first + 1] = fraction * x;
  if (has_second) impulses_[contact.first + 2] = fraction * y;
}

/// The size of a contact's friction before limits.
double VelocityNewton::friction_at(std::size_t normal, std::size_t count) const {
  double squared = 0.0;
  for (std::size_t k = normal + 1; k < normal + count; ++k) {
    squared += unlimited_[k] * unlimited_[k];
  }
  return std::sqrt(squared);
}

}  // namespace voxshell::bullet
