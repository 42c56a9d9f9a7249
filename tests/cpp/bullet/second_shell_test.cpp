#include "second_shell.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "contact_constants.h"
#include "support/models.h"
#include "support/random.h"
#include "support/world.h"

namespace voxshell::bullet::second_shell_test {
namespace {

using namespace test_support;
namespace meshes = voxshell::test_support;

TEST(SecondShell, ContactsAreThoseOfTheFirstTurnedOver) {
  meshes::Random random(7);
  for (int i = 0; i < 100; ++i) {
    const Pose first_from_second = random.pose(1.0);
    const Contact found{5, 0.25f, static_cast<Vec3f>(random.in_cube(1.0)),
                        static_cast<Vec3f>(random.direction())};
    const Contact turned = turn_over(found, first_from_second);
    EXPECT_EQ(turned.id, kFirstOfSecond + 5);
    EXPECT_EQ(turned.depth, found.depth);
    const Vec3 place = first_from_second.transform_point(static_cast<Vec3>(found.point));
    EXPECT_LT(length(place_of_second(turned) - place), 1e-6);
    const Vec3 normal = first_from_second.rotate(static_cast<Vec3>(found.normal));
    EXPECT_LT(length(static_cast<Vec3>(turned.normal) + normal), 1e-6);
  }
}

TEST(SecondShell, DropsOnlyWhatIsNearAndFacesTheSameWay) {
  const Vec3f up{0, 0, 1};
  const Vec3f aside{1, 0, 0};
  std::vector<Contact> contacts{{3, 0.1f, {0, 0, 0}, up},
                                {9, 0.1f, {1, 0, 0}, up},
                                {kFirstOfSecond + 1, 0.1f, {0.0005f, 0, 0}, up},
                                {kFirstOfSecond + 2, 0.1f, {0.0005f, 0, 0}, aside},
                                {kFirstOfSecond + 3, 0.1f, {1.0f, 0.002f, 0}, up},
                                {kFirstOfSecond + 4, 0.1f, {1.0f, 0, -0.0005f}, up}};
  SecondShell second;
  second.drop_doubles(0.001f, contacts);
  std::vector<std::uint32_t> ids;
  for (const Contact& contact : contacts) ids.push_back(contact.id);
  EXPECT_EQ(ids, (std::vector<std::uint32_t>{3, 9, kFirstOfSecond + 2, kFirstOfSecond + 3}));
}

TEST(SecondShell, DropsWhatAComparisonOfAllFinds) {
  meshes::Random random(8);
  std::size_t dropped = 0;
  std::size_t kept = 0;
  for (int i = 0; i < 200; ++i) {
    const double size = std::pow(10.0, random.uniform(-4, 1));
    const float margin = i % 10 == 0 ? 0.0f : static_cast<float>(0.01 * random.unit());
    std::vector<Contact> contacts;
    const auto append = [&](std::uint32_t first, std::size_t count) {
      for (std::uint32_t k = 0; k < count; ++k) {
        // Often at the same place.
        const Vec3 place = i % 3 == 0 ? Vec3{0.01 * (k % 5), 0, 0} : size * random.in_cube(0.1);
        const Vec3 normal = k % 3 == 0 ? Vec3{0, 0, 1} : random.direction();
        contacts.push_back(
            {first + k, 0.0f, static_cast<Vec3f>(place), static_cast<Vec3f>(normal)});
      }
    };
    append(0, random.below(60));
    const std::size_t of_first = contacts.size();
    append(kFirstOfSecond, random.below(60));
    std::vector<std::uint32_t> expected;
    for (std::size_t k = 0; k < contacts.size(); ++k) {
      const bool is_double =
          k >= of_first &&
          std::any_of(contacts.begin(), contacts.begin() + static_cast<std::ptrdiff_t>(of_first),
                      [&](const Contact& of) {
                        return squared_length(of.point - contacts[k].point) <= margin * margin &&
                               dot(of.normal, contacts[k].normal) >= kDoubleCosine;
                      });
      if (!is_double) expected.push_back(contacts[k].id);
      (is_double ? dropped : kept) += 1;
    }
    SecondShell second;
    second.drop_doubles(margin, contacts);
    std::vector<std::uint32_t> ids;
    for (const Contact& contact : contacts) ids.push_back(contact.id);
    ASSERT_EQ(ids, expected);
  }
  EXPECT_GT(dropped, 500u);
  EXPECT_GT(kept, 500u);
}

/// A sharp corner that points down between the points of a slab, which are 10 mm apart.
std::shared_ptr<const Model> spike_model() {
  static const auto model = build_model(meshes::make_icosphere(0.02, 0), 0.0008);
  return model;
}

/// The deepest distance of what touches a spike whose tip is 2 mm deep in a slab, somewhere.
double deepest_of_spike(ShellRule rule, const Vec3& at) {
  TestWorld world({.shell = rule, .margin = 0}, {});
  world.add_model(slab_model(), 0.0);
  btRigidBody& spike = world.add_model(spike_model(), 1.0);
  double lowest = 0.0;
  for (const Vec3& v : spike_model()->mesh().vertices()) lowest = std::min(lowest, v.z);
  spike.setWorldTransform(to_bullet(Pose{{}, {at.x, at.y, -0.002 - lowest}}));
  world.world.performDiscreteCollisionDetection();
  double deepest = 0.0;
  for (const btManifoldPoint* point : world.points()) {
    deepest = std::min(deepest, static_cast<double>(point->getDistance()));
  }
  return -deepest;
}

TEST(SecondShell, FindsASpikeBetweenThePointsOfASlab) {
  meshes::Random random(8);
  for (int i = 0; i < 50; ++i) {
    const Vec3 at{random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), 0.0};
    EXPECT_GT(deepest_of_spike(ShellRule::kAutomatic, at), 0.0012) << i;
  }
}

// Its points are followed as well: thrown at 50 m/s, a body of coarse points does not pass between
// those of what it meets.
TEST(SecondShell, HasSpeculativeContacts) {
  meshes::Random random(9);
  for (int i = 0; i < 20; ++i) {
    TestWorld world({}, {});
    world.add_model(slab_model(), 0.0);
    btRigidBody& spike = world.add_model(
        spike_model(), 1.0,
        {random.rotation(), {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), 0.3}});
    spike.setLinearVelocity(btVector3(0, 0, -50));
    world.step(60, 1.0 / 60.0);
    EXPECT_GT(static_cast<double>(spike.getWorldTransform().getOrigin().z()), 0.0) << i;
  }
}

