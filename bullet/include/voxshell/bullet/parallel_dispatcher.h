#pragma once

#include <memory>
#include <vector>

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

namespace voxshell::bullet {

class Support;

/// A dispatcher that searches for the contacts of models on several threads. A SeamlessWorld
/// examines bodies at seams on as many. Use it in place of btCollisionDispatcher, with a
/// CollisionConfiguration. The calling thread puts the contacts into manifolds in the order of
/// Bullet's pairs, so a world has the same bits on any number of threads. Pairs without a model,
/// compounds and Bullet's triangle meshes are handled as before. It also tells pairs which bodies
/// contacts carry, so that what lies still needs no CCD at low rates, on one thread as well:
/// docs/decisions/0059-what-contacts-carry-does-not-fall.md.
/// gCalculateCombinedRestitutionCallback is called on these threads.
class ParallelDispatcher : public btCollisionDispatcher {
 public:
  /// @param threads  How many at most, the calling one included; 0: one for each core.
  explicit ParallelDispatcher(btCollisionConfiguration* configuration, unsigned threads = 0);
  ~ParallelDispatcher() override;

  void dispatchAllCollisionPairs(btOverlappingPairCache* pairs, const btDispatcherInfo& info,
                                 btDispatcher* dispatcher) override;

  /// How many are used at most, the calling one included.
  unsigned threads() const { return threads_; }
  /// Seconds that the last dispatch spent on several threads.
  double parallel_seconds() const { return parallel_seconds_; }
  /// What supported the bodies in the last step, from the start of a dispatch on.
  const Support& support() const { return *support_; }

 private:
  struct Job;
  void prepare(btOverlappingPairCache& pairs, const btDispatcherInfo& info);

  unsigned threads_;
  double parallel_seconds_ = 0.0;
  std::unique_ptr<Support> support_;
  std::vector<Job> jobs_;  ///< of the last dispatch
};

}  // namespace voxshell::bullet
