#include "step_end.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "second_shell.h"
#include "support/models.h"
#include "support/world.h"
#include "voxshell/bullet/checked_motion.h"
#include "voxshell/bullet/coulomb_solver.h"

namespace voxshell::bullet::step_end_test {
namespace {

using namespace test_support;

constexpr double kStep = 1.0 / 60.0;
constexpr Vec3 kAxes{0.08, 0.05, 0.03};  // of an ellipsoid, half of each

std::shared_ptr<const Model> ellipsoid_model() {
  static const auto model = [] {
    voxshell::test_support::Soup soup = voxshell::test_support::make_icosphere(1.0, 3);
    for (Vec3& corner : soup.vertices) {
      corner = {kAxes.x * corner.x, kAxes.y * corner.y, kAxes.z * corner.z};
    }
    return build_by_tolerance(soup);
  }();
  return model;
}

std::shared_ptr<const Model> round_model() {
  static const auto model = build_by_tolerance(voxshell::test_support::make_icosphere(kAxes.z, 4));
  return model;
}

/// A body that lies on a slab whose top is at z = 0, and turns about the y axis, rad/s.
template <class World>
struct OnASlab {
  OnASlab(const std::shared_ptr<const Model>& model, double spin, double restitution = 0.0) {
    btRigidBody& slab =
        world.add_model(build_by_tolerance({0.5, 0.5, 0.05}), 0, {{}, {0, 0, -0.05}});
    body = &world.add_model(model, 1, {{}, {0, 0, kAxes.z}});
    for (btRigidBody* const each : {&slab, body}) each->setRestitution(scalar(restitution));
    slab.setFriction(1);
    body->setFriction(1);
    body->setAngularVelocity(btVector3(0, scalar(spin), 0));
    body->setLinearVelocity(btVector3(scalar(spin * kAxes.z), 0, 0));
  }

  /// Of the ellipsoid.
  double depth() const {
    const btVector3 down = body->getWorldTransform().getBasis()[2];
    const double reach =
        std::hypot(kAxes.x * static_cast<double>(down.x()), kAxes.y * static_cast<double>(down.y()),
                   kAxes.z * static_cast<double>(down.z()));
    return reach - height(*body);
  }

  bool add_contacts() {
    btBroadphasePairArray& pairs =
        world.broadphase.getOverlappingPairCache()->getOverlappingPairArray();
    EXPECT_EQ(pairs.size(), 1);
    btBroadphasePair& pair = pairs[0];
    auto* const a = static_cast<btRigidBody*>(pair.m_pProxy0->m_clientObject);
    auto* const b = static_cast<btRigidBody*>(pair.m_pProxy1->m_clientObject);
    btDispatcherInfo info = world.world.getDispatchInfo();
    info.m_timeStep = scalar(kStep);
    return step_end.add_contacts(*pair.m_algorithm, *a, *b, world.dispatcher, info);
  }

  StepEnd step_end;
  WorldOf<World, CoulombSolver> world;
  btRigidBody* body;
};

TEST(StepEnd, HoldsWhatTurnsOutOfTheGround) {
  constexpr double kSpin = 15.0;
  OnASlab<CheckedMotionWorld<>> checked(ellipsoid_model(), kSpin);
  OnASlab<btDiscreteDynamicsWorld> stock(ellipsoid_model(), kSpin);
  double deepest = 0.0;
  double deepest_of_stock = 0.0;
  for (int i = 0; i < 6; ++i) {
    checked.world.step(1, kStep);
    stock.world.step(1, kStep);
    deepest = std::max(deepest, checked.depth());
    deepest_of_stock = std::max(deepest_of_stock, stock.depth());
  }
  EXPECT_LT(deepest, 3e-4);
  EXPECT_GT(deepest_of_stock, 1e-3);
}

TEST(StepEnd, ContactsHaveTheGapThatLeavesTheDepthOfTheStepsEnd) {
  OnASlab<btDiscreteDynamicsWorld> scene(ellipsoid_model(), 0.0);
  scene.world.step(2, kStep);
  const std::size_t before = scene.world.points().size();
  EXPECT_FALSE(scene.add_contacts());
  scene.body->setAngularVelocity(btVector3(0, 15, 0));
  ASSERT_TRUE(scene.add_contacts());
  const std::vector<const btManifoldPoint*> points = scene.world.points();
  ASSERT_GE(points.size(), before);
  const auto found = std::ranges::find_if(points, [](const btManifoldPoint* point) {
    return point->m_index0 == static_cast<int>(kEndContact);
  });
  ASSERT_NE(found, points.end());
  const btManifoldPoint& added = **found;
  // What the motion closes of the gap beyond it is the depth at the end of the step.
  const bool is_first = added.m_normalWorldOnB.z() > 0;  // the normal leads to the first body
  const btVector3& place = is_first ? added.m_positionWorldOnA : added.m_positionWorldOnB;
  const btVector3 velocity =
      scene.body->getVelocityInLocalPoint(place - scene.body->getWorldTransform().getOrigin());
  const double closing = -static_cast<double>(velocity.z()) * kStep;
  const double deeper = closing - static_cast<double>(added.getDistance());
  const double before_depth = scene.depth();
  btTransform end;
  scene.body->predictIntegratedTransform(scalar(kStep), end);
  scene.body->setWorldTransform(end);
  EXPECT_GT(scene.depth(), 1e-3);
  EXPECT_NEAR(deeper, scene.depth() - std::max(before_depth, 0.0), 2e-4);
  EXPECT_EQ(added.m_combinedRestitution, 0);
}

TEST(StepEnd, LeavesBodiesThatTurnByFarTooMuch) {
  OnASlab<btDiscreteDynamicsWorld> scene(ellipsoid_model(), 0.0);
  scene.world.step(2, kStep);
  scene.body->setAngularVelocity(btVector3(0, scalar(1.4 / kStep), 0));
  EXPECT_TRUE(scene.add_contacts());
  scene.body->setAngularVelocity(btVector3(0, scalar(1.6 / kStep), 0));
  EXPECT_FALSE(scene.add_contacts());
}

TEST(StepEnd, LeavesRoundBodiesAndThoseThatRebound) {
  OnASlab<btDiscreteDynamicsWorld> round(round_model(), 0.0);
  round.world.step(2, kStep);
  round.body->setAngularVelocity(btVector3(0, 30, 0));
  EXPECT_FALSE(round.add_contacts());
  OnASlab<btDiscreteDynamicsWorld> elastic(ellipsoid_model(), 0.0, 0.8);
  elastic.world.step(2, kStep);
  elastic.body->setAngularVelocity(btVector3(0, 15, 0));
  EXPECT_FALSE(elastic.add_contacts());
}

}  // namespace
}  // namespace voxshell::bullet::step_end_test
