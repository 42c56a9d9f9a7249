#pragma once

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace voxshell::bullet {

/// Contacts of bodies that turn into each other within a step.
///
/// The solver keeps to the planes of contacts as they are when a step begins, or when bodies will
/// touch. While a body turns, other places of it come to face the other body, and end the step in
/// it. They become contacts for the next solution, with the normals and levers of the step's end:
/// Newton's method for the condition that the bodies end the step outside of each other.
/// docs/decisions/0066-bodies-that-turn-into-each-other.md.
class StepEnd {
 public:
  /// Adds contacts to the manifolds of a pair that has some. The bodies are where the step begins,
  /// with the velocities that the solver found. Returns whether any were added.
  bool add_contacts(btCollisionAlgorithm& algorithm, btRigidBody& a, btRigidBody& b,
                    btCollisionDispatcher& dispatcher, const btDispatcherInfo& info);

 private:
  btManifoldArray manifolds_;
};

}  // namespace voxshell::bullet
