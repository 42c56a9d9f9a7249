#include "velocity_newton.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "solver_constants.h"
#include "support/random.h"
#include "voxshell/vector.h"

namespace voxshell::bullet::velocity_newton_test {
namespace {

using voxshell::test_support::Random;

/// Bodies of given masses on one line; each stands on the one below, the first one on the ground.
std::vector<VelocityRow> make_column(const std::vector<double>& masses, double fall) {
  std::vector<VelocityRow> rows;
  for (std::size_t i = 0; i < masses.size(); ++i) {
    VelocityRow row;
    row.is_contact = true;
    row.body_a = static_cast<int>(i);
    row.along_a[2] = 1.0 / std::sqrt(masses[i]);
    row.unit_impulse = masses[i];
    if (i > 0) {
      row.body_b = static_cast<int>(i) - 1;
      row.along_b[2] = -1.0 / std::sqrt(masses[i - 1]);
      row.unit_impulse = 1.0 / (1.0 / masses[i] + 1.0 / masses[i - 1]);
    } else {
      row.target = fall;
    }
    rows.push_back(row);
  }
  return rows;
}

/// A contact of a body of 1 kg, upward, with a friction of 0.5; its friction rows follow it.
VelocityRow make_contact(int friction_rows) {
  VelocityRow normal;
  normal.is_contact = true;
  normal.friction_rows = friction_rows;
  normal.friction = 0.5;
  normal.body_a = 0;
  normal.along_a[2] = 1.0;
  normal.unit_impulse = 1.0;
  return normal;
}

/// A row of the contact's friction, along an axis of the body's frame.
VelocityRow make_friction(const VelocityRow& normal, std::size_t axis) {
  VelocityRow row;
  row.body_a = normal.body_a;
  row.along_a[axis] = 1.0;
  row.unit_impulse = normal.unit_impulse;
  row.friction = normal.friction;
  return row;
}

TEST(VelocityNewton, FindsWhatEachContactOfAColumnCarries) {
  const std::vector<double> masses{1.0, 1000.0, 1.0, 50.0};
  constexpr double kFall = 0.1;  // m/s
  std::vector<VelocityRow> rows = make_column(masses, kFall);
  VelocityNewton newton;
  newton.prepare(masses.size(), rows);
  for (int i = 0; i < 10; ++i) newton.solve(rows, 1e4, 20);
  double carried = 0.0;
  for (std::size_t i = masses.size(); i-- > 0;) {
    carried += masses[i] * kFall;
    EXPECT_NEAR(rows[i].impulse, carried, 1e-6 * carried) << i;
  }
}

TEST(VelocityNewton, MeasuresTheVelocityThatImpulsesMiss) {
  constexpr double kFall = 0.1;  // m/s
  std::vector<VelocityRow> rows = make_column({1.0, 1000.0}, kFall);
  VelocityNewton newton;
  newton.prepare(2, rows);
  EXPECT_DOUBLE_EQ(newton.error(rows), kFall);
  // The lower body is stopped, and the heavy one falls on.
  rows[0].impulse = kFall;
  EXPECT_DOUBLE_EQ(newton.error(rows), kFall);
  for (int i = 0; i < 10; ++i) newton.solve(rows, 1e4, 20);
  EXPECT_LT(newton.error(rows), 1e-9);
  rows[0].impulse = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(newton.error(rows) < kFall);
}

TEST(VelocityNewton, LeavesOpenWhatPullsAndKeepsFrictionInItsCone) {
  const VelocityRow normal = make_contact(2);
  const VelocityRow along_x = make_friction(normal, 0);
  const VelocityRow along_y = make_friction(normal, 1);
  const auto solve = [&](double up, double x, double y) {
    std::array rows{normal, along_x, along_y};
    rows[0].target = up;
    rows[1].target = x;
    rows[2].target = y;
    VelocityNewton newton;
    newton.prepare(1, rows);
    EXPECT_TRUE(newton.solve(rows, 1e4, 20));
    return std::array{rows[0].impulse, rows[1].impulse, rows[2].impulse};
  };
  EXPECT_EQ(solve(-1.0, 0.0, 0.0), (std::array{0.0, 0.0, 0.0}));
  const auto sticking = solve(1.0, 0.3, 0.3);
  EXPECT_NEAR(sticking[1], 0.3, 1e-3);
  const auto sliding = solve(1.0, 3.0, 4.0);
  EXPECT_NEAR(std::hypot(sliding[1], sliding[2]), 0.5 * sliding[0], 1e-9);
  EXPECT_NEAR(sliding[2] / sliding[1], 4.0 / 3.0, 1e-6);
}

/// A contact that gives way, at rest and sliding: v + softness * impulse is its target.
TEST(VelocityNewton, GivesWayAlongTheNormalAlone) {
  constexpr double kSoftness = 3.0;
  VelocityRow normal = make_contact(1);
  normal.unit_impulse = 1.0 / (1.0 + kSoftness);
  normal.softness = kSoftness;
  normal.target = 2.0;
  const VelocityRow along_x = make_friction(normal, 0);
  for (const double aside : {0.2, 5.0}) {
    std::array rows{normal, along_x};
    rows[1].target = aside;
    VelocityNewton newton;
    newton.prepare(1, rows);
    for (int i = 0; i < 20; ++i) ASSERT_TRUE(newton.solve(rows, 1e4, 20));
    EXPECT_LT(newton.error(rows), 1e-9);
    // Of 1 kg: velocities are impulses. What slides also opens by friction times its speed.
    const double sliding = aside - rows[1].impulse;
    EXPECT_NEAR(rows[0].impulse * (1.0 + kSoftness), 2.0 + 0.5 * sliding, 1e-6);
    EXPECT_NEAR(rows[1].impulse, std::min(aside, 0.5 * rows[0].impulse), 1e-6);
  }
}

/// Bodies of 1 kg on top of each other, with many contacts of scattered normals between each two.
std::vector<VelocityRow> make_rubble(int bodies, int contacts_each, unsigned seed) {
  std::minstd_rand random(seed);
  const auto draw = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / std::minstd_rand::max();
  };
  std::vector<VelocityRow> rows;
  for (int i = 0; i < bodies * contacts_each; ++i) {
    const int above = i / contacts_each;
    const Vec3 lever{draw(-1.5, 1.5), draw(-1.5, 1.5), draw(-1.0, 1.0)};
    const Vec3 normal = normalized(Vec3{draw(-1.0, 1.0), draw(-1.0, 1.0), draw(0.1, 1.0)});
    const Vec3 across = normalized(cross(normal, Vec3{1.0, 0.3, 0.2}));
    const double target = draw(-3.0, 0.3);
    const double impulse = draw(0.0, 1.0);
    for (const Vec3& along : {normal, across, cross(normal, across)}) {
      VelocityRow& row = rows.emplace_back();
      const Vec3 turn = cross(lever, along);
      row.body_a = above;
      row.along_a = {along.x, along.y, along.z, turn.x, turn.y, turn.z};
      double answer = dot(along, along) + dot(turn, turn);
      if (above > 0) {
        row.body_b = above - 1;
        const Vec3 turn_b = cross(lever + Vec3{0.0, 0.0, 2.0}, along);
        row.along_b = {-along.x, -along.y, -along.z, -turn_b.x, -turn_b.y, -turn_b.z};
        answer += dot(along, along) + dot(turn_b, turn_b);
      }
      row.unit_impulse = 1.0 / answer;
    }
    VelocityRow& first = rows[rows.size() - 3];
    first.is_contact = true;
    first.friction_rows = 2;
    first.friction = 1.0;
    first.target = target;
    first.impulse = impulse;
    first.unit_impulse = std::min({first.unit_impulse, rows[rows.size() - 2].unit_impulse,
                                   rows[rows.size() - 1].unit_impulse});
  }
  return rows;
}

/// The velocities at which a solve ends are to be those that its impulses give. Otherwise each
/// solve begins farther from the solution than the one before.
TEST(VelocityNewton, ErrorsOfHundredsOfContactsDoNotGrowFromSolveToSolve) {
  constexpr int kBodies = 8;
  for (const unsigned seed : {1U, 2U, 3U}) {
    SCOPED_TRACE(seed);
    std::vector<VelocityRow> rows = make_rubble(kBodies, 150, seed);
    VelocityNewton newton;
    newton.prepare(kBodies, rows);
    for (const double stiffness : {6.4e3, 1e4, 1e4, 1e4}) {
      EXPECT_TRUE(newton.solve(rows, stiffness, kMostNewtonSteps));
      EXPECT_LT(newton.error(rows), 0.5);  // m/s: contacts that slide may open
    }
  }
}

TEST(VelocityNewton, ChangesNoImpulseWhereStepsDoNotSuffice) {
  std::vector<VelocityRow> rows = make_rubble(8, 150, 1);
  const std::vector<VelocityRow> before = rows;
  VelocityNewton newton;
  newton.prepare(8, rows);
  EXPECT_FALSE(newton.solve(rows, 1e4, 2));
  for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(rows[i].impulse, before[i].impulse);
}

// ---- islands of rows in all directions
// -----------------------------------------------------------

/// The velocity along one row by a unit impulse of another.
double answer_of(const VelocityRow& row, const VelocityRow& pushed) {
  double sum = 0.0;
  const auto add = [&](int body, const std::array<double, 6>& along, int other_body,
                       const std::array<double, 6>& other_along) {
    if (body == VelocityRow::kFixed || body != other_body) return;
    for (std::size_t k = 0; k < 6; ++k) sum += along[k] * other_along[k];
  };
  add(row.body_a, row.along_a, pushed.body_a, pushed.along_a);
  add(row.body_a, row.along_a, pushed.body_b, pushed.along_b);
  add(row.body_b, row.along_b, pushed.body_a, pushed.along_a);
  add(row.body_b, row.along_b, pushed.body_b, pushed.along_b);
  return sum;
}

/// A row between two bodies, either of which may be fixed, with no limits.
VelocityRow make_row(Random& random, int a, int b) {
  VelocityRow row;
  row.body_a = a;
  row.body_b = b;
  for (double& x : row.along_a) x = random.uniform(-1.0, 1.0);
  for (double& x : row.along_b) x = random.uniform(-1.0, 1.0);
  row.lower = -std::numeric_limits<double>::infinity();
  row.upper = std::numeric_limits<double>::infinity();
  row.unit_impulse = 1.0 / answer_of(row, row);
  return row;
}

/// Velocities along rows by impulses of all of them.
std::vector<double> velocities_of(const std::vector<VelocityRow>& rows,
                                  const std::vector<double>& impulses) {
  std::vector<double> velocities(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t j = 0; j < rows.size(); ++j) {
      velocities[i] += answer_of(rows[i], rows[j]) * impulses[j];
    }
  }
  return velocities;
}

