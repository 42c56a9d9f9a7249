#pragma once

#include <cstdint>
#include <vector>

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionCreateFunc.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include "contact_manifold.h"
#include "voxshell/bullet/contact_settings.h"
#include "voxshell/contacts.h"
#include "voxshell/pair.h"

namespace voxshell::bullet {

/// What asks: the world's step, which keeps manifolds, or a contact test, which wants points at
/// once.
enum class Purpose { kSimulation, kContactTest };

/// Narrow phase of a pair in which at least one shape is a ModelShape.
class ModelAlgorithm : public btCollisionAlgorithm {
 public:
  ModelAlgorithm(const btCollisionAlgorithmConstructionInfo& info, const ContactSettings& settings,
                 Purpose purpose);
  ~ModelAlgorithm() override;
  ModelAlgorithm(const ModelAlgorithm&) = delete;
  ModelAlgorithm& operator=(const ModelAlgorithm&) = delete;

  void processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                        const btDispatcherInfo& info, btManifoldResult* result) override;
  btScalar calculateTimeOfImpact(btCollisionObject*, btCollisionObject*, const btDispatcherInfo&,
                                 btManifoldResult*) override {
    return btScalar(1);
  }
  void getAllContactManifolds(btManifoldArray& manifolds) override;

 private:
  struct SegmentManifold {
    std::uint32_t segment;
    btPersistentManifold* manifold;
  };
  struct PosedPair;

  double rest_margin(const PosedPair& pair) const;
  void drop_fast_approaches(const PosedPair& pair, double margin, double time_step);
  void report(const PosedPair& pair, btManifoldResult& result);
  void release_manifolds();
  void fill_regular(const PosedPair& pair);
  void fill_segmented(const PosedPair& pair, const PointSphereTree& tree);
  btPersistentManifold* take_manifold(const PosedPair& pair);

  const ContactSettings& settings_;
  Purpose purpose_;
  QueryScratch scratch_;
  bool shell_was_a_ = true;              ///< whose ids and segments active_ is by
  std::vector<Contact> contacts_;        ///< of this step, without those that are still too fast
  std::vector<std::uint32_t> deepest_;   ///< indices into contacts_, one a segment
  std::vector<SegmentManifold> active_;  ///< ascending by segment; the manifolds with points
  std::vector<SegmentManifold> next_;    ///< the same, of this step
  std::vector<btPersistentManifold*> idle_;  ///< empty ones, kept for later steps
};

/// Makes ModelAlgorithms for the dispatcher.
class ModelAlgorithmCreateFunc : public btCollisionAlgorithmCreateFunc {
 public:
  ModelAlgorithmCreateFunc(const ContactSettings& settings, Purpose purpose)
      : settings_(settings), purpose_(purpose) {}

  btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                 const btCollisionObjectWrapper* a,
                                                 const btCollisionObjectWrapper* b) override;

 private:
  const ContactSettings& settings_;
  Purpose purpose_;
};

}  // namespace voxshell::bullet
