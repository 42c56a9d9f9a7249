#pragma once

#include <memory>

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>

namespace voxshell::bullet {

/// Corrects contacts where bodies lie flush, as the tiles of a floor do: a body that slides over
/// their seam must not notice it.
///
/// Collision detection looks at two bodies at a time, and to it the side of the next tile is a
/// wall. This looks at each contact of a body together with the other bodies that it touches. Where
/// two of them lie in one plane, a contact whose normal leans out of that plane gets the plane's
/// normal, or is removed where it leans by more than 45 degrees. Steps, corners and wide gaps stay
/// as they are. Serves models, Bullet's boxes, balls, capsules, cylinders, cones and planes, and
/// compounds of these. docs/decisions/0035-seams.md.
class Seams {
 public:
  Seams();
  ~Seams();
  Seams(const Seams&) = delete;
  Seams& operator=(const Seams&) = delete;

  /// Call it between collision detection and the solver. `time_step` in seconds. Bodies that touch
  /// only one other cost nothing.
  void correct(btDispatcher& dispatcher, double time_step);

 private:
  struct Scratch;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace voxshell::bullet
