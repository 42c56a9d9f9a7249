#include "voxshell/bullet/taut_joints.h"

#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>

#include "solver_constants.h"
#include "support/world.h"
#include "voxshell/bullet/coulomb_solver.h"

namespace voxshell::bullet::taut_joints_test {
namespace {

using namespace test_support;

constexpr double kLink = 0.02;      // m
constexpr double kLinkMass = 5e-3;  // kg
constexpr int kLinks = 10;

enum class Kind { kPoint, kHinge, kAxes };

/// Links that hang from the world, with a weight. One gets a push.
template <class World>
class Chain {
 public:
  Chain(double weight, Kind kind) : kind_(kind) {
    btRigidBody* above = nullptr;
    for (int i = 0; i < kLinks; ++i) above = &hang(above, 0.1 * kLink, 0.5 * kLink, kLinkMass);
    links_[kLinks / 2]->setLinearVelocity(btVector3(scalar(0.1), 0, 0));
    weight_ = &hang(above, kLink, kLink, weight);
  }
  ~Chain() {
    for (const auto& joint : joints_) world_.world.removeConstraint(joint.get());
  }
  Chain(const Chain&) = delete;
  Chain& operator=(const Chain&) = delete;

  /// How far the weight has left its place, meters.
  double swing(double seconds, double rate) {
    const btVector3 start = weight_->getCenterOfMassPosition();
    world_.step(static_cast<int>(std::lround(seconds * rate)), 1.0 / rate);
    return static_cast<double>((weight_->getCenterOfMassPosition() - start).length());
  }
  bool has_its_inertia() const {
    btVector3 inertia;
    links_.front()->getCollisionShape()->calculateLocalInertia(scalar(kLinkMass), inertia);
    const btVector3 product = inertia * links_.front()->getInvInertiaDiagLocal();
    return (product - btVector3(1, 1, 1)).length() < scalar(1e-5);
  }

 private:
  btRigidBody& hang(btRigidBody* above, double half_width, double half_height, double mass) {
    const double top = next_;
    next_ -= 2.0 * half_height;
    btRigidBody& body = world_.add(
        world_.template make<btBoxShape>(to_bullet(Vec3{half_width, half_width, half_height})),
        mass, {{}, {0, 0, top - half_height}});
    body.setActivationState(DISABLE_DEACTIVATION);
    links_.push_back(&body);
    btRigidBody& parent = above == nullptr ? btTypedConstraint::getFixedBody() : *above;
    const btVector3 place_above =
        above == nullptr ? btVector3(0, 0, 0) : btVector3(0, 0, scalar(-0.5 * kLink));
    add_joint(parent, body, place_above, btVector3(0, 0, scalar(half_height)));
    return body;
  }
  void add_joint(btRigidBody& a, btRigidBody& b, const btVector3& in_a, const btVector3& in_b) {
    const btVector3 y(0, 1, 0);
    if (kind_ == Kind::kPoint) {
      joints_.push_back(std::make_unique<btPoint2PointConstraint>(a, b, in_a, in_b));
    } else if (kind_ == Kind::kHinge) {
      joints_.push_back(std::make_unique<btHingeConstraint>(a, b, in_a, in_b, y, y));
    } else {
      const btTransform frame_a(btMatrix3x3::getIdentity(), in_a);
      const btTransform frame_b(btMatrix3x3::getIdentity(), in_b);
      auto axes = std::make_unique<btGeneric6DofSpring2Constraint>(a, b, frame_a, frame_b);
      axes->setLimit(4, 1, -1);  // free about y
      joints_.push_back(std::move(axes));
    }
    feedback_.push_back(std::make_unique<btJointFeedback>());
    joints_.back()->setJointFeedback(feedback_.back().get());
    world_.world.addConstraint(joints_.back().get(), true);
  }

  Kind kind_;
  double next_ = 0.0;
  WorldOf<World, CoulombSolver> world_;
  std::vector<btRigidBody*> links_;
  btRigidBody* weight_ = nullptr;
  std::vector<std::unique_ptr<btTypedConstraint>> joints_;
  std::vector<std::unique_ptr<btJointFeedback>> feedback_;
};

/// With plain worlds the weights fall by meters.
TEST(TautJoints, HoldLightLinksUnderTension) {
  struct Case {
    double weight;
    double rate;
  };
  for (const Kind kind : {Kind::kPoint, Kind::kHinge, Kind::kAxes}) {
    for (const auto& [weight, rate] : {Case{0.3, 200}, Case{1.0, 200}, Case{0.05, 60}}) {
      SCOPED_TRACE(weight);
      Chain<TautJointsWorld<>> chain(weight, kind);
      EXPECT_LT(chain.swing(2.0, rate), 0.01);
      EXPECT_TRUE(chain.has_its_inertia());
    }
  }
  Chain<btDiscreteDynamicsWorld> plain(1.0, Kind::kHinge);
  EXPECT_GT(plain.swing(2.0, 200), 0.1);
}

TEST(TautJoints, LeaveWhatFollowsAsItIs) {
  Chain<TautJointsWorld<>> chain(0.02, Kind::kHinge);
  Chain<btDiscreteDynamicsWorld> plain(0.02, Kind::kHinge);
  EXPECT_EQ(chain.swing(1.0, 1000), plain.swing(1.0, 1000));
}

TEST(TautJoints, RaiseInertiaAboutAxesAcrossThePullAlone) {
  WorldOf<btDiscreteDynamicsWorld, CoulombSolver> world;
  btRigidBody& body = world.add(world.make<btSphereShape>(scalar(0.01)), kLinkMass);
  btPoint2PointConstraint joint(body, btVector3(0, 0, scalar(kLink)));
  btJointFeedback feedback{};
  feedback.m_appliedForceBodyA = btVector3(0, 0, 100);
  btAlignedObjectArray<btTypedConstraint*> joints;
  joints.push_back(&joint);
  const btVector3 own = body.getInvInertiaDiagLocal();
  TautJoints taut;
  taut.begin(joints, scalar(0.005));
  EXPECT_EQ(body.getInvInertiaDiagLocal(), own) << "without feedback";
  taut.end();
  joint.setJointFeedback(&feedback);
  taut.begin(joints, scalar(0.005));
  const double inertia = kFollowedStiffness * 0.005 * 0.005 * 100.0 * kLink;
  EXPECT_NEAR(body.getInvInertiaDiagLocal().x() * scalar(inertia), 1, 1e-5);
  EXPECT_NEAR(body.getInvInertiaDiagLocal().y() * scalar(inertia), 1, 1e-5);
  EXPECT_EQ(body.getInvInertiaDiagLocal().z(), own.z());
  EXPECT_NEAR(body.getInvInertiaTensorWorld()[0][0] * scalar(inertia), 1, 1e-5);
  taut.end();
  EXPECT_EQ(body.getInvInertiaDiagLocal(), own);
  // Pressed, it buckles, but does not swing.
  feedback.m_appliedForceBodyA = btVector3(0, 0, -100);
  taut.begin(joints, scalar(0.005));
  EXPECT_EQ(body.getInvInertiaDiagLocal(), own);
  taut.end();
}

}  // namespace
}  // namespace voxshell::bullet::taut_joints_test
