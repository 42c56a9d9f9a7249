#include "seamless_bodies.h"

#include <array>
#include <cmath>
#include <cstddef>

#include <gtest/gtest.h>

#include "contact_constants.h"
#include "support/world.h"

namespace voxshell::bullet::seamless_bodies_test {
namespace {

using namespace test_support;

constexpr double kTimeStep = 0.005;
constexpr double kRadius = 0.1;
// Bullet's bounding sphere of a ball is that of its box.
const double kMost = kSeamKeptOfRadius * std::sqrt(3.0) * kRadius;

/// A ball between two others, which it touches at a point each.
struct BallBetweenTwo {
  BallBetweenTwo() {
    auto& shape = world.make<btSphereShape>(btScalar(kRadius));
    body = &world.add(shape, 1, {});
    for (std::size_t i = 0; i < others.size(); ++i) {
      const double side = i == 0 ? -1.0 : 1.0;
      others[i] = &world.add(shape, 0, {{}, {2.0 * kRadius * side, 0, 0}});
      manifolds[i] = btPersistentManifold(body, others[i], 0, btScalar(0.02), btScalar(0.02));
      btManifoldPoint point(btVector3(btScalar(kRadius * side), 0, 0),
                            btVector3(btScalar(-kRadius * side), 0, 0),
                            btVector3(btScalar(-side), 0, 0), 0);
      point.m_index0 = static_cast<int>(i);
      manifolds[i].addManifoldPoint(point);
    }
  }

  std::array<Touching, 2> touching() {
    return {{{body, others[0], &manifolds[0]}, {body, others[1], &manifolds[1]}}};
  }
  /// A step in which the body is examined if need be.
  bool is_passed_over() {
    bodies.begin();
    SeamlessBody& kept = bodies.of(*body);
    const bool holds = kept.hold(touching(), kTimeStep);
    if (!holds) kept.keep(/*has_seams=*/false);
    bodies.end();
    return holds;
  }
  void move(btRigidBody& moved, double by) {
    btTransform pose = moved.getWorldTransform();
    pose.setOrigin(pose.getOrigin() + btVector3(0, btScalar(by), 0));
    moved.setWorldTransform(pose);
  }

  TestWorld world;
  btRigidBody* body = nullptr;
  std::array<btRigidBody*, 2> others{};
  std::array<btPersistentManifold, 2> manifolds;
  SeamlessBodies bodies;
};

TEST(SeamlessBodies, ArePassedOverUntilSomethingHasMoved) {
  for (const bool moves_other : {false, true}) {
    BallBetweenTwo scene;
    btRigidBody& moved = moves_other ? *scene.others[1] : *scene.body;
    EXPECT_FALSE(scene.is_passed_over());
    EXPECT_TRUE(scene.is_passed_over());
    scene.move(moved, 0.7 * kMost);
    EXPECT_TRUE(scene.is_passed_over());
    scene.move(moved, 0.7 * kMost);  // since they were examined, not since the last step
    EXPECT_FALSE(scene.is_passed_over());
    EXPECT_TRUE(scene.is_passed_over());
  }
}

TEST(SeamlessBodies, AreExaminedAgainWhereVelocitiesChange) {
  BallBetweenTwo scene;
  scene.is_passed_over();
  const auto speed = btScalar(kMost / kTimeStep);
  scene.body->setLinearVelocity({0, btScalar(0.5) * speed, 0});
  EXPECT_TRUE(scene.is_passed_over());
  scene.body->setLinearVelocity({0, btScalar(2) * speed, 0});
  EXPECT_FALSE(scene.is_passed_over());
  scene.body->setAngularVelocity({0, 0, btScalar(2) * speed / btScalar(kRadius)});
  EXPECT_FALSE(scene.is_passed_over());
}

TEST(SeamlessBodies, AreExaminedAgainWhereContactsChange) {
  BallBetweenTwo scene;
  scene.is_passed_over();
  btManifoldPoint& point = scene.manifolds[0].getContactPoint(0);
  point.m_index0 = 7;
  EXPECT_FALSE(scene.is_passed_over());
  EXPECT_TRUE(scene.is_passed_over());
  point.m_normalWorldOnB = btVector3(1, btScalar(0.01), 0).normalized();
  EXPECT_FALSE(scene.is_passed_over());
  EXPECT_TRUE(scene.is_passed_over());
  scene.manifolds[1].clearManifold();
  EXPECT_FALSE(scene.is_passed_over());
}

TEST(SeamlessBodies, WithSeamsAreExaminedInEveryStep) {
  BallBetweenTwo scene;
  for (int i = 0; i < 3; ++i) {
    scene.bodies.begin();
    SeamlessBody& kept = scene.bodies.of(*scene.body);
    EXPECT_FALSE(kept.hold(scene.touching(), kTimeStep));
    kept.keep(/*has_seams=*/true);
    scene.bodies.end();
  }
}

TEST(SeamlessBodies, OfPartsAreExaminedInEveryStep) {
  BallBetweenTwo scene;
  auto& compound = scene.world.make<btCompoundShape>();
  compound.addChildShape(btTransform::getIdentity(), scene.body->getCollisionShape());
  scene.others[0]->setCollisionShape(&compound);
  EXPECT_FALSE(scene.is_passed_over());
  EXPECT_FALSE(scene.is_passed_over());
}

// Another body may come to be at the address of one that was removed.
TEST(SeamlessBodies, AreForgottenWhenTheyTouchNothing) {
  BallBetweenTwo scene;
  scene.is_passed_over();
  scene.bodies.begin();
  scene.bodies.end();
  EXPECT_FALSE(scene.is_passed_over());
}

}  // namespace
}  // namespace voxshell::bullet::seamless_bodies_test
