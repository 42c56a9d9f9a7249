#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "face_field.h"
#include "failed_slides.h"
#include "flat_elements.h"
#include "pair_step.h"
#include "places_at_rest.h"
#include "smooth_field.h"
#include "voxshell/contacts.h"
#include "voxshell/model.h"

namespace voxshell::bullet {

/// How much deeper than the nearest of its samples a model's smooth surface may be in a field,
/// meters; 0 where no part of it is curved.
double most_above_samples(const Model& model);

/// Slides contacts of a shell along its smooth surface to where that surface is deepest in the
/// field, so that a ball does not roll over its samples. Contacts that end at one place become one,
/// which keeps its id while it moves. Decision 36.
class RoundContacts {
 public:
  /// @param contacts          Of `model`'s shell in `field`, ascending by id; changed.
  /// @param field_from_shell  Pose of the shell's frame in the field's.
  /// @param turning           Of the shell's body: samples that may touch, once it has turned,
  /// before the place that they slide to does, stay where they are.
  /// @param least_depth       Contacts that cannot become as deep are dropped, meters.
  void slide(std::vector<Contact>& contacts, const Model& model, SmoothField field,
             const Pose& field_from_shell, const TouchScale& scale, const Turning& turning,
             float least_depth);

  /// Finds where the contacts of the last slide() are now, as the surface rolls over the field's.
  ///
  /// @param kept      Those of the pair, ascending by id; others are not looked for.
  /// @param first_id  Of this shell among them.
  /// @param field     Of the same geometry as then.
  /// @param moved     To which those that were found are added, with the shell's own ids.
  void follow(std::span<const Contact> kept, std::uint32_t first_id, SmoothField field,
              const Pose& field_from_shell, std::vector<Contact>& moved);

  /// Drops those of `guards`, contacts of the same shell that will not touch within the step, from
  /// which the surface leads to one of the contacts of the last slide().
  void drop_guards(std::vector<Contact>& guards, const TouchScale& scale, const Turning& turning);

  /// Appends the ids of the contacts of the last slide(), ascending, each plus `first`.
  void append_ids(std::uint32_t first, std::vector<std::uint32_t>& ids) const {
    at_rest_.append_ids(first, ids);
  }

  /// Drops those of `others`, contacts of the field's own shell, from which the surface of this
  /// shell leads to one of the contacts of the last slide().
  ///
  /// @param exact             Ids, ascending, of those that are no samples.
  /// @param own               What is left of the contacts of the last slide(), ascending by id.
  /// @param other_from_shell  Pose of this shell's frame in that of `others`.
  /// @param are_guards        They will not touch within the step: a quick look will do.
  void drop_covered(std::vector<Contact>& others, const PointShell& shell_of_others,
                    std::span<const std::uint32_t> exact, std::span<const Contact> own,
                    const Pose& other_from_shell, bool are_guards);

 private:
  /// Where the two surfaces face each other, and the place there.
  struct Touch {
    Facing facing;
    SmoothSurface::Place place;
  };
  bool slide_one(Contact& contact, const TouchScale& scale, const Turning& turning);
  bool leads(const SmoothSurface::Place& start, const PlacesAtRest<Touch>::AtRest& known,
             const TouchScale& scale, const Turning& turning) const;
  bool is_below(const Contact& contact, const Touch& touch) const;
  bool slides_to(const SmoothSurface::Place& start, const Touch& touch);
  std::optional<Touch> find_touch(const SmoothSurface::Place& start, Vec3 direction, double within);
  /// The end of a straight way.
  struct Straight {
    SmoothSurface::Place place;
    double displacement;  ///< meters
    bool is_over_edge;    ///< of the field's body, where its normal turns all at once
  };
  std::optional<Straight> go_straight(const SmoothSurface::Place& place, const Facing& facing);
  Facing feel(const Vec3& position);

  const SmoothSurface* surface_ = nullptr;
  SmoothField field_;
  Pose field_from_shell_;
  Pose shell_from_field_;
  double least_curvature_ = 0.0;  ///< 1/meters
  double spacing_ = 0.0;          ///< of the shell's samples, meters
  double margin_ = 0.0;           ///< see TouchScale
  double same_within_ = 0.0;      ///< meters
  double followed_within_ = 0.0;  ///< meters
  PlacesAtRest<Touch> at_rest_;
  FailedSlides failed_;
};

}  // namespace voxshell::bullet
