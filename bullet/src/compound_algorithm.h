#pragma once

#include <BulletCollision/CollisionDispatch/btCompoundCollisionAlgorithm.h>

namespace voxshell::bullet {

/// Bullet's algorithm for compounds and other shapes, compounds as well, of which one is a model or
/// has models. Bullet tries children once their bounds overlap those of the other shape: too late
/// for those that pass through it in a step.
class CompoundAlgorithm : public btCompoundCollisionAlgorithm {
 public:
  using btCompoundCollisionAlgorithm::btCompoundCollisionAlgorithm;

  void processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                        const btDispatcherInfo& info, btManifoldResult* result) override;

 private:
  void try_children_on_the_way(const btCollisionObjectWrapper& compound,
                               const btCollisionObjectWrapper& other, const btDispatcherInfo& info,
                               btManifoldResult& result);
  void process_child(int index, const btCollisionObjectWrapper& child,
                     const btCollisionObjectWrapper& other, const btDispatcherInfo& info,
                     btManifoldResult& result);
};

/// Makes them where models are concerned, else Bullet's own.
class CompoundCreateFunc : public btCollisionAlgorithmCreateFunc {
 public:
  explicit CompoundCreateFunc(bool compound_is_second) { m_swapped = compound_is_second; }

  btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                 const btCollisionObjectWrapper* a,
                                                 const btCollisionObjectWrapper* b) override;
};

}  // namespace voxshell::bullet
