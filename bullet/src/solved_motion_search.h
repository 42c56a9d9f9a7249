#pragma once

#include <span>
#include <vector>

#include <BulletCollision/BroadphaseCollision/btBroadphaseInterface.h>
#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace voxshell::bullet {

/// Looks for contacts along the motion that the solver has found, of bodies that it made fast.
///
/// The narrow phase fills manifolds of pairs that had no contact. Pairs that have some keep them,
/// for the solver has used them: what else there is goes into manifolds of other algorithms. A bin
/// of one piece is such a pair with what falls into it: a body that one of its walls throws back
/// meets another one.
class SolvedMotionSearch {
 public:
  SolvedMotionSearch() = default;
  ~SolvedMotionSearch();
  SolvedMotionSearch(const SolvedMotionSearch&) = delete;
  SolvedMotionSearch& operator=(const SolvedMotionSearch&) = delete;

  /// Returns whether there are contacts that the solver has not known. Bodies are where the step
  /// begins, with the velocities that it found, and have no forces.
  ///
  /// @param faster      In the world's order.
  /// @param by_address  The same, ascending by address.
  bool find(std::span<btRigidBody* const> faster, std::span<btRigidBody* const> by_address,
            btBroadphaseInterface& broadphase, btCollisionDispatcher& dispatcher,
            const btDispatcherInfo& info);

  /// Forgets further contacts of pairs that have some.
  void drop_added();

 private:
  class Callback;
  /// Further contacts of a pair.
  struct Added {
    const btCollisionObject* a;
    const btCollisionObject* b;
    btCollisionAlgorithm* algorithm;
  };

  std::vector<Added> added_;
  btDispatcher* added_of_ = nullptr;  ///< whose they are
};

}  // namespace voxshell::bullet