/// Elimination with the largest pivot of each column.
std::vector<double> solve_dense(std::vector<std::vector<double>> matrix, std::vector<double> x) {
  const std::size_t size = x.size();
  for (std::size_t k = 0; k < size; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k; i < size; ++i) {
      if (std::abs(matrix[i][k]) > std::abs(matrix[pivot][k])) pivot = i;
    }
    std::swap(matrix[k], matrix[pivot]);
    std::swap(x[k], x[pivot]);
    for (std::size_t i = k + 1; i < size; ++i) {
      const double factor = matrix[i][k] / matrix[k][k];
      for (std::size_t j = k; j < size; ++j) matrix[i][j] -= factor * matrix[k][j];
      x[i] -= factor * x[k];
    }
  }
  for (std::size_t k = size; k-- > 0;) {
    for (std::size_t j = k + 1; j < size; ++j) x[k] -= matrix[k][j] * x[j];
    x[k] /= matrix[k][k];
  }
  return x;
}

TEST(VelocityNewton, SolvesTheDenseSystemOfSoftJoints) {
  Random random(1);
  constexpr std::size_t kBodies = 5;
  // A ring in an order that is not that of the numbers, and a joint that holds it.
  constexpr std::array<std::array<int, 2>, 6> kJoints{
      {{0, 3}, {3, 1}, {1, 4}, {4, 2}, {2, 0}, {VelocityRow::kFixed, 1}}};
  std::vector<VelocityRow> rows;
  for (const auto& [a, b] : kJoints) {
    for (int i = 0; i < 3; ++i) {
      VelocityRow& row = rows.emplace_back(make_row(random, a, b));
      row.softness = random.uniform(0.0, 0.5);
      row.target = random.uniform(-2.0, 2.0);
    }
  }
  std::vector<std::vector<double>> matrix(rows.size(), std::vector<double>(rows.size()));
  std::vector<double> targets;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t j = 0; j < rows.size(); ++j) matrix[i][j] = answer_of(rows[i], rows[j]);
    matrix[i][i] += rows[i].softness;
    targets.push_back(rows[i].target);
  }
  const std::vector<double> expected = solve_dense(matrix, targets);
  VelocityNewton newton;
  newton.prepare(kBodies, rows);
  // Without limits the function is a parabola: one step, and another for its rounding.
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(newton.solve(rows, 1e4, 2));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_NEAR(rows[i].impulse, expected[i], 1e-6) << i;
  }
}

