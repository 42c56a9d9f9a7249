#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include "ball_contacts.h"
#include "contact_rule.h"
#include "facing_normals.h"
#include "flat_elements.h"
#include "hull.h"
#include "round_contacts.h"
#include "round_field_contacts.h"
#include "second_shell.h"
#include "shape_features.h"
#include "triangle_contacts.h"
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

 private:
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
  enum class Wanted { kAll, kOneASegment };

  void renew_hull(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b);
  bool find_near(PosedPair& pair, double margin, const PairStep* step, Wanted wanted);
  void append_way_out(const PairStep& step, const Opposition& opposition);
  std::span<const Contact> ask(const Field& field, const PointShell& shell,
                               const Pose& field_from_shell, float reach, Wanted wanted,
                               QueryScratch& scratch) const;
  double find_on_the_way(const PairStep& step);
  int level() const;
  Segment segment_of(const PosedPair& pair, const Contact& contact) const;
  void report(const PosedPair& pair, btManifoldResult& result);
  void release_manifolds();
  void drop_idle_points(float band);
  void assign_manifolds(const PosedPair& pair, bool is_regular);
  void choose_points(const PairStep& step, bool is_regular);
  void fill(const PairStep& step, const StepContacts& of_step);
  btPersistentManifold* take_manifold(const PosedPair& pair);

  const ContactSettings& settings_;
  Purpose purpose_;
  std::shared_ptr<const Hull> hull_;
  std::optional<Vec3> hull_scaling_;  ///< of the shape that it is of, as last seen
  PairMemory memory_;
  QueryScratch scratch_;
  QueryScratch second_scratch_;
  SecondShell second_;
  FlatElements first_flat_;
  FlatElements second_flat_;
  RoundContacts first_round_;
  RoundContacts second_round_;
  RoundFieldContacts first_on_round_;
  RoundFieldContacts second_on_round_;
  bool uses_ccd_ = false;    ///< in this step
  bool shell_was_a_ = true;  ///< whose ids and segments active_ is by
  TriangleContacts triangle_contacts_;
  std::vector<Feature> features_;
  BallContacts balls_;
  std::vector<Contact> contacts_;            ///< of this step, ascending by id
  std::vector<std::uint32_t> exact_;         ///< ids, ascending, of those that are no samples
  std::vector<std::uint32_t> second_exact_;  ///< the same of the second shell
  std::vector<Contact> second_found_;        ///< those of the second shell
  std::vector<Contact> chosen_;              ///< those of contacts_ that are in manifolds
  std::vector<SegmentManifold> active_;      ///< ascending by segment; the manifolds with points
  std::vector<SegmentManifold> next_;        ///< the same, of this step
  std::vector<btPersistentManifold*> idle_;  ///< empty ones, kept for later steps
};

}  // namespace voxshell::bullet
