#include <cmath>
#include <map>
#include <set>
#include <stdexcept>

#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <gtest/gtest.h>

#include "support/models.h"
#include "support/random.h"
#include "support/world.h"

namespace voxshell::bullet::callbacks_test {
namespace {

using namespace test_support;
using voxshell::test_support::Random;

/// Records Bullet's global callbacks while it lives; one at a time.
class Listener {
 public:
  Listener() {
    gContactAddedCallback = [](btManifoldPoint& point, const btCollisionObjectWrapper* wrap0, int,
                               int index0, const btCollisionObjectWrapper*, int, int) {
      ++current().added;
      EXPECT_EQ(index0, point.m_index0);
      current().added_objects.insert(wrap0->getCollisionObject());
      if (point.m_userPersistentData == nullptr) {
        point.m_userPersistentData = new int(index0);
        current().live.insert(point.m_userPersistentData);
        ++current().made;
      }
      return true;
    };
    gContactDestroyedCallback = [](void* data) {
      ++current().destroyed;
      EXPECT_EQ(current().live.erase(data), 1u) << "destroyed twice, or never made";
      delete static_cast<int*>(data);
      return true;
    };
    gContactProcessedCallback = [](btManifoldPoint& point, void* body0, void* body1) {
      ++current().processed;
      EXPECT_NE(body0, body1);
      EXPECT_TRUE(std::isfinite(point.getDistance()));
      return true;
    };
    gContactStartedCallback = [](btPersistentManifold* const& manifold) {
      EXPECT_TRUE(current().touching.insert(manifold).second);
      EXPECT_GT(manifold->getNumContacts(), 0);
      ++current().started;
    };
    gContactEndedCallback = [](btPersistentManifold* const& manifold) {
      EXPECT_EQ(current().touching.erase(manifold), 1u);
      ++current().ended;
    };
    current_ = this;
  }
  ~Listener() {
    gContactAddedCallback = nullptr;
    gContactDestroyedCallback = nullptr;
    gContactProcessedCallback = nullptr;
    gContactStartedCallback = nullptr;
    gContactEndedCallback = nullptr;
    current_ = nullptr;
  }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  int added = 0;
  int made = 0;
  int destroyed = 0;
  int processed = 0;
  int started = 0;
  int ended = 0;
  std::set<void*> live;
  std::set<const btPersistentManifold*> touching;
  std::set<const btCollisionObject*> added_objects;