/// Whether a row's impulse is at a limit, or the state of a contact.
enum class State { kWithin, kAtLower, kAtUpper, kSticks, kSlides, kIsOpen };

/// An island of contacts and limited joints, made from its answer: of two directions in a plane,
/// the impulse lies in the cone or on it, and the velocity misses its target the other way.
struct Answered {
  std::vector<VelocityRow> rows;
  std::vector<double> impulses;
  std::vector<double> misses;  ///< velocity less target

  void add_limited(const VelocityRow& joint, State state) {
    VelocityRow& row = rows.emplace_back(joint);
    row.lower = -0.5;
    row.upper = 0.8;
    impulses.push_back(state == State::kAtLower ? -0.5 : state == State::kAtUpper ? 0.8 : 0.1);
    misses.push_back(state == State::kAtLower ? 0.7 : state == State::kAtUpper ? -0.7 : 0.0);
  }

  void add_contact(const std::vector<VelocityRow>& normal_and_friction, State state,
                   const std::array<double, 2>& aside) {
    constexpr double kFriction = 0.6;
    constexpr double kNormal = 1.3;
    constexpr double kSpeed = 0.4;  // of sliding, or away from the surface
    const std::size_t first = rows.size();
    rows.insert(rows.end(), normal_and_friction.begin(), normal_and_friction.end());
    rows[first].is_contact = true;
    rows[first].friction = kFriction;
    rows[first].friction_rows = static_cast<int>(normal_and_friction.size()) - 1;
    for (const VelocityRow& row : normal_and_friction) {
      rows[first].unit_impulse = std::min(rows[first].unit_impulse, row.unit_impulse);
    }
    impulses.push_back(state == State::kIsOpen ? 0.0 : kNormal);
    misses.push_back(state == State::kSticks ? 0.0 : kFriction * kSpeed);
    if (state == State::kIsOpen) misses.back() += 0.1;
    const double share = state == State::kSticks ? 0.5 : state == State::kSlides ? 1.0 : 0.0;
    for (std::size_t k = 0; k + first + 1 < rows.size(); ++k) {
      impulses.push_back(share * kFriction * kNormal * aside[k]);
      misses.push_back(state == State::kSticks ? 0.0 : -kSpeed * aside[k]);
    }
  }
};

