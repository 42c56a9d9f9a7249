#pragma once

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionCreateFunc.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

namespace voxshell::bullet {

/// A cylinder, a cone or another of Bullet's convex shapes on a plane: several places of a flat
/// face's rim at once.
///
/// Bullet's own algorithm finds one place a step of what has no flat sides all around. A cylinder
/// that lands flat is pushed at one place of its rim, and tips over.
class PlaneAlgorithm : public btCollisionAlgorithm {
 public:
  PlaneAlgorithm(const btCollisionAlgorithmConstructionInfo& info,
                 const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b,
                 bool is_plane_first);
  ~PlaneAlgorithm() override;
  PlaneAlgorithm(const PlaneAlgorithm&) = delete;
  PlaneAlgorithm& operator=(const PlaneAlgorithm&) = delete;

  void processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                        const btDispatcherInfo& info, btManifoldResult* result) override;
  btScalar calculateTimeOfImpact(btCollisionObject*, btCollisionObject*, const btDispatcherInfo&,
                                 btManifoldResult*) override {
    return btScalar(1);
  }
  void getAllContactManifolds(btManifoldArray& manifolds) override;

  struct CreateFunc : btCollisionAlgorithmCreateFunc {
    explicit CreateFunc(bool is_plane_first) { m_swapped = is_plane_first; }
    btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                   const btCollisionObjectWrapper* a,
                                                   const btCollisionObjectWrapper* b) override;
  };

 private:
  btPersistentManifold* manifold_;
  bool is_plane_first_;
};

}  // namespace voxshell::bullet
