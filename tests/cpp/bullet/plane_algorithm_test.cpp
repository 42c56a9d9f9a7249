#include "plane_algorithm.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "support/world.h"

namespace voxshell::bullet::plane_algorithm_test {
namespace {

using namespace test_support;

constexpr double kRadius = 0.04;
constexpr double kHalf = 0.05;

/// A shape on a plane, in either order.
struct OnAPlane {
  template <class Shape, class... Args>
  static OnAPlane of(bool is_plane_first, double above, Args&&... args) {
    return OnAPlane(is_plane_first, above, [&](TestWorld& in) -> btCollisionShape& {
      Shape& shape = in.make<Shape>(std::forward<Args>(args)...);
      shape.setMargin(scalar(1e-3));  // it rounds edges
      return shape;
    });
  }

  template <class Make>
  OnAPlane(bool is_plane_first, double above, const Make& make) {
    const auto add_plane = [&] {
      plane = &world.add(world.make<btStaticPlaneShape>(btVector3(0, 0, 1), scalar(0)), 0);
      plane->setFriction(1);
    };
    if (is_plane_first) add_plane();
    body = &world.add(make(world), 1, {{}, {0, 0, above}});
    body->setFriction(1);
    if (!is_plane_first) add_plane();
  }

  /// Of the body's z axis, radians.
  double tilt() const {
    const btVector3 axis = body->getWorldTransform().getBasis().getColumn(2);
    return std::hypot(static_cast<double>(axis.x()), static_cast<double>(axis.y()));
  }

  TestWorld world;
  btRigidBody* plane = nullptr;
  btRigidBody* body = nullptr;
};

const btVector3 kCylinder(scalar(kRadius), scalar(kRadius), scalar(kHalf));

TEST(PlaneAlgorithm, FindsAllCornersOfAFlatFaceAtOnce) {
  for (const bool is_plane_first : {true, false}) {
    auto can = OnAPlane::of<btCylinderShapeZ>(is_plane_first, kHalf - 1e-4, kCylinder);
    can.world.world.performDiscreteCollisionDetection();
    EXPECT_EQ(can.world.points().size(), 4u);
    for (const btManifoldPoint* point : can.world.points()) {
      EXPECT_NEAR(static_cast<double>(point->getDistance()), -1e-4, 1e-5);
      EXPECT_NEAR(std::abs(static_cast<double>(point->m_normalWorldOnB.z())), 1.0, 1e-6);
    }
  }
}

TEST(PlaneAlgorithm, LetsACylinderThatLandsFlatStand) {
  for (const double rate : {1000.0, 200.0, 60.0}) {
    for (const double height : {0.1, 0.4}) {
      auto can = OnAPlane::of<btCylinderShapeZ>(true, kHalf + height, kCylinder);
      can.world.step(static_cast<int>(2.0 * rate), 1.0 / rate);
      const btVector3& place = can.body->getWorldTransform().getOrigin();
      EXPECT_LT(can.tilt(), 0.02) << rate << " " << height;
      EXPECT_NEAR(static_cast<double>(place.z()), kHalf, 1e-3) << rate << " " << height;
      EXPECT_LT(std::hypot(static_cast<double>(place.x()), static_cast<double>(place.y())), 5e-3)
          << rate << " " << height;
    }
  }
}

TEST(PlaneAlgorithm, LetsRoundSidesRoll) {
  auto can = OnAPlane::of<btCylinderShape>(
      true, kRadius, btVector3(scalar(kRadius), scalar(kHalf), scalar(kRadius)));
  constexpr double kSpeed = 1.0;
  can.body->setLinearVelocity(btVector3(scalar(kSpeed), 0, 0));
  can.body->setAngularVelocity(btVector3(0, scalar(kSpeed / kRadius), 0));
  can.world.step(60, 1.0 / 60.0);
  EXPECT_NEAR(static_cast<double>(can.body->getLinearVelocity().x()), kSpeed, 0.02);
}

}  // namespace
}  // namespace voxshell::bullet::plane_algorithm_test
