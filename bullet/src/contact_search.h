#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ball_contacts.h"
#include "cylinder_contacts.h"
#include "facing_normals.h"
#include "flat_elements.h"
#include "pair_step.h"
#include "round_contacts.h"
#include "round_field_contacts.h"
#include "second_shell.h"
#include "shape_features.h"
#include "swept_hits.h"
#include "triangle_contacts.h"
#include "voxshell/bullet/contact_settings.h"
#include "voxshell/contacts.h"

namespace voxshell::bullet {

/// Whether all points of a shell are wanted, or the deepest of each segment.
enum class Wanted { kAll, kOneASegment };

/// The level whose clusters are the segments of a step.
int level_of(const ContactSettings& settings, bool uses_ccd);

/// Looks for the points of a pair that may be contacts, and keeps what makes that quick while the
/// bodies stay near each other.
class ContactSearch {
 public:
  /// Finds the points within the margin, or the deepest of these of each segment. `step` is null in
  /// contact tests, which take contacts as sampled. Returns whether the roles of the pair were
  /// swapped for it.
  bool find_near(const ContactSettings& settings, PosedPair& pair, double margin,
                 const PairStep* step, Wanted wanted);

  /// Finds where contacts of the last search that have moved along touch now: places of
  /// round surfaces that roll, as the bodies turn.
  void follow(const PosedPair& pair);
  /// Whether follow() finds all of them. Those of features of Bullet's shapes it does not.
  bool can_follow() const { return features_.empty(); }

  /// Finds those of the pose at which triangles first touch the model within the step, by
  /// conservative advancement of the whole body: its first contact need not be where it is nearest
  /// now. Returns the fraction of the step that is over then.
  double find_on_the_way(const ContactSettings& settings, const PairStep& step);

  /// What was found, ascending by id; to be changed.
  std::vector<Contact>& contacts() { return contacts_; }
  /// The ids of those that are no samples, ascending.
  std::span<const std::uint32_t> exact() const { return exact_; }
  /// The ids of those that are in the other body at some time of the step, ascending.
  std::span<const std::uint32_t> hits() const { return hits_; }
  std::span<const Feature> features() const { return features_; }

 private:
  struct Question;
  struct PosedShell;
  /// What is kept of one of the two shells.
  struct OfShell {
    QueryScratch scratch;
    FlatElements flat;
    RoundContacts round;
    RoundFieldContacts on_round;
    SweptHits hits;
    std::vector<Contact> guards;

    /// The ids, ascending, of its contacts that are no samples.
    void gather_exact(std::vector<std::uint32_t>& exact) const;
  };

  static bool may_touch(const Question& question, const PosedPair& pair);
  void take_all(const Question& question, const PosedPair& pair, Opposition& opposition);
  static void find_samples(const Question& question, const PosedShell& posed, OfShell& of,
                           std::vector<Contact>& contacts);
  void take(const Question& question, const PosedShell& posed, OfShell& of,
            std::vector<Contact>& contacts, Opposition& opposition);
  static void part_from_guards(const Question& question, const PosedShell& posed,
                               std::vector<Contact>& contacts, std::vector<Contact>& guards);
  void drop_covered_by_each_other(const PosedShell& first, const PosedShell& second);
  void append_features(const Question& question, const PosedPair& pair);
  void append_inner(const PosedPair& pair, const PairStep* step, const Opposition& opposition);
  void append_way_out(const PairStep& step, const Opposition& opposition);

  OfShell first_;
  OfShell second_;
  SecondShell second_shell_;
  TriangleContacts triangle_contacts_;
  std::vector<Feature> features_;
  BallContacts balls_;
  CylinderContacts cylinder_;
  std::vector<Contact> contacts_;
  std::vector<Contact> second_found_;  ///< those of the second shell
  std::vector<std::uint32_t> exact_;
  std::vector<std::uint32_t> second_exact_;
  std::vector<Contact> moved_;  ///< room for those of follow()
  std::vector<std::uint32_t> hits_;
};

}  // namespace voxshell::bullet
