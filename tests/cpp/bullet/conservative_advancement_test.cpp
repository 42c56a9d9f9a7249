#include "conservative_advancement.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "support/models.h"
#include "support/random.h"
#include "voxshell/plane_field.h"

namespace voxshell::bullet::conservative_advancement_test {
namespace {

using namespace test_support;
using voxshell::test_support::Random;

constexpr double kTouching = 1e-4;

template <class F>
std::optional<Advance> advance_point(const F& field, const Vec3& start, const Vec3& displacement,
                                     double offset = 0.0) {
  return advance(length(displacement), kTouching, 1.0, [&](double fraction) {
    return clearance_of(field, static_cast<Vec3f>(start + fraction * displacement), offset);
  });
}

TEST(ConservativeAdvancement, StopsWhereItTouches) {
  const PlaneField plane{{0, 0, 1}, 0.0};
  const auto reached = advance_point(plane, {0, 0, 0.5}, {0.3, 0.2, -1.0});
  ASSERT_TRUE(reached);
  EXPECT_NEAR(reached->fraction, 0.5, kTouching);
  EXPECT_NEAR(reached->gap, 0.5 * kTouching, 0.5 * kTouching);
}

TEST(ConservativeAdvancement, StopsAnOffsetBeforeTheField) {
  const PlaneField plane{{0, 0, 1}, 0.0};
  const auto reached = advance_point(plane, {0, 0, 0.5}, {0, 0, -1.0}, 0.1);
  ASSERT_TRUE(reached);
  EXPECT_NEAR(reached->fraction, 0.4, kTouching);
}

TEST(ConservativeAdvancement, GoesOnWhereNothingIsTouched) {
  const PlaneField plane{{0, 0, 1}, 0.0};
  EXPECT_FALSE(advance_point(plane, {0, 0, 0.5}, {0, 0, -0.49}));
  EXPECT_FALSE(advance_point(plane, {0, 0, 0.5}, {3, 0, 0}));
  EXPECT_FALSE(advance_point(plane, {0, 0, 0.5}, {0, 0, 0}));
}

TEST(ConservativeAdvancement, StaysWhereItAlreadyTouches) {
  const PlaneField plane{{0, 0, 1}, 0.0};
  const auto reached = advance_point(plane, {0, 0, -0.5}, {0, 0, 1});
  ASSERT_TRUE(reached);
  EXPECT_EQ(reached->fraction, 0.0);
  EXPECT_NEAR(reached->gap, -0.5, 1e-6);
}

TEST(ConservativeAdvancement, TakesFewStepsWhereTheFieldsBoundIsGood) {
  const PlaneField plane{{0, 0, 1}, 0.0};
  int steps = 0;
  const auto reached = advance(1.0, kTouching, 1.0, [&](double fraction) {
    ++steps;
    return clearance_of(plane, static_cast<Vec3f>(Vec3{0, 0, 0.5 - fraction}), 0.0);
  });
  ASSERT_TRUE(reached);
  EXPECT_LE(steps, 6);
}

// With factors of 0.6 to 1 of a field that may fall by up to sqrt(3) of the way, places could
// come out on a wall's far side.
TEST(ConservativeAdvancement, NeverPassesTheSurfaceOfAModel) {
  Random random(11);
  int hits = 0;
  for (const auto& model : {cube_model(), blob_model(), torus_model()}) {
    const GridField& field = model->grid();
    for (int i = 0; i < 400; ++i) {
      const Vec3 start = 0.4 * random.direction();
      const Vec3 displacement = 0.15 * random.direction() - 2.0 * start;
      const auto reached = advance_point(field, start, displacement);
      const double end = reached ? reached->fraction : 1.0;
      double least = std::numeric_limits<double>::infinity();
      for (int k = 0; k <= 2000; ++k) {
        const Vec3 place = start + (end * k / 2000) * displacement;
        least = std::min(least, static_cast<double>(field.distance(static_cast<Vec3f>(place))));
      }
      EXPECT_GT(least, 0.0) << i;
      hits += reached ? 1 : 0;
    }
  }
  EXPECT_GT(hits, 400);
}

}  // namespace
}  // namespace voxshell::bullet::conservative_advancement_test