 private:
  static Listener& current() { return *current_; }
  static inline Listener* current_ = nullptr;
};

void want_callbacks(btRigidBody& body) {
  body.setCollisionFlags(body.getCollisionFlags() | btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK);
}

class Callbacks : public testing::TestWithParam<ContactMode> {};

INSTANTIATE_TEST_SUITE_P(Modes, Callbacks,
                         testing::Values(ContactMode::kRegular, ContactMode::kSegmented));

TEST_P(Callbacks, UserDataIsNeitherLeakedNorDestroyedTwice) {
  for (const bool compound : {false, true}) {
    Listener listener;
    {
      TestWorld world({.mode = GetParam()});
      btRigidBody& slab = world.add_model(slab_model(), 0);
      slab.setFriction(1);
      btCollisionShape* shape = &world.make<ModelShape>(blob_model());
      if (compound) {
        auto& whole = world.make<btCompoundShape>();
        whole.addChildShape(btTransform::getIdentity(), shape);
        shape = &whole;
      }
      btRigidBody& blob = world.add(*shape, 1, {{}, {0, 0, 0.2}});
      blob.setFriction(1);
      blob.setRestitution(scalar(0.7));
      slab.setRestitution(1);
      blob.setAngularVelocity(btVector3(3, 2, 1));
      want_callbacks(blob);
      world.step(400);
      EXPECT_GT(listener.made, 20);
      EXPECT_GT(listener.destroyed, 10);
      EXPECT_EQ(static_cast<std::size_t>(listener.made - listener.destroyed), listener.live.size());
      EXPECT_EQ(listener.live.size(), world.points().size());
      std::set<const btPersistentManifold*> filled;
      for (int i = 0; i < world.dispatcher.getNumManifolds(); ++i) {
        const btPersistentManifold* manifold = world.dispatcher.getManifoldByIndexInternal(i);
        if (manifold->getNumContacts() > 0) filled.insert(manifold);
      }
      EXPECT_EQ(listener.touching, filled);
      EXPECT_LE(filled.size(), GetParam() == ContactMode::kRegular ? 1u : world.points().size());
    }
    EXPECT_EQ(listener.made, listener.destroyed);
    EXPECT_EQ(listener.started, listener.ended);
    EXPECT_GT(listener.started, 1);
  }
}

// Refilling a manifold used to tell that contact had ended, in every step, and never that it had
// started.
TEST_P(Callbacks, ContactStartsOnceAndEndsOnce) {
  Listener listener;
  TestWorld world({.mode = GetParam(), .level = 1});
  world.add_model(slab_model(), 0);
  btRigidBody& ball = world.add_model(ball_model(), 1, {{}, {0, 0, 0.099}});
  for (int i = 0; i < 10; ++i) world.world.performDiscreteCollisionDetection();
  EXPECT_EQ(listener.started, 1);
  EXPECT_EQ(listener.ended, 0);
  EXPECT_GE(listener.processed, 10);
  EXPECT_EQ(listener.added, 0);  // nobody asked for custom materials
  ball.setWorldTransform(to_bullet(Pose{{}, {0, 0, 0.105}}));
  world.world.performDiscreteCollisionDetection();
  EXPECT_EQ(listener.started, 1);
  EXPECT_EQ(listener.ended, 1);
}

TEST_P(Callbacks, AnAddedCallbackMayChangeTheMaterial) {
  gContactAddedCallback = [](btManifoldPoint& point, const btCollisionObjectWrapper*, int, int,
                             const btCollisionObjectWrapper*, int, int) {
    point.m_combinedFriction = btScalar(0.125);
    return true;
  };
  for (const bool on_first : {true, false}) {
    TestWorld world({.mode = GetParam()});
    btRigidBody& slab = world.add_model(slab_model(), 0);
    btRigidBody& ball = world.add_model(ball_model(), 1, {{}, {0, 0, 0.099}});
    want_callbacks(on_first ? slab : ball);
    world.world.performDiscreteCollisionDetection();
    ASSERT_FALSE(world.points().empty());
    for (const btManifoldPoint* point : world.points()) {
      EXPECT_EQ(point->m_combinedFriction, btScalar(0.125));
    }
  }
  gContactAddedCallback = nullptr;
}

TEST_P(Callbacks, MaterialsCombineAsBulletsDo) {
  TestWorld world({.mode = GetParam()});
  btRigidBody& slab = world.add_model(slab_model(), 0);
  btRigidBody& ball = world.add_model(ball_model(), 1, {{}, {0, 0, 0.099}});
  slab.setFriction(scalar(0.5));
  ball.setFriction(scalar(0.6));
  slab.setRestitution(scalar(0.7));
  ball.setRestitution(scalar(0.8));
  slab.setRollingFriction(scalar(0.1));
  ball.setRollingFriction(scalar(0.2));
  slab.setSpinningFriction(scalar(0.3));
  ball.setSpinningFriction(scalar(0.4));
  ball.setContactStiffnessAndDamping(1000, 10);
  world.world.performDiscreteCollisionDetection();
  ASSERT_FALSE(world.points().empty());
  for (const btManifoldPoint* point : world.points()) {
    EXPECT_NEAR(point->m_combinedFriction, 0.3, 1e-6);
    EXPECT_NEAR(point->m_combinedRestitution, 0.56, 1e-6);
    EXPECT_NEAR(point->m_combinedRollingFriction, 0.1 * 0.6 + 0.2 * 0.5, 1e-6);
    EXPECT_NEAR(point->m_combinedSpinningFriction, 0.3 * 0.6 + 0.4 * 0.5, 1e-6);
    EXPECT_NE(point->m_contactPointFlags & BT_CONTACT_FLAG_CONTACT_STIFFNESS_DAMPING, 0);
    EXPECT_NEAR(point->m_combinedContactStiffness1,
                btManifoldResult::calculateCombinedContactStiffness(&slab, &ball), 1e-6);
    EXPECT_NEAR(point->m_combinedContactDamping1,
                btManifoldResult::calculateCombinedContactDamping(&slab, &ball), 1e-6);
    EXPECT_NEAR(point->m_lateralFrictionDir1.dot(point->m_normalWorldOnB), 0, 1e-6);
    EXPECT_NEAR(point->m_lateralFrictionDir2.dot(point->m_normalWorldOnB), 0, 1e-6);
  }
}

// The static rules were called, whatever the user had put in Bullet's pointers.
TEST_P(Callbacks, TheUsersOwnRuleForFrictionHolds) {
  const auto before = gCalculateCombinedFrictionCallback;
  gCalculateCombinedFrictionCallback = [](const btCollisionObject*, const btCollisionObject*) {
    return btScalar(0.0625);
  };
  TestWorld world({.mode = GetParam()});
  world.add_model(slab_model(), 0);
  world.add_model(ball_model(), 1, {{}, {0, 0, 0.099}});
  world.world.performDiscreteCollisionDetection();
  gCalculateCombinedFrictionCallback = before;
  ASSERT_FALSE(world.points().empty());
  for (const btManifoldPoint* point : world.points()) {
    EXPECT_EQ(point->m_combinedFriction, btScalar(0.0625));
  }
}

TEST_P(Callbacks, ImpulsesFollowTheirPointsThoughThesChangePlaces) {
  Random random(31);
  TestWorld world({.mode = GetParam()});
  world.add_model(slab_model(), 0);
  btRigidBody& blob = world.add_model(blob_model(), 1);
  int carried = 0;
  int fresh = 0;
  int moved = 0;
  Pose pose{random.rotation(), {0, 0, 0.08}};
  std::map<int, std::pair<int, int>> before;  // by id: manifold and place
  for (int i = 0; i < 400; ++i) {
    pose = Pose{{}, random.in_cube(0.0005)} * pose;
    const double a = random.uniform(-0.01, 0.01);
    const Pose turn{{{1, 0, 0}, {0, std::cos(a), -std::sin(a)}, {0, std::sin(a), std::cos(a)}}, {}};
    pose = pose * turn;
    pose.translation.z = 0.08;
    blob.setWorldTransform(to_bullet(pose));
    world.world.performDiscreteCollisionDetection();
    std::map<int, std::pair<int, int>> now;
    for (int m = 0; m < world.dispatcher.getNumManifolds(); ++m) {
      btPersistentManifold& manifold = *world.dispatcher.getManifoldByIndexInternal(m);
      for (int k = 0; k < manifold.getNumContacts(); ++k) {
        btManifoldPoint& point = manifold.getContactPoint(k);
        const int id = point.m_index0;
        EXPECT_TRUE(now.try_emplace(id, m, k).second) << "an id twice";
        const auto old = before.find(id);
        if (old != before.end()) {
          ++carried;
          moved += old->second != std::pair(m, k);
          // At rest, more: the solver starts from this fraction of it.
          const auto impulse = static_cast<btScalar>(id + 1);
          const btScalar at_rest = impulse / btContactSolverInfo().m_warmstartingFactor;
          EXPECT_TRUE(point.m_appliedImpulse == impulse || point.m_appliedImpulse == at_rest)
              << point.m_appliedImpulse;
          EXPECT_EQ(point.m_appliedImpulseLateral1, static_cast<btScalar>(id + 2));
          EXPECT_EQ(point.m_appliedImpulseLateral2, static_cast<btScalar>(id + 3));
          EXPECT_GT(point.getLifeTime(), 0);
        } else {
          ++fresh;
          EXPECT_EQ(point.m_appliedImpulse, btScalar(0));
          EXPECT_EQ(point.getLifeTime(), 0);
        }
        point.m_appliedImpulse = static_cast<btScalar>(id + 1);
        point.m_appliedImpulseLateral1 = static_cast<btScalar>(id + 2);
        point.m_appliedImpulseLateral2 = static_cast<btScalar>(id + 3);
      }
    }
    before = now;
  }
  EXPECT_GT(carried, 200);
  EXPECT_GT(fresh, 20);
  EXPECT_GE(moved, GetParam() == ContactMode::kRegular ? 1 : 0);
}

/// Bullet's own callback for the restitution of a pair, put back at the end.
class ThrowingRestitution {
 public:
  ThrowingRestitution() : before_(gCalculateCombinedRestitutionCallback) {
    gCalculateCombinedRestitutionCallback = [](const btCollisionObject*,
                                               const btCollisionObject*) -> btScalar {
      throw std::runtime_error("no restitution");
    };
  }
  ~ThrowingRestitution() { gCalculateCombinedRestitutionCallback = before_; }
  ThrowingRestitution(const ThrowingRestitution&) = delete;
  ThrowingRestitution& operator=(const ThrowingRestitution&) = delete;

 private:
  CalculateCombinedCallback before_;
};

TEST(Callbacks, ThatThrowLeaveNothingToTheNextStep) {
  TestWorld world;
  world.add_model(slab_model(), 0);
  btRigidBody& cube = world.add_model(cube_model(), 1, {{}, {0, 0, kCubeHalf + 0.02}});
  world.step(40);
  {
    const ThrowingRestitution throwing;
    EXPECT_THROW(world.step(1), std::runtime_error);
  }
  world.step(200);
  EXPECT_NEAR(height(cube), kCubeHalf, 1e-3);
}

}  // namespace
}  // namespace voxshell::bullet::callbacks_test
