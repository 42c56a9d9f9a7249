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

bool has_model(const btCollisionShape& shape) {
  if (collision_method_of(shape) == CollisionMethod::kModel) return true;
  if (!shape.isCompound()) return false;
  const auto& compound = static_cast<const btCompoundShape&>(shape);
  for (int i = 0; i < compound.getNumChildShapes(); ++i) {
    if (has_model(*compound.getChildShape(i))) return true;
  }
  return false;
}

CompoundAlgorithm::~CompoundAlgorithm() {
  for (const OnTheWay& entry : on_the_way_) release(entry);
}

void CompoundAlgorithm::release(const OnTheWay& entry) {
  entry.algorithm->~btCollisionAlgorithm();
  m_dispatcher->freeCollisionAlgorithm(entry.algorithm);
}

void CompoundAlgorithm::getAllContactManifolds(btManifoldArray& manifolds) {
  btCompoundCollisionAlgorithm::getAllContactManifolds(manifolds);
  for (const OnTheWay& entry : on_the_way_) entry.algorithm->getAllContactManifolds(manifolds);
}

void CompoundAlgorithm::processCollision(const btCollisionObjectWrapper* a,
                                         const btCollisionObjectWrapper* b,
                                         const btDispatcherInfo& info, btManifoldResult* result) {
  btCompoundCollisionAlgorithm::processCollision(a, b, info, result);
  const bool simulates = typeid(*result) == typeid(btManifoldResult);
  if (!simulates) return;
  const btCollisionObjectWrapper& compound = m_isSwapped ? *b : *a;
  const btCollisionObjectWrapper& other = m_isSwapped ? *a : *b;
  const Ball ball = std::min(Ball::about(compound), Ball::about(other),
                             [](const Ball& x, const Ball& y) { return x.radius < y.radius; });
  const auto time_step = static_cast<double>(info.m_timeStep);
  const double farthest =
      find_farthest_if_stopped(Motion::of(*compound.getCollisionObject(), time_step),
                               Motion::of(*other.getCollisionObject(), time_step), ball, time_step);
  find_on_the_way(compound, other, farthest);
  try_on_the_way(compound, other, info, *result);
}

/// Fills children_ with those that Bullet has left out and whose bounds a displacement of this
/// length may bring to those of the other shape.
void CompoundAlgorithm::find_on_the_way(const btCollisionObjectWrapper& compound,
                                        const btCollisionObjectWrapper& other, double farthest) {
  children_.clear();
  const auto& shape = *static_cast<const btCompoundShape*>(compound.getCollisionShape());
  btVector3 lower;
  btVector3 upper;
  const btTransform compound_from_other =
      compound.getWorldTransform().inverse() * other.getWorldTransform();
  other.getCollisionShape()->getAabb(compound_from_other, lower, upper);
  const auto reach = static_cast<btScalar>(farthest);
  lower -= btVector3(reach, reach, reach);
  upper += btVector3(reach, reach, reach);
  const auto try_child = [&](int index) {
    if (m_childCollisionAlgorithms[index] != nullptr) return;
    const btCollisionShape* child = shape.getChildShape(index);
    btVector3 child_lower;
    btVector3 child_upper;
    child->getAabb(shape.getChildTransform(index), child_lower, child_upper);
    if (!TestAabbAgainstAabb2(child_lower, child_upper, lower, upper)) return;
    if (gCompoundChildShapePairCallback != nullptr &&
        !gCompoundChildShapePairCallback(other.getCollisionShape(), child)) {
      return;
    }
    children_.push_back(index);
  };
  if (const btDbvt* tree = shape.getDynamicAabbTree()) {
    struct Collector : btDbvt::ICollide {
      explicit Collector(const decltype(try_child)& each) : use(each) {}
      void Process(const btDbvtNode* leaf) override { use(leaf->dataAsInt); }
      const decltype(try_child)& use;
    } collector(try_child);
    tree->collideTVNoStackAlloc(tree->m_root, btDbvtVolume::FromMM(lower, upper), stack_,
                                collector);
    std::ranges::sort(children_);
  } else {
    for (int i = 0; i < shape.getNumChildShapes(); ++i) try_child(i);
  }
}

/// Their algorithms are kept from step to step while they are on the way.
void CompoundAlgorithm::try_on_the_way(const btCollisionObjectWrapper& compound,
                                       const btCollisionObjectWrapper& other,
                                       const btDispatcherInfo& info, btManifoldResult& result) {
  const auto& shape = *static_cast<const btCompoundShape*>(compound.getCollisionShape());
  const bool is_changed = revision_ != shape.getUpdateRevision();
  revision_ = shape.getUpdateRevision();
  next_.clear();
  auto known = on_the_way_.begin();
  for (const int index : children_) {
    for (; known != on_the_way_.end() && (is_changed || known->child < index); ++known) {
      release(*known);
    }
    const btTransform world_from_child =
        compound.getWorldTransform() * shape.getChildTransform(index);  // the wrapper refers to it
    const btCollisionObjectWrapper child(&compound, shape.getChildShape(index),
                                         compound.getCollisionObject(), world_from_child, -1,
                                         index);
    const bool is_known = known != on_the_way_.end() && known->child == index;
    next_.push_back({index, is_known ? (known++)->algorithm
                                     : m_dispatcher->findAlgorithm(&child, &other, m_sharedManifold,
                                                                   BT_CONTACT_POINT_ALGORITHMS)});
    // As Bullet does it.
    const bool is_first = result.getBody0Internal() == compound.getCollisionObject();
    const btCollisionObjectWrapper* const before =
        is_first ? result.getBody0Wrap() : result.getBody1Wrap();
    if (is_first) {
      result.setBody0Wrap(&child);
      result.setShapeIdentifiersA(-1, index);
    } else {
      result.setBody1Wrap(&child);
      result.setShapeIdentifiersB(-1, index);
    }
    next_.back().algorithm->processCollision(&child, &other, info, &result);
    if (is_first) {
      result.setBody0Wrap(before);
    } else {
      result.setBody1Wrap(before);
    }
  }
  for (; known != on_the_way_.end(); ++known) release(*known);
  on_the_way_.swap(next_);
}

btCollisionAlgorithm* CompoundCreateFunc::CreateCollisionAlgorithm(
    btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* a,
    const btCollisionObjectWrapper* b) {
  const bool are_compounds =
      a->getCollisionShape()->isCompound() && b->getCollisionShape()->isCompound();
  // Its filter of pairs of children is known to its own algorithm alone.
  const bool is_filtered = are_compounds && gCompoundCompoundChildShapePairCallback != nullptr;
  const bool has_models = has_model(*a->getCollisionShape()) || has_model(*b->getCollisionShape());
  if (has_models && !is_filtered) {
    void* memory = info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(CompoundAlgorithm));
    return new (memory) CompoundAlgorithm(info, a, b, m_swapped);
  }
  if (are_compounds) {
    return btCompoundCompoundCollisionAlgorithm::CreateFunc().CreateCollisionAlgorithm(info, a, b);
  }
  void* memory =
      info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(btCompoundCollisionAlgorithm));
  return new (memory) btCompoundCollisionAlgorithm(info, a, b, m_swapped);
}

}  // namespace voxshell::bullet
