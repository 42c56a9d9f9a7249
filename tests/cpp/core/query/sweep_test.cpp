#include "voxshell/sweep.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "query/posed.h"
#include "simd/query_kernels.h"
#include "support/meshes.h"
#include "support/pairs.h"
#include "support/random.h"

namespace voxshell::sweep_test {
namespace {

using namespace test_support;

constexpr double kTolerance = 1e-3;
constexpr double kExactTolerance = 4e-3;  // of fields, meters

GridField make_exact_grid(const Soup& soup, double voxel_size) {
  auto field = GridField::build(
      soup.mesh(),
      {.voxel_size = voxel_size, .tolerance = kExactTolerance, .padding = 2 * voxel_size});
  if (!field) std::abort();
  return *std::move(field);
}

/// With edges, and without.
const std::vector<PointShell>& all_shells() {
  static const auto* all = [] {
    auto* made = new std::vector<PointShell>(shells());
    for (const Soup& soup : {make_l_shape(0.3), make_wedge(0.8, 0.05, 0.4), make_spike(0.3, 0.8)}) {
      auto shell = PointShell::build(soup.mesh(), {.tolerance = 8e-3});
      if (!shell) std::abort();
      made->push_back(*std::move(shell));
    }
    return made;
  }();
  return *all;
}

const std::vector<Field>& all_fields() {
  static const auto* all = [] {
    auto* made = new std::vector<Field>(fields());
    made->push_back(make_exact_grid(make_l_shape(0.3), 0.04));
    made->push_back(make_exact_grid(make_torus(0.4, 0.12, 40, 20), 0.04));
    return made;
  }();
  return *all;
}

Pose field_from_shell(const RigidMotion& of_field, const RigidMotion& of_shell, double fraction) {
  return of_field.at(fraction).inverse() * of_shell.at(fraction);
}

/// Toward a place of the other body, or past it; turning by up to a whole turn, or not at all.
RigidMotion make_motion(Random& random, int kind) {
  RigidMotion motion{random.pose(1.0), {}, {}};
  motion.start.translation = random.uniform(0.5, 1.5) * random.direction();
  if (kind % 5 != 0) {
    const Vec3 toward = random.in_cube(0.4) - motion.start.translation;
    motion.displacement = random.uniform(0.1, 2.0) * toward;
  }
  if (kind % 3 != 0) motion.turn = random.uniform(0.0, 6.0) * random.direction();
  return motion;
}

/// Where a grid's cells meet, it may be discontinuous; bodies may stop by so much before. Meters.
double largest_step(const Field& field) {
  const auto* const grid = std::get_if<GridField>(&field);
  if (grid == nullptr) return 0.0;
  return grid->has_exact_cells() ? kExactTolerance : 0.1 * grid->voxel_size();
}

/// At which fractions before an end to look: some of them just before it.
double choose_before(double end, int i, Random& random) {
  const double left = i % 2 == 0 ? random.unit() : std::pow(10.0, -6.0 * random.unit());
  return end * (1.0 - left);
}

TEST(Sweep, NothingTouchesBeforeAndSomethingIsNearThen) {
  Random random(230);
  QueryScratch scratch;
  int motions = 0;
  int free = 0;
  int at_once = 0;
  for (const PointShell& shell : all_shells()) {
    for (const Field& field : all_fields()) {
      const double step = largest_step(field);
      for (int i = 0; i < 20; ++i) {
        RigidMotion of_field;
        if (i % 4 == 0) {
          of_field = {{}, random.in_cube(0.5), random.uniform(0.0, 3.0) * random.direction()};
        }
        const RigidMotion of_shell = make_motion(random, i);
        const float margin = i % 3 == 0 ? 0.02f : i % 7 == 0 ? -0.02f : 0.0f;
        const SweepOptions options{.margin = margin, .tolerance = kTolerance};
        const Sweep found = sweep(field, shell, of_field, of_shell, options, scratch);
        const auto pose = [&](double fraction) {
          return field_from_shell(of_field, of_shell, fraction);
        };
        for (int k = 0; k < 60 && found.fraction > 0.0; ++k) {
          const double fraction = choose_before(found.fraction, k, random);
          ASSERT_FALSE(collides(field, shell, pose(fraction), margin))
              << fraction << " of " << found.fraction;
        }
        ++motions;
        if (!found.contact) {
          ASSERT_EQ(found.fraction, 1.0);
          ++free;
          continue;
        }
        const double distance = -static_cast<double>(found.contact->depth);
        ASSERT_LT(distance, static_cast<double>(margin) + kTolerance + step);
        if (found.fraction > 0.0) {
          ASSERT_GE(distance, static_cast<double>(margin));
        } else {
          ++at_once;
        }
        // It may be asked about a part of the motion.
        const double end = 0.9 * found.fraction;
        if (!(end > 0.0)) continue;
        const Sweep part = sweep(field, shell, of_field, of_shell,
                                 {.margin = margin, .tolerance = kTolerance, .end = end}, scratch);
        ASSERT_LE(part.fraction, end);
        if (part.contact) {
          const double gap = -static_cast<double>(part.contact->depth);
          ASSERT_LT(gap, static_cast<double>(margin) + kTolerance + step);
        } else {
          ASSERT_EQ(part.fraction, end);
        }
      }
    }
  }
  EXPECT_GT(free, motions / 10);
  EXPECT_LT(at_once, motions / 4);
  EXPECT_GT(motions - free - at_once, motions / 3);
}

TEST(Sweep, IsAsCloseAsIsAskedFor) {
  Random random(231);
  QueryScratch scratch;
  int touching = 0;
  for (const PointShell& shell : all_shells()) {
    for (const Field& field : all_fields()) {
      if (std::holds_alternative<GridField>(field)) continue;
      for (int i = 0; i < 4; ++i) {
        const RigidMotion of_shell = make_motion(random, i);
        const Sweep found = sweep(field, shell, {}, of_shell, {.tolerance = 1e-5}, scratch);
        if (!found.contact || found.fraction == 0.0) continue;
        ++touching;
        // And what float32 may add 3 m away, and what the search along an edge may miss.
        const EdgeSegments* edges = shell.edges();
        const double missed =
            edges == nullptr ? 0.0 : edges->bracket() + static_cast<double>(edges->tie());
        ASSERT_LT(-static_cast<double>(found.contact->depth), 4e-5 + missed);
        for (int k = 0; k < 30; ++k) {
          const double fraction = choose_before(found.fraction, k, random);
          ASSERT_FALSE(collides(field, shell, of_shell.at(fraction)));
        }
      }
    }
  }
  EXPECT_GT(touching, 50);
}

TEST(Sweep, OfABallIsThatOfItsMiddle) {
  const PointShell ball = make_shell(make_icosphere(0.1, 5), 0.004);
  QueryScratch scratch;
  // Down onto a plane, and about an axis a meter away onto a sphere.
  const RigidMotion fall{{{}, {0.3, -0.2, 1.0}}, {0.5, 0.0, -2.0}, {1.0, 2.0, 0.5}};
  const Sweep down = sweep(PlaneField{}, ball, {}, fall, {.tolerance = 1e-5}, scratch);
  ASSERT_TRUE(down.contact);
  EXPECT_NEAR(down.fraction, 0.45, 2e-4);

  const PointShell arm = make_shell(
      [] {
        Soup soup = make_icosphere(0.1, 5);
        for (Vec3& p : soup.vertices) p.x += 1.0;
        return soup;
      }(),
      0.004);
  const RigidMotion half_turn{{}, {}, {0.0, 0.0, 3.14159265358979}};
  const Sweep around = sweep(SphereField{0.2}, arm, {{{}, {0.0, 1.0, 0.0}}, {}, {}}, half_turn,
                             {.tolerance = 1e-5}, scratch);
  ASSERT_TRUE(around.contact);
  // Middles are 0.3 m apart where the chord is: a quarter turn less twice asin(0.15).
  const double angle = 1.5707963267948966 - 2.0 * std::asin(0.15);
  EXPECT_NEAR(around.fraction * 3.14159265358979, angle, 1e-3);

  // The same if the sphere goes around the arm.
  const Sweep other = sweep(SphereField{0.2}, arm, {{{}, {0.0, 1.0, 0.0}}, {}, {}}, half_turn,
                            {.tolerance = 1e-5}, scratch);
  EXPECT_EQ(other.fraction, around.fraction);
}

TEST(Sweep, OfBodiesThatMoveAsOneIsFree) {
  QueryScratch scratch;
  // A ball in the hole of a torus.
  const Vec3 displacement{5.0, -1.0, 2.0};
  const Vec3 turn{0.3, -2.0, 1.0};
  const Sweep found = sweep(SphereField{0.25}, shells()[0], {{}, displacement, turn},
                            {{}, displacement, turn}, {.tolerance = kTolerance}, scratch);
  EXPECT_FALSE(found.contact);
  EXPECT_EQ(found.fraction, 1.0);
}

TEST(Sweep, MissesNoPlateHoweverFast) {
  const PointShell plate = make_shell(make_box({0.5, 0.5, 0.001}), 0.05);
  const Field ball = SphereField{0.1};
  QueryScratch scratch;
  for (const double speed : {1.0, 1e3, 1e6}) {
    const RigidMotion shot{{{}, {0.0, 0.0, -0.5 * speed}}, {0.0, 0.0, speed}, {}};
    const Sweep found = sweep(ball, plate, {}, shot, {.tolerance = kTolerance}, scratch);
    ASSERT_TRUE(found.contact) << speed;
    EXPECT_NEAR((found.fraction - 0.5) * speed, -0.101, 2e-3);
  }
}

TEST(Sweep, OfNoMotionIsAQuery) {
  QueryScratch scratch;
  const Pose apart{{}, {0.0, 0.0, 3.0}};
  const Sweep found =
      sweep(PlaneField{}, shells()[0], {}, {apart, {}, {}}, {.tolerance = kTolerance}, scratch);
  EXPECT_FALSE(found.contact);
  EXPECT_EQ(found.fraction, 1.0);
  const Sweep inside = sweep(PlaneField{}, shells()[0], {}, {}, {.tolerance = kTolerance}, scratch);
  ASSERT_TRUE(inside.contact);
  EXPECT_EQ(inside.fraction, 0.0);
  EXPECT_GT(inside.contact->depth, 0.1f);
}

/// The bounds that a sweep goes by, against places within balls.
TEST(Sweep, PassesOverNoPlaceBelowTheMargin) {
  Random random(233);
  int clear = 0;
  int near = 0;
  for (const Field& field : all_fields()) {
    const PointShell& shell = shells()[0];  // its frame alone matters
    with_posed(field, shell, random.pose(0.1), [&]<class V>(const simd::PosedView<V>& posed) {
      const auto& kernels = simd::query_kernels<V>(simd::active_isa());
      const auto distance = [&](const Vec3& p) {
        const auto f = static_cast<Vec3f>(p);
        return posed_distance(posed, simd::portable::Triple<float>{f.x, f.y, f.z});
      };
      for (int i = 0; i < 3000; ++i) {
        const Vec3 place = random.in_cube(0.7);
        const auto radius = static_cast<float>(std::pow(10.0, random.uniform(-5.0, -1.5)));
        const float margin =
            distance(place) - radius * static_cast<float>(random.uniform(0.5, 4.0));
        const auto at = static_cast<Vec3f>(place);
        std::array<std::uint32_t, 16> words{};
        std::array<float, 64> numbers{};
        const simd::PointList one{&words[0],    &words[8], &numbers[0], &numbers[16], &numbers[32],
                                  &numbers[48], 1};
        one.x[0] = at.x;
        one.y[0] = at.y;
        one.z[0] = at.z;
        near += 1;
        if (kernels.may_come_below(posed, one, margin, radius)) continue;
        ++clear;
        for (int k = 0; k < 20; ++k) {
          const double fraction = k % 2 == 0 ? 1.0 : random.unit();
          const Vec3 moved = place + fraction * static_cast<double>(radius) * random.direction();
          ASSERT_GE(distance(moved), margin) << "field " << field.index();
        }
      }
    });
  }
  EXPECT_GT(clear, near / 20);
}

}  // namespace
}  // namespace voxshell::sweep_test
