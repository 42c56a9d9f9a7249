#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include "contact_rule.h"
#include "contact_search.h"
#include "hull.h"
#include "stage_clock.h"
#include "voxshell/bullet/contact_settings.h"
#include "voxshell/contacts.h"
#include "voxshell/manifold.h"

namespace voxshell::bullet {

/// What asks: the world's step, which keeps manifolds, or a contact test, which wants points at
/// once.
enum class Purpose { kSimulation, kContactTest };

/// Narrow phase of a ModelShape and a shape that it meets by a field, a shell or triangles. `hull`
/// is of the shape that is met by one, else null.
class ModelAlgorithm : public btCollisionAlgorithm {
 public:
  ModelAlgorithm(const btCollisionAlgorithmConstructionInfo& info, const ContactSettings& settings,
                 Purpose purpose, std::shared_ptr<const Hull> hull);
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

  /// Looks for the contacts of this step, which the next processCollision() of these objects then
  /// only puts into manifolds. It changes nothing outside of this algorithm, so several threads may
  /// prepare several pairs at once.
  ///
  /// @param clock  Where to add the time of its stages, or null.
  void prepare(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b,
               double time_step, StageClock* clock);
  /// Forgets what was prepared, for steps in which nobody calls processCollision().
  void drop_prepared() { is_prepared_ = false; }
  /// Whether the bodies were near each other in the last step.
  bool is_near() const { return near_ != nullptr; }
  /// Whether the bodies, as they move now, may come to be deeper in each other within the step than
  /// `depth`, meters; a quick look that finds no contacts.
  bool may_be_deep_on_the_way(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b,
                              double time_step, double depth) const;
  /// Whether the last step searched for contacts, which takes a while.
  bool has_searched() const;

 private:
  struct Prepared;
  struct Near;
  /// Whose contacts share a manifold.
  struct Segment {
    std::uint32_t index;
    std::uint64_t end;  ///< contacts from this id on are in others
  };
  struct SegmentManifold {
    std::uint32_t segment;
    btPersistentManifold* manifold;
    std::size_t contact_count;
    ManifoldPoints chosen{};
    double rolling_lever = 0.0;  ///< see to_world()
  };

  void renew_hull(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b);
  void test_contact(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b,
                    btManifoldResult& result);
  bool may_keep(const PairStep& step) const;
  bool touches(const PairStep& step) const;
  bool has_lost_support(const PairStep& step) const;
  double look(Prepared& prepared, double time_step, const Support* support, bool may_keep_contacts);
  void commit(const Prepared& prepared, StageClock& clock);
  static Segment segment_of(const PosedPair& pair, const Contact& contact, int level);
  static void report(const PosedPair& pair, std::span<const Contact> contacts,
                     btManifoldResult& result);
  void release_manifolds();
  void span_patches(const PairStep& step);
  std::size_t count_segments(const PairStep& step) const;
  void assign_manifolds(const PairStep& step, bool is_regular);
  void choose_points(const PairStep& step, bool keeps_contacts);
  void fill(const PairStep& step, const StepContacts& of_step);
  btPersistentManifold* take_manifold(const PosedPair& pair);

  const ContactSettings& settings_;
  Purpose purpose_;
  const Support* support_;  ///< of the world's bodies; null where the dispatcher does not tell
  std::shared_ptr<const Hull> hull_;
  std::optional<Vec3> hull_scaling_;  ///< of the shape that it is of, as last seen
  /// Null while the bodies are too far apart to touch.
  std::unique_ptr<Near> near_;
  bool is_prepared_ = false;                 ///< for the next processCollision()
  bool shell_was_a_ = true;                  ///< whose ids and segments active_ is by
  std::vector<Contact> chosen_;              ///< those that were found and are in manifolds
  std::vector<SegmentManifold> active_;      ///< ascending by segment; the manifolds with points
  std::vector<SegmentManifold> next_;        ///< the same, of this step
  std::vector<btPersistentManifold*> idle_;  ///< empty ones, kept for later steps
};

}  // namespace voxshell::bullet
