#include "voxshell/bullet/sleepy_world.h"

namespace voxshell::bullet {
namespace {

/// Points on the body's axes, as a fraction of its radius, that stay while it rests. Larger: what
/// moves slowly freezes. Smaller: bodies that rock a little never sleep.
constexpr btScalar kMovedOfRadius = btScalar(0.005);

}  // namespace

bool has_moved(const btTransform& from, const btTransform& to, btScalar radius) {
  const btScalar most = kMovedOfRadius * radius;
  if ((to.getOrigin() - from.getOrigin()).length2() > most * most) return true;
  for (int axis = 0; axis < 3; ++axis) {
    const btVector3 turn = to.getBasis().getColumn(axis) - from.getBasis().getColumn(axis);
    if (turn.length2() > kMovedOfRadius * kMovedOfRadius) return true;
  }
  return false;
}

}  // namespace voxshell::bullet