TEST(VelocityNewton, FindsTheImpulsesThatAComplementarityProblemIsMadeFrom) {
  constexpr int kBodies = 6;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const auto draw = [&] {
      const auto a = static_cast<int>(random.below(kBodies));
      const int b = (a + 1 + static_cast<int>(random.below(kBodies - 1))) % kBodies;
      return std::array{a, random.below(4) == 0 ? VelocityRow::kFixed : b};
    };
    Answered island;
    for (const State state : {State::kWithin, State::kAtLower, State::kAtUpper}) {
      const auto [a, b] = draw();
      island.add_limited(make_row(random, a, b), state);
    }
    for (const State state : {State::kSticks, State::kSlides, State::kIsOpen}) {
      for (const std::size_t friction_rows : {1u, 2u}) {
        const auto [a, b] = draw();
        std::vector<VelocityRow> rows;
        for (std::size_t k = 0; k <= friction_rows; ++k) rows.push_back(make_row(random, a, b));
        const double angle = random.uniform(0.0, 6.28);
        const std::array one{random.below(2) == 0 ? 1.0 : -1.0, 0.0};
        const std::array two{std::cos(angle), std::sin(angle)};
        island.add_contact(rows, state, friction_rows == 1 ? one : two);
      }
    }
    std::vector<VelocityRow>& rows = island.rows;
    const std::vector<double> velocities = velocities_of(rows, island.impulses);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      rows[i].target = velocities[i] - island.misses[i];
    }
    VelocityNewton newton;
    newton.prepare(kBodies, rows);
    for (int i = 0; i < 40; ++i) ASSERT_TRUE(newton.solve(rows, 1e3, 25));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      EXPECT_NEAR(rows[i].impulse, island.impulses[i], 1e-5) << i;
    }
    EXPECT_LT(newton.error(rows), 1e-7);
  }
}

