#pragma once

#include <memory>

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>

namespace voxshell::bullet {

/// Corrects contacts where bodies are flush, such as the tiles of a floor, so that a body that
/// slides over their seam does not notice it.
///
/// Collision detection examines two bodies at a time and sees the side of the next tile as a wall.
/// This class examines each contact of a body together with the other bodies that it touches. If
/// two of them lie in one plane, a contact whose normal leans out of that plane gets the plane's
/// normal, or is removed if it leans by more than 45 degrees. Steps, corners and wide gaps stay as
/// they are. Supports models, Bullet's boxes, balls, capsules, cylinders, cones and planes, and
/// compounds of these. docs/decisions/0035-seams.md.
class Seams {
 public:
  Seams();
  ~Seams();
  Seams(const Seams&) = delete;
  Seams& operator=(const Seams&) = delete;

  /// Call it between collision detection and the solver. `time_step` in seconds. Bodies that touch
  /// only one other body cost nothing.
  void correct(btDispatcher& dispatcher, double time_step);

 private:
  struct Scratch;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace voxshell::bullet