/// Whose points are in contact, as ids tell: of a ball's and a slab's.
TEST(SecondShell, HasIdsOfItsOwn) {
  TestWorld world({.mode = ContactMode::kSegmented, .margin = 0}, {});
  world.add_model(slab_model(), 0.0);
  world.add_model(ball_model(), 1.0, {{}, {0.003, 0.004, kBallRadius - 0.004}});
  world.world.performDiscreteCollisionDetection();
  std::size_t of_second = 0;
  const auto points = world.points();
  for (const btManifoldPoint* point : points) {
    of_second += static_cast<std::uint32_t>(point->m_index0) >= kFirstOfSecond ? 1u : 0u;
    EXPECT_LE(static_cast<double>(point->getDistance()), 0.0);
    EXPECT_GT(std::abs(static_cast<double>(point->m_normalWorldOnB.z())), 0.9);
    // Each point is on its own body's surface.
    EXPECT_NEAR(
        static_cast<double>(
            (point->m_positionWorldOnA - point->m_positionWorldOnB).dot(point->m_normalWorldOnB)),
        static_cast<double>(point->getDistance()), 1e-5);
  }
  EXPECT_GT(of_second, 0u);
  EXPECT_LT(of_second, points.size());
}

}  // namespace
}  // namespace voxshell::bullet::second_shell_test
