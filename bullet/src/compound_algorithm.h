#pragma once

#include <vector>

#include <BulletCollision/CollisionDispatch/btCompoundCollisionAlgorithm.h>

namespace voxshell::bullet {

/// Whether it is a model, or a compound that has one.
bool has_model(const btCollisionShape& shape);

/// Bullet's algorithm for compounds and other shapes, compounds as well, of which one is a model or
/// has models. Bullet tries children once their bounds overlap those of the other shape: too late
/// for those that pass through it in a step. Here, others that may get there are tried, too.
class CompoundAlgorithm : public btCompoundCollisionAlgorithm {
 public:
  using btCompoundCollisionAlgorithm::btCompoundCollisionAlgorithm;
  ~CompoundAlgorithm() override;
  CompoundAlgorithm(const CompoundAlgorithm&) = delete;
  CompoundAlgorithm& operator=(const CompoundAlgorithm&) = delete;

  void processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                        const btDispatcherInfo& info, btManifoldResult* result) override;
  void getAllContactManifolds(btManifoldArray& manifolds) override;

 private:
  /// A child that Bullet has not tried.
  struct OnTheWay {
    int child;
    btCollisionAlgorithm* algorithm;
  };

  void find_on_the_way(const btCollisionObjectWrapper& compound,
                       const btCollisionObjectWrapper& other, double farthest);
  void try_on_the_way(const btCollisionObjectWrapper& compound,
                      const btCollisionObjectWrapper& other, const btDispatcherInfo& info,
                      btManifoldResult& result);
  void release(const OnTheWay& entry);

  std::vector<int> children_;         ///< on the way in this step, ascending
  std::vector<OnTheWay> on_the_way_;  ///< ascending
  std::vector<OnTheWay> next_;
  btNodeStack stack_;  ///< for Bullet's tree
  int revision_ = -1;  ///< of the compound that these are of
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
