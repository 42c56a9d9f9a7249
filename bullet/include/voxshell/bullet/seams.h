#pragma once

#include <memory>

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>

namespace voxshell::bullet {

/// Corrects contacts where bodies lie flush, as the tiles of a floor do: a body that slides over
/// their seam must not notice it.
///
/// To collision detection of pairs, the second tile's side is a wall. Here, the other bodies that
/// the sliding one touches are asked as well. A contact whose normal leans over the surface of such
/// a body, where the two surfaces go on in one plane, takes the normal of that plane; it is removed
/// where it leans by more than kTurnedCosine allows. Steps, corners and wide gaps stay as they are.
/// Models, Bullet's boxes, balls, capsules, cylinders, cones and planes, and compounds of these.
/// docs/decisions/0035-seams.md.
class Seams {
 public:
  Seams();
  ~Seams();
  Seams(const Seams&) = delete;
  Seams& operator=(const Seams&) = delete;

  /// For between collision detection and the solver. `time_step` in seconds. Costs nothing for
  /// bodies that touch only one other.
  void correct(btDispatcher& dispatcher, double time_step);

 private:
  struct Room;
  std::unique_ptr<Room> room_;  ///< kept from step to step, as settled steps take no memory
};

}  // namespace voxshell::bullet