// ---- the order of bodies
// -------------------------------------------------------------------------

/// In whatever order its links are numbered, a row of the matrix reaches to the end of the next
/// link: of its six rows, from 11 places on to 6; of the last link's, from 5 to 0.
TEST(VelocityNewton, FactorizesAChainAsABand) {
  constexpr std::array kNumbers{3, 0, 5, 1, 6, 2, 4};
  Random random(2);
  std::vector<VelocityRow> rows;
  for (std::size_t i = 0; i + 1 < kNumbers.size(); ++i) {
    rows.push_back(make_row(random, kNumbers[i], kNumbers[i + 1]));
  }
  VelocityNewton newton;
  constexpr double kOfLink = 0.5 * (11 * 11 + 10 * 10 + 9 * 9 + 8 * 8 + 7 * 7 + 6 * 6);
  constexpr double kOfLast = 0.5 * (5 * 5 + 4 * 4 + 3 * 3 + 2 * 2 + 1 * 1);
  EXPECT_EQ(newton.prepare(kNumbers.size(), rows), 6 * kOfLink + kOfLast);
  EXPECT_EQ(newton.prepare(kNumbers.size(), {}), 7 * kOfLast);
}

TEST(VelocityNewton, NeedsNoStepFromImpulsesThatSolve) {
  std::vector<VelocityRow> rows = make_column({1.0, 10.0}, 0.1);
  VelocityNewton newton;
  newton.prepare(2, rows);
  EXPECT_FALSE(newton.solve(rows, 1e2, 0));
  rows[0].impulse = 1.1;
  rows[1].impulse = 1.0;
  EXPECT_TRUE(newton.solve(rows, 1e2, 0));
  EXPECT_NEAR(rows[0].impulse, 1.1, 1e-9);
  EXPECT_NEAR(rows[1].impulse, 1.0, 1e-9);
}

}  // namespace
}  // namespace voxshell::bullet::velocity_newton_test
