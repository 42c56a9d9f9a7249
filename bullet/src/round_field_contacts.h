#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "failed_slides.h"
#include "flat_elements.h"
#include "pair_step.h"
#include "places_at_rest.h"
#include "round_side.h"
#include "shape_features.h"
#include "smooth_field.h"
#include "voxshell/contacts.h"
#include "voxshell/model.h"

namespace voxshell::bullet {

/// Contacts of a shell with a round body, the field, of which the shell's elements are samples:
/// slides them along the shell's straight edges and flat faces to where they are deepest, and gives
/// them the normal that both surfaces have in common there. Decision 36.
class RoundFieldContacts {
 public:
  /// @param contacts          Of `model`'s shell in the field, ascending by id; changed.
  /// @param other             The field's body, round or not; outlives the step.
  /// @param field_from_shell  Pose of the shell's frame in the field's.
  /// @param turning           Of the shell's body: samples that may touch, once it has turned,
  /// before the place that they slide to does, stay where they are, also in drop_covered().
  /// @param turning_of_field  The same of the field's body, for its samples in drop_covered().
  void slide(std::vector<Contact>& contacts, const Model& model, const Side& other,
             const Pose& field_from_shell, const TouchScale& scale, const Turning& turning,
             const Turning& turning_of_field);

  /// Finds where the contacts of the last slide() are now; see RoundContacts::follow().
  void follow(std::span<const Contact> kept, std::uint32_t first_id, const Side& other,
              const Pose& field_from_shell, std::vector<Contact>& moved);

  /// Slides those on rims of Bullet's shapes along these, and drops those that are of the same
  /// place as another or as a contact of the last slide().
  /// @param exact  To which the ids of those that have slid are added.
  void slide_features(std::vector<Contact>& contacts, std::span<Feature> features,
                      std::vector<std::uint32_t>& exact);

  /// Drops those of `contacts` that are samples and lie behind a contact of the last slide(), where
  /// the round body's surface leads from them to that. They are of the shell or, with
  /// `are_of_field`, of the field's body.
  void drop_covered(std::vector<Contact>& contacts, bool are_of_field,
                    std::span<const std::uint32_t> exact);

  /// Appends the ids of the contacts of the last slide(), ascending, each plus `first`.
  void append_ids(std::uint32_t first, std::vector<std::uint32_t>& ids) const;

 private:
  /// Where a contact is at rest. The frame of the shell, but for `on_round`.
  struct Touch {
    Vec3 position;  ///< on the shell's body
    Vec3 outwards;  ///< of the shell's body there, unit length
    double depth;
    RoundSide::Place on_round;
    bool is_on_edge;
    Vec3 along;  ///< the edge, unit length
    Vec3 mean;   ///< of the normals of its faces
  };

  std::optional<Touch> on_edge(const RoundSide& round, const Vec3& point, const Vec3& along,
                               const Vec3& mean, double within);
  std::optional<Touch> on_face(const RoundSide& round, const Vec3& point, const Vec3& outwards);
  bool slide_one(const RoundSide& round, Contact& contact);
  std::optional<RoundSide::Place> nearest_on(const RoundSide& round, const Vec3& place);
  bool slide_feature(const RoundSide& round, Contact& contact, Feature& feature) const;
  bool may_lead(const Vec3& place, const Vec3& normal, const Touch& touch) const;
  bool round_may_lead(const RoundSide::Place& place, const Touch& touch) const;
  bool is_covered(const RoundSide& round, const PlacesAtRest<Touch>& places, const Vec3& position,
                  const Vec3& outwards, const RoundSide::Place& on_round) const;

  std::optional<RoundSide> round_;
  SmoothField field_;                     ///< of models, whose nearest places it finds fast
  std::optional<RoundSide::Place> last_;  ///< makes the search for the next one short
  const Model* shell_ = nullptr;
  Pose field_from_shell_;
  Pose shell_from_field_;
  Turning turning_{};
  Turning turning_of_field_{};
  double lead_ = 0.0;             ///< by which places of the round body come first, meters
  double margin_ = 0.0;           ///< see TouchScale
  double least_curvature_ = 0.0;  ///< 1/meters
  double same_within_ = 0.0;      ///< meters
  double followed_within_ = 0.0;  ///< meters
  const void* before_ = nullptr;  ///< of which shell the places of the step before are
  FailedSlides failed_;
  PlacesAtRest<Touch> on_edges_;
  PlacesAtRest<Touch> on_faces_;
};

}  // namespace voxshell::bullet
