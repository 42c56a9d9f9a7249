#include "plane_algorithm.h"

#include <array>
#include <new>

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/CollisionShapes/btConvexShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>

#include "contact_constants.h"

namespace voxshell::bullet {
namespace {

/// Ways along a plane, a right angle apart and halfway between.
constexpr std::array<std::array<btScalar, 2>, 8> kWays{
    {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1}, {1, -1}, {-1, 1}}};

/// Calls visit(place) for the places of a shape that are lowest if it is turned a little: the
/// corners of a face that lies flat, and the ends of an edge that does. A round side has another
/// such place for each angle, which would stop it from rolling. The shape's frame.
template <class Visit>
void visit_lowest(const btConvexShape& shape, const btVector3& down, const Visit& visit) {
  visit(shape.localGetSupportingVertex(down));
  if (shape.getShapeType() == SPHERE_SHAPE_PROXYTYPE) return;
  const btScalar same = static_cast<btScalar>(kSameOfRadius) * shape.getAngularMotionDisc();
  btVector3 right;
  btVector3 ahead;
  btPlaneSpace1(down, right, ahead);
  for (const auto& [of_right, of_ahead] : kWays) {
    const btVector3 way = of_right * right + of_ahead * ahead;
    const auto turned = [&](double by) {
      return shape.localGetSupportingVertex(down + static_cast<btScalar>(by) * way);
    };
    const btVector3 corner = turned(kTurnOfFlat);
    visit(corner);
    const btVector3 far = turned(kTurnOfLanding);
    // The edges of some shapes are rounded off by their margins: the corner is truer.
    if ((far - corner).length() <= same) continue;
    if ((far - turned(0.5 * kTurnOfLanding)).length() <= same) visit(far);
  }
}

}  // namespace

PlaneAlgorithm::PlaneAlgorithm(const btCollisionAlgorithmConstructionInfo& info,
                               const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b,
                               bool is_plane_first)
    : btCollisionAlgorithm(info),
      manifold_(m_dispatcher->getNewManifold((is_plane_first ? b : a).getCollisionObject(),
                                             (is_plane_first ? a : b).getCollisionObject())),
      is_plane_first_(is_plane_first) {}

PlaneAlgorithm::~PlaneAlgorithm() { m_dispatcher->releaseManifold(manifold_); }

void PlaneAlgorithm::processCollision(const btCollisionObjectWrapper* a,
                                      const btCollisionObjectWrapper* b, const btDispatcherInfo&,
                                      btManifoldResult* result) {
  const btCollisionObjectWrapper& of_convex = is_plane_first_ ? *b : *a;
  const btCollisionObjectWrapper& of_plane = is_plane_first_ ? *a : *b;
  const auto& convex = static_cast<const btConvexShape&>(*of_convex.getCollisionShape());
  const auto& plane = static_cast<const btStaticPlaneShape&>(*of_plane.getCollisionShape());
  const btTransform& world_from_convex = of_convex.getWorldTransform();
  const btTransform& world_from_plane = of_plane.getWorldTransform();
  const btVector3 normal = world_from_plane.getBasis() * plane.getPlaneNormal();
  const btScalar height = normal.dot(world_from_plane.getOrigin()) + plane.getPlaneConstant();
  const btScalar reach =
      manifold_->getContactBreakingThreshold() + result->m_closestPointDistanceThreshold;
  result->setPersistentManifold(manifold_);
  const auto add = [&](const btVector3& place) {
    const btVector3 at = world_from_convex * place;
    const btScalar distance = normal.dot(at) - height;
    if (distance >= reach) return;
    result->addContactPoint(normal, at - distance * normal, distance);
  };
  visit_lowest(convex, -normal * world_from_convex.getBasis(), add);
  if (manifold_->getNumContacts() > 0) result->refreshContactPoints();
}

void PlaneAlgorithm::getAllContactManifolds(btManifoldArray& manifolds) {
  manifolds.push_back(manifold_);
}

btCollisionAlgorithm* PlaneAlgorithm::CreateFunc::CreateCollisionAlgorithm(
    btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* a,
    const btCollisionObjectWrapper* b) {
  void* memory = info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(PlaneAlgorithm));
  return new (memory) PlaneAlgorithm(info, *a, *b, m_swapped);
}

}  // namespace voxshell::bullet
