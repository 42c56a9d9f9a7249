#include "face_field.h"

#include <cmath>
#include <limits>
#include <optional>

#include <gtest/gtest.h>

namespace voxshell::bullet::face_field_test {
namespace {

constexpr double kWithin = 1e-6;
constexpr double kNoLimit = std::numeric_limits<double>::infinity();

/// A ball in a groove that is bent to a ring: both of its radii are larger than the ball's.
struct Groove {
  Vec3 center;  ///< of the ball, from the place of the groove's middle line that is nearest to it
  double ball;
  double groove;
  double ring;

  /// How often the groove is asked, and where the ball faces it.
  std::optional<Facing> face(const Vec3& direction, int& asked) const {
    return face_field(
        direction, {}, kNoLimit, kWithin,
        [&](const Vec3& along) { return std::optional(center + ball * along); },
        [&](const Vec3& position) {
          ++asked;
          // The ring's axis is along z, at a distance of its radius along x.
          const double out = std::hypot(position.x + ring, position.y);
          const Vec3 around{(position.x + ring) / out, position.y / out, 0.0};
          const Vec3 aside = (out - ring) * around + Vec3{0, 0, position.z};
          return Facing{position, -normalized(aside), groove - length(aside)};
        });
  }
};

TEST(FaceField, OfAGrooveThatIsHardlyWiderThanABall) {
  for (const double groove : {0.0101, 0.011, 0.02}) {
    const Groove bend{{0.6 * (groove - 0.01), 0, -0.8 * (groove - 0.01)}, 0.01, groove, 0.1};
    int asked = 0;
    // As far off as a coarse grid's normal may be.
    const auto facing = bend.face(normalized(Vec3{0.5, 0.15, -0.8}), asked);
    ASSERT_TRUE(facing.has_value()) << groove;
    EXPECT_NEAR(facing->position.x, bend.center.x + 0.006, 2e-5) << groove;
    EXPECT_NEAR(facing->position.y, 0.0, 2e-5) << groove;
    EXPECT_NEAR(facing->distance, 0.0, 1e-7) << groove;
    EXPECT_LE(asked, kMostSlides) << groove;
  }
}

TEST(FaceField, IsNoneWhereTheFieldHasNoNormal) {
  const auto facing = face_field(
      Vec3{0, 0, -1}, {}, kNoLimit, kWithin, [](const Vec3& along) { return std::optional(along); },
      [](const Vec3& position) { return Facing{position, Vec3{}, 0.0}; });
  EXPECT_FALSE(facing.has_value());
}

TEST(FaceField, IsNoneWhereTheSurfaceTurnsWithTheDirection) {
  // A peg in its hole: its normal turns by all of the turn.
  int asked = 0;
  const auto facing = face_field(
      normalized(Vec3{0.5, 0, -1}), Vec3{0.1, 0, 0}, 0.5, kWithin,
      [](const Vec3& along) { return std::optional(along); },
      [&](const Vec3& position) {
        ++asked;
        return Facing{position, -normalized(position + Vec3{0.1, 0, 0}), 0.0};
      });
  EXPECT_FALSE(facing.has_value());
  EXPECT_EQ(asked, 1);
}

TEST(Turn, LearnsALinearMapInAsManyStepsAsItHasDirections) {
  // What is missed after a turn: most of it along x, hardly any along y.
  const auto missed_at = [](const Vec3& at) {
    return Vec3{0.3 - 0.05 * at.x, 0.2 - 0.9 * at.y, 0};
  };
  Turn turn;
  Vec3 at;
  Vec3 missed = missed_at(at);
  int steps = 0;
  while (length(missed) > 1e-9 && steps < 10) {
    const Vec3 turned = turn.of(missed);
    at = at + turned;
    const Vec3 then = missed_at(at);
    ASSERT_TRUE(turn.learn(turned, missed - then));
    missed = then;
    ++steps;
  }
  EXPECT_LE(steps, 5);
  EXPECT_NEAR(at.x, 6.0, 1e-6);
}

TEST(Turn, TellsWhereNothingIsRegained) {
  Turn turn;
  EXPECT_FALSE(turn.learn({0.1, 0, 0}, {}));
}

}  // namespace
}  // namespace voxshell::bullet::face_field_test
