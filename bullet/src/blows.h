#pragma once

#include <span>
#include <vector>

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/NarrowPhaseCollision/btManifoldPoint.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace voxshell::bullet {

/// Of the smaller of two bodies, of which one may not move and does not count then, meters.
btScalar size_of(const btRigidBody& a, const btRigidBody& b);

/// Whether two bodies, as they move, pass a contact's gap within the step by more than a fraction
/// of the smaller one's size.
bool is_passed(const btRigidBody& a, const btRigidBody& b, const btManifoldPoint& point,
               btScalar time_step, double of_size);

/// Passes blows on from body to body in a step that is solved several times.
///
/// A ball that is hit flies into the next one within the step. The second blow begins with the
/// velocities that the first one left, and what it gives is not taken back: solved at once with
/// the first, two balls would be hit as one heavy ball. So each solution begins with the velocities
/// that the last one found in the islands in which bodies have rebounded, and contacts add to the
/// impulses that they have given. In these islands, bodies that part may come back: contacts that
/// held them while the next blow acts would add energy. Those that have come back rebound in the
/// solution after it.
class Blows {
 public:
  /// Forgets those of the last step, and lets bodies part that can rebound from each other. Bodies
  /// have the velocities from before the step.
  void begin(btDispatcher& dispatcher, btScalar time_step);
  /// Whether contacts are changed for the solution.
  bool has_changed() const { return !changed_.empty(); }
  /// Finds what contacts gave in islands in which one of the bodies `faster`, ascending by address,
  /// has rebounded. Bodies have the velocities that the solution began with.
  void find(btDispatcher& dispatcher, std::span<btRigidBody* const> faster, btScalar time_step);
  /// Gives contacts back what keep() changed, and returns whether bodies that had parted have come
  /// back through their gap. Bodies have the velocities that the solver found.
  bool restore(btScalar time_step);
  /// Keeps what find() found, and changes contacts for the next solution. Bodies have the
  /// velocities that the solver found.
  void keep(btDispatcher& dispatcher, btScalar time_step);
  /// Changes contacts for the last solution: nothing rebounds or passes its gap any more.
  void stop(btDispatcher& dispatcher);
  /// Whether blows are passed on in the body's island.
  bool reach(const btRigidBody& body) const;
  /// Gives contacts the impulses of all solutions, and back what keep() changed.
  void finish();

 private:
  /// What a contact gave its bodies, N s.
  struct Blow {
    btRigidBody* a;
    btRigidBody* b;
    btManifoldPoint* point;
    btScalar normal;
    btScalar lateral_1;
    btScalar lateral_2;
  };
  /// What a contact had before it was changed.
  struct Changed {
    const btRigidBody* a;
    const btRigidBody* b;
    btManifoldPoint* point;
    btScalar distance;
    btScalar restitution;
  };

  void let_return(const Blow& blow, btScalar time_step);
  void let_part(const btRigidBody& a, const btRigidBody& b, btManifoldPoint& point,
                btScalar time_step);
  void give_back();

  std::vector<int> islands_;  ///< with blows, ascending
  std::vector<Blow> found_;   ///< of the last solution
  std::vector<Blow> kept_;    ///< of those before
  std::vector<Changed> changed_;
};

}  // namespace voxshell::bullet
