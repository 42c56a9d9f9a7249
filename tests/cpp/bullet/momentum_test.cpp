#include <gtest/gtest.h>

#include "support/models.h"
#include "support/random.h"
#include "support/world.h"

namespace voxshell::bullet::momentum_test {
namespace {

using namespace test_support;
using voxshell::test_support::Random;

struct Momenta {
  Vec3 linear;
  Vec3 angular;  ///< about the world's origin
  double energy = 0.0;
};

Momenta measure(const btRigidBody* const (&bodies)[2]) {
  Momenta sum;
  for (const btRigidBody* body : bodies) {
    const double mass = 1.0 / static_cast<double>(body->getInvMass());
    const Vec3 v = from_bullet(body->getLinearVelocity());
    const Vec3 w = from_bullet(body->getAngularVelocity());
    const btVector3 spin = body->getInvInertiaTensorWorld().inverse() * body->getAngularVelocity();
    sum.linear += mass * v;
    sum.angular +=
        mass * cross(from_bullet(body->getCenterOfMassPosition()), v) + from_bullet(spin);
    sum.energy += 0.5 * mass * squared_length(v) + 0.5 * dot(w, from_bullet(spin));
  }
  return sum;
}

TEST(Momentum, IsKeptWhereTwoModelsCollideInFreeSpace) {
  Random random(41);
  int collisions = 0;
  for (int i = 0; i < 40; ++i) {
    TestWorld world({.mode = i % 2 == 0 ? ContactMode::kRegular : ContactMode::kSegmented}, {});
    const auto& other = i % 3 == 0 ? cube_model() : blob_model();
    const Vec3 offset = random.in_cube(0.08);
    btRigidBody& a = world.add_model(torus_model(), 1, {random.rotation(), {-0.3, 0, 0}});
    btRigidBody& b = world.add_model(other, 2.5, {random.rotation(), Vec3{0.3, 0, 0} + offset});
    for (btRigidBody* body : {&a, &b}) {
      // Equal moments: an integrator of unequal ones has gyroscopic errors of its own.
      const btVector3 inertia = to_bullet(Vec3{0.004, 0.004, 0.004} / double(body->getInvMass()));
      body->setMassProps(1 / body->getInvMass(), inertia);
      body->updateInertiaTensor();
      body->setFriction(scalar(0.7));
      body->setRestitution(scalar(0.9));
      body->setAngularVelocity(to_bullet(random.in_cube(1.0)));
    }
    a.setLinearVelocity(btVector3(1, 0, 0));
    b.setLinearVelocity(btVector3(scalar(-0.5), 0, 0));
    const btRigidBody* const bodies[2] = {&a, &b};
    const Momenta before = measure(bodies);
    world.step(200);
    const Momenta after = measure(bodies);
    const Vec3 change = from_bullet(a.getLinearVelocity()) - Vec3{1, 0, 0};
    if (length(change) < 0.05) continue;
    ++collisions;
    EXPECT_LT(length(after.linear - before.linear), 1e-5);
    // Contact points of the two bodies differ by the depth, a step's motion: 7.5 mm.
    EXPECT_LT(length(after.angular - before.angular), 0.01 * 2.5);
    EXPECT_LT(after.energy, before.energy * 1.01);
  }
  EXPECT_GT(collisions, 25);
}

TEST(Momentum, TwoEqualBallsExchangeTheirVelocities) {
  TestWorld world({}, {});
  btRigidBody& a = world.add_model(ball_model(), 1, {{}, {-0.2, 0, 0}});
  btRigidBody& b = world.add_model(ball_model(), 1, {{}, {0.2, 0, 0}});
  a.setRestitution(1);
  b.setRestitution(1);
  a.setLinearVelocity(btVector3(1, 0, 0));
  world.step(200);
  EXPECT_NEAR(a.getLinearVelocity().x(), 0, 0.03);
  EXPECT_NEAR(b.getLinearVelocity().x(), 1, 0.03);
  EXPECT_NEAR(b.getLinearVelocity().y(), 0, 0.05);
}

}  // namespace
}  // namespace voxshell::bullet::momentum_test
