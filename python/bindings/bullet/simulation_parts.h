#pragma once

#include "bullet/simulation.h"
#include "voxshell/bullet/carried_contacts.h"
#include "voxshell/bullet/checked_motion.h"
#include "voxshell/bullet/force_aware_world.h"
#include "voxshell/bullet/kinematic_motion_world.h"
#include "voxshell/bullet/model_shape.h"
#include "voxshell/bullet/momentum_world.h"
#include "voxshell/bullet/parallel_dispatcher.h"
#include "voxshell/bullet/seamless_world.h"
#include "voxshell/bullet/sleepy_world.h"
#include "voxshell/bullet/taut_joints.h"

namespace voxshell::python {

/// A body in the simulation.
struct Simulation::Body {
  Pose body_from_geometry;
  BulletShape shape;
  btRigidBody rigid_body;
  Motion motion;
  BodyMaterial material;
  bool spins_fast = false;  ///< was reported by Simulation::take_fast_spins()
  bool moves_far = false;   ///< was reported by Simulation::take_long_ways()

  Body(const BodySettings& settings, const bullet::BodyFrame& frame);
};

/// A world of all that voxshell adds to Bullet's.
class Simulation::World
    : public bullet::SleepyWorld<bullet::TautJointsWorld<bullet::CheckedMotionWorld<
          bullet::MomentumWorld<bullet::ForceAwareWorld<bullet::SeamlessWorld<
              bullet::CarriedContactsWorld<bullet::KinematicMotionWorld<>>>>>>>> {
 public:
  using SleepyWorld::SleepyWorld;
};

/// A dispatcher that measures the time of the narrow phase.
class Simulation::TimedDispatcher : public bullet::ParallelDispatcher {
 public:
  using bullet::ParallelDispatcher::ParallelDispatcher;

  void dispatchAllCollisionPairs(btOverlappingPairCache* pairs, const btDispatcherInfo& info,
                                 btDispatcher* dispatcher) override;

  double seconds = 0.0;  ///< of the last dispatch
};

/// Filters the pairs of bodies that Bullet examines.
class Simulation::Filter : public btOverlapFilterCallback {
 public:
  explicit Filter(const Simulation& simulation) : simulation_(simulation) {}

  bool needBroadphaseCollision(btBroadphaseProxy* a, btBroadphaseProxy* b) const override {
    return simulation_.may_meet(*static_cast<btCollisionObject*>(a->m_clientObject),
                                *static_cast<btCollisionObject*>(b->m_clientObject));
  }

 private:
  const Simulation& simulation_;
};

}  // namespace voxshell::python
