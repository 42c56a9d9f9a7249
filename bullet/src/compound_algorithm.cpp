#include "compound_algorithm.h"

#include <algorithm>
#include <new>
#include <typeinfo>

#include <BulletCollision/CollisionDispatch/btCompoundCompoundCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <LinearMath/btAabbUtil2.h>

#include "ball.h"
#include "motion.h"
#include "posed_pair.h"

namespace voxshell::bullet {
namespace {

struct Aabb {
  btVector3 lower;
  btVector3 upper;

  Aabb(const btCollisionShape& shape, const btTransform& world_from_shape, double reach) {
    shape.getAabb(world_from_shape, lower, upper);
    const auto around = static_cast<btScalar>(reach);
    lower -= btVector3(around, around, around);
    upper += btVector3(around, around, around);
  }

  /// Half of the shortest side, metres.
  double half_thickness() const {
    const btVector3 half = btScalar(0.5) * (upper - lower);
    return static_cast<double>(half[half.minAxis()]);
  }
};

bool has_model(const btCollisionShape& shape) {
  if (meeting_with(shape) == Meeting::kModel) return true;
  if (!shape.isCompound()) return false;
  const auto& compound = static_cast<const btCompoundShape&>(shape);
  for (int i = 0; i < compound.getNumChildShapes(); ++i) {
    if (has_model(*compound.getChildShape(i))) return true;
  }
  return false;
}

}  // namespace

void CompoundAlgorithm::processCollision(const btCollisionObjectWrapper* a,
                                         const btCollisionObjectWrapper* b,
                                         const btDispatcherInfo& info, btManifoldResult* result) {
  btCompoundCollisionAlgorithm::processCollision(a, b, info, result);
  const bool simulates = typeid(*result) == typeid(btManifoldResult);
  if (simulates)
    try_children_on_the_way(m_isSwapped ? *b : *a, m_isSwapped ? *a : *b, info, *result);
}

/// Those that Bullet has left out. Of a child that is slow beside its size, nothing is lost.
void CompoundAlgorithm::try_children_on_the_way(const btCollisionObjectWrapper& compound,
                                                const btCollisionObjectWrapper& other,
                                                const btDispatcherInfo& info,
                                                btManifoldResult& result) {
  constexpr double kOfThickness = 0.25;
  const auto time_step = static_cast<double>(info.m_timeStep);
  const Ball ball = std::min(Ball::about(compound), Ball::about(other),
                             [](const Ball& x, const Ball& y) { return x.radius < y.radius; });
  const double way =
      find_farthest_way(Motion::of(*compound.getCollisionObject(), time_step),
                        Motion::of(*other.getCollisionObject(), time_step), ball, time_step);
  const Aabb reached(*other.getCollisionShape(), other.getWorldTransform(), way);
  const auto& shape = *static_cast<const btCompoundShape*>(compound.getCollisionShape());
  for (int i = 0; i < shape.getNumChildShapes(); ++i) {
    if (m_childCollisionAlgorithms[i] != nullptr) continue;
    const btCollisionShape& child = *shape.getChildShape(i);
    const btTransform world_from_child = compound.getWorldTransform() * shape.getChildTransform(i);
    const Aabb aabb(child, world_from_child, 0.0);
    if (!(way > kOfThickness * aabb.half_thickness())) continue;
    if (!TestAabbAgainstAabb2(aabb.lower, aabb.upper, reached.lower, reached.upper)) continue;
    if (gCompoundChildShapePairCallback != nullptr &&
        !gCompoundChildShapePairCallback(other.getCollisionShape(), &child)) {
      continue;
    }
    const btCollisionObjectWrapper wrap(&compound, &child, compound.getCollisionObject(),
                                        world_from_child, -1, i);
    process_child(i, wrap, other, info, result);
  }
}

/// As Bullet does it. The algorithm is kept with those that it made; it drops what no longer
/// overlaps.
void CompoundAlgorithm::process_child(int index, const btCollisionObjectWrapper& child,
                                      const btCollisionObjectWrapper& other,
                                      const btDispatcherInfo& info, btManifoldResult& result) {
  btCollisionAlgorithm*& algorithm = m_childCollisionAlgorithms[index];
  algorithm =
      m_dispatcher->findAlgorithm(&child, &other, m_sharedManifold, BT_CONTACT_POINT_ALGORITHMS);
  const bool is_first = result.getBody0Internal() == child.getCollisionObject();
  const btCollisionObjectWrapper* const before =
      is_first ? result.getBody0Wrap() : result.getBody1Wrap();
  if (is_first) {
    result.setBody0Wrap(&child);
    result.setShapeIdentifiersA(-1, index);
  } else {
    result.setBody1Wrap(&child);
    result.setShapeIdentifiersB(-1, index);
  }
  algorithm->processCollision(&child, &other, info, &result);
  if (is_first) {
    result.setBody0Wrap(before);
  } else {
    result.setBody1Wrap(before);
  }
}

btCollisionAlgorithm* CompoundCreateFunc::CreateCollisionAlgorithm(
    btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* a,
    const btCollisionObjectWrapper* b) {
  if (has_model(*a->getCollisionShape()) || has_model(*b->getCollisionShape())) {
    void* memory = info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(CompoundAlgorithm));
    return new (memory) CompoundAlgorithm(info, a, b, m_swapped);
  }
  if (a->getCollisionShape()->isCompound() && b->getCollisionShape()->isCompound()) {
    return btCompoundCompoundCollisionAlgorithm::CreateFunc().CreateCollisionAlgorithm(info, a, b);
  }
  void* memory =
      info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(btCompoundCollisionAlgorithm));
  return new (memory) btCompoundCollisionAlgorithm(info, a, b, m_swapped);
}

}  // namespace voxshell::bullet
