#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "contact_manifold.h"
#include "friction_anchor.h"
#include "pair_step.h"
#include "rebound.h"
#include "resting_patch.h"
#include "shape_features.h"
#include "turning_contacts.h"
#include "voxshell/contacts.h"

namespace voxshell::bullet {

/// Of a contact that slides until the bodies touch: see Sliding.
struct Aside {
  std::uint32_t id;
  Vec3 aside;  ///< meters, shell's frame
};

/// What one step of a pair leaves to the next.
struct PairMemory {
  double owed_energy = 0.0;  ///< see Rebound
  RestingPatch patch;
  std::optional<Pose> held_b_from_a;  ///< see Hold
  std::vector<std::uint8_t> beside;   ///< room for a mark of each contact
  std::vector<Contact> found;         ///< room for the contacts where they are now
  std::vector<std::uint8_t> met;      ///< room for another mark of each contact
  std::vector<Vec3f> normals;         ///< room for those of the faces that touch
  Rebounding rebounding;
  TurningContacts turning;
  std::vector<Aside> asides;  ///< ascending by id
};

/// What all contacts of a step have in common, which to_world() needs for each of them.
struct StepContacts {
  const Rebounding* rebounding = nullptr;    ///< in the pair's memory
  const TurningContacts* turning = nullptr;  ///< likewise
  std::span<const Aside> asides;             ///< likewise
  Hold hold;
};

/// Whether a point touches, or would within the step at twice its speed, or if something else stops
/// one of the bodies, were it nearer by `above`, meters.
bool may_reach(const PairStep& step, const Contact& contact, double above);

/// Leaves those of `contacts`, ascending by id, that are contacts of this step, as the solver is to
/// see them:
///   - points that penetrate;
///   - slow points within the rest margin, or a resting body loses and finds its contacts in turn;
///   - in steps without CCD, where nothing rebounds: points within the rest margin that are closed
///     on within the step, of faces that touch or of the first that will;
///   - in steps with CCD: points that will touch within the step, with the gap that is left to them
///     (speculative_contacts.h); and where there are any contacts, those that move on, as they
///     might touch after the solver has turned the body.
/// docs/decisions/0003-contact-rule.md says why; decisions 50 to 53 treat CCD, rest and rebound.
///
/// @param features  Those that some of the contacts are of.
/// @param exact     Ids, ascending, of those contacts that are no samples: see RoundContacts.
/// @param hits      Ids, ascending, of those that are in the other body at some time of the step.
/// @param fraction  Of the step, after which the contacts were looked for: those of triangles.
StepContacts apply_contact_rule(const PairStep& step, std::span<const Feature> features,
                                std::span<const std::uint32_t> exact,
                                std::span<const std::uint32_t> hits, double fraction,
                                std::vector<Contact>& contacts, PairMemory& memory);

/// One of the contacts that apply_contact_rule() left, as Bullet wants it. `rolling_lever` is that
/// of the contacts that it shares a manifold with, meters.
WorldContact to_world(const PairStep& step, const StepContacts& of_step, const Contact& contact,
                      double rolling_lever);

}  // namespace voxshell::bullet
