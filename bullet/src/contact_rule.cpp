#include "contact_rule.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>

#include "contact_constants.h"
#include "impact.h"
#include "implied_contacts.h"
#include "round_touch.h"
#include "side_contacts.h"
#include "sliding_touch.h"
#include "speculative_contacts.h"

namespace voxshell::bullet {
namespace {

/// Whether a point that the bodies do not bring to each other within the step touches if something
/// else stops one of them: bodies that fall together, of which the lower one lands.
bool touches_if_stopped(const PairStep& step, const Contact& contact, const Impact& impact) {
  if (closing_of(step, impact) >= impact.gap) return false;
  const auto closes = [&](const RelativeMotion& motion) {
    const Vec3 velocity =
        motion.velocity_at(static_cast<Vec3>(contact.point)) + motion.velocity_of_fall;
    return -dot(velocity, static_cast<Vec3>(contact.normal)) * step.time_step >= impact.gap;
  };
  return std::ranges::any_of(step.if_stopped, closes);
}

/// Marks the points within the rest margin that bodies close on in a step without CCD: those of the
/// faces that touch, or of the one that will touch first. By rounding, some points of a face that
/// has landed are above the ground, and without them it tips; points of faces beside it would stop
/// what slides. Marks none where all points are slow, or where they would rebound too early.
void mark_met_without_ccd(const PairStep& step, std::span<const Contact> contacts,
                          PairMemory& memory) {
  memory.met.clear();
  if (step.uses_ccd || step.restitution > 0.0 || step.farthest_displacement <= step.rest_margin) {
    return;
  }
  std::vector<Vec3f>& normals = memory.normals;
  normals.clear();
  const auto is_of_face = [&](const Contact& contact) {
    return std::ranges::any_of(
        normals, [&](const Vec3f& n) { return dot(n, contact.normal) >= kDoubleCosine; });
  };
  double soonest = kNever;
  const Contact* first = nullptr;
  for (const Contact& contact : contacts) {
    const Impact impact = impact_of(step, contact);
    if (is_contact(step, impact)) {
      if (!is_of_face(contact)) normals.push_back(contact.normal);
    } else if (impact.time() < soonest) {
      soonest = impact.time();
      first = &contact;
    }
  }
  if (normals.empty() && first != nullptr) normals.push_back(first->normal);
  for (const Contact& contact : contacts) {
    const Impact impact = impact_of(step, contact);
    memory.met.push_back(impact.gap <= step.rest_margin && closing_of(step, impact) >= impact.gap &&
                         is_of_face(contact));
  }
}

bool is_ball(const Field& field) {
  return std::holds_alternative<SphereField>(field) || std::holds_alternative<CapsuleField>(field);
}

/// What the contacts that touch leave of a fall; none where they support nothing of it, or all.
std::optional<Vec3> find_guided_fall(const PairStep& step, const Vec3& fall,
                                     std::span<const Contact> contacts) {
  Vec3 left = fall;
  for (int i = 0; i < kGuidedSweeps; ++i) {
    for (const Contact& contact : contacts) {
      if (!is_contact(step, impact_of(step, contact))) continue;
      const auto normal = static_cast<Vec3>(contact.normal);
      left = left - std::min(dot(left, normal), 0.0) * normal;
    }
  }
  const double least = kLeastGuided * length(fall);
  if (length(fall - left) <= least || length(left) <= least) return std::nullopt;
  return left;
}

/// How the bodies may move along what they touch if one of them falls and something supports the
/// other one. Where that gives way, they are faster.
class GuidedFalls {
 public:
  GuidedFalls(const PairStep& step, std::span<const Contact> contacts) {
    if (!step.looks_ahead()) return;
    for (const RelativeMotion& stopped : step.if_stopped) {
      if (stopped.velocity_of_fall == Vec3{}) continue;
      const auto fall = find_guided_fall(step, stopped.velocity_of_fall, contacts);
      if (!fall) continue;
      motions_[count_] = step.motion;
      motions_[count_++].velocity_of_fall = kCcdReach * *fall;
    }
  }
  std::span<const RelativeMotion> all() const { return std::span(motions_).first(count_); }

 private:
  std::array<RelativeMotion, 2> motions_{};
  std::size_t count_ = 0;
};

/// What a contact that does not touch where it is becomes in a step with CCD.
struct Followed {
  Contact plane;
  bool touches;  ///< within the step; else it is there in case the solver makes the place faster
};

/// None where the place moves on past the other body.
/// @param hits  Whether it is in the other body at some time of the step.
std::optional<Followed> follow(const PairStep& step, std::span<const Feature> features,
                               const Contact& contact, const Impact& impact, bool hits) {
  const double closing = closing_of(step, impact);
  const bool closes = closing >= impact.gap;
  if (step.pair->has_triangles()) return Followed{contact, closes};
  if (closes || hits) {
    const auto reached = find_speculative(step, step.motion, features, contact, 1.0);
    if (reached) return Followed{*reached, true};
    if (closes) return std::nullopt;
  }
  if (kCcdReach * closing < impact.gap) return Followed{contact, false};
  const auto reached = find_speculative(step, step.motion, features, contact, kCcdReach);
  return Followed{reached.value_or(contact), false};
}

/// Leaves what touches, speculative contacts included, and in steps with CCD what moves on beside
/// it; nothing where nothing touches. `memory` gets these contacts where they are now, too.
void keep_touching(const PairStep& step, std::span<const Feature> features,
                   std::span<const std::uint32_t> exact, std::span<const std::uint32_t> hits,
                   std::vector<Contact>& contacts, PairMemory& memory) {
  std::vector<std::uint8_t>& beside = memory.beside;
  std::vector<Contact>& places = memory.found;
  beside.clear();
  places.clear();
  bool touches = false;
  bool touches_from_above = false;
  RelativeMotion freely = step.motion;
  freely.velocity_of_fall = {};
  const GuidedFalls guided_falls(step, contacts);
  // What is kept may overwrite the contact that is looked at.
  const auto keep = [&](const Contact& found, Contact judged) {
    beside.push_back(is_beside(step, found, judged.normal) ? 1 : 0);
    places.push_back(found);
    // What turns holds the bodies on the path that others give way to.
    if (step.looks_ahead() && !is_contact(step, impact_of(step, found)) &&
        !(memory.turning.speed_of(found.id) > 0.0)) {
      allow_motion(step, freely, features, found, 0.0, judged);
      for (const RelativeMotion& guided : guided_falls.all()) {
        allow_motion(step, guided, features, found, 2.0 * step.touching_gap(), judged);
      }
      for (const RelativeMotion& turned : memory.turning.motions()) {
        // At its end, bodies touch with other places than now.
        allow_motion(step, turned, features, found, 2.0 * step.touching_gap(), judged);
      }
    }
    contacts[beside.size() - 1] = judged;
  };
  const auto touch = [&](const Contact& found, const Contact& judged) {
    keep(found, judged);
    touches = true;
    touches_from_above = touches_from_above || beside.back() == 0;
  };
  memory.asides.clear();
  mark_met_without_ccd(step, contacts, memory);
  memory.turning.find(step, contacts, exact);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Contact contact = contacts[i];
    const Impact impact = impact_of(step, contact);
    if (is_contact(step, impact) || (!memory.met.empty() && memory.met[i] != 0) ||
        memory.turning.speed_of(contact.id) > 0.0 ||
        (step.looks_ahead() && touches_if_stopped(step, contact, impact))) {
      touch(contact, contact);
      continue;
    }
    // Features are few: each may meet another wall than the one that it is nearest to now.
    const bool hits_later =
        contact.id >= kFirstFeature || std::ranges::binary_search(hits, contact.id);
    const bool is_exact = std::ranges::binary_search(exact, contact.id);
    if (!step.uses_ccd || !(is_exact || hits_later || !is_steep(step, contact))) continue;
    const auto followed = follow(step, features, contact, impact, hits_later);
    if (!followed) continue;
    // What has slid to the deepest place has a truer normal than the place that it is said to
    // reach, and goes on sliding until they touch.
    const bool stays = is_exact && dot(contact.normal, followed->plane.normal) >= kDoubleCosine;
    std::optional<Sliding> sliding;
    // The sides of cylinders and capsules touch along lines, at whose ends their features stay.
    const bool slides =
        contact.id < kFirstFeature || std::holds_alternative<SphereField>(step.pair->field());
    if (is_exact && followed->touches && slides) {
      sliding = find_sliding(step, step.motion, contact, 1.0);
    }
    // A place of a ball that will touch may come through another wall before, straight on.
    const bool is_behind =
        contact.id >= kFirstFeature && followed->touches && is_ball(step.pair->field()) &&
        closing_of(step, impact) >= impact.gap &&
        dot(contact.normal, followed->plane.normal) < static_cast<float>(kTurnedCosine);
    Contact judged = stays || is_behind ? contact : followed->plane;
    // If the places are farther apart than what the bodies pass each other, they were not found.
    const bool is_known =
        sliding && sliding->faces && length(sliding->aside) <= kMostAside * sliding->passed;
    if (is_known && (stays || sliding->contact.normal == judged.normal)) {
      judged = sliding->contact;
      memory.asides.push_back({contact.id, sliding->aside});
    }
    if (followed->touches) {
      touch(contact, judged);
    } else {
      keep(contact, judged);
    }
  }
  contacts.resize(touches ? beside.size() : 0);
  places.resize(contacts.size());
  // A body that leaves another from inside is in contact all the way, if only with such.
  if (!touches_from_above || (step.larger == nullptr && !step.pair->asks_both)) return;
  std::size_t left = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (beside[i] != 0) continue;
    places[left] = places[i];
    contacts[left++] = contacts[i];
  }
  contacts.resize(left);
  places.resize(left);
}

/// Lets what does not touch first move on as the rebound of what does leaves it.
/// @param found  The contacts where they are now.
void allow_rebound(const PairStep& step, const FirstTouch& first, std::span<const Feature> features,
                   std::span<const Contact> found, std::vector<Contact>& contacts) {
  if (!step.looks_ahead()) return;
  const auto after = find_motion_after(step, first, contacts);
  if (!after) return;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Impact impact = impact_of(step, contacts[i]);
    if (is_contact(step, impact) || first.includes(step, impact)) continue;
    allow_motion_after(step, *after, features, found[i], contacts[i]);
  }
}

}  // namespace

bool may_reach(const PairStep& step, const Contact& contact, double above) {
  Impact impact = impact_of(step, contact);
  impact.gap -= above;
  return is_contact(step, impact) || kCcdReach * closing_of(step, impact) >= impact.gap ||
         touches_if_stopped(step, contact, impact);
}

StepContacts apply_contact_rule(const PairStep& step, std::span<const Feature> features,
                                std::span<const std::uint32_t> exact,
                                std::span<const std::uint32_t> hits, double fraction,
                                std::vector<Contact>& contacts, PairMemory& memory) {
  if (fraction > 0.0) move_to_start(step, fraction, contacts);
  keep_touching(step, features, exact, hits, contacts, memory);
  drop_implied(step, memory.turning, contacts, memory.found);
  StepContacts of_step;
  const FirstTouch first = find_first_touch(step, contacts);
  allow_rebound(step, first, features, memory.found, contacts);
  const auto touches = [&](const Contact& contact) {
    return is_contact(step, impact_of(step, contact));
  };
  if (step.is_still && std::ranges::any_of(contacts, touches)) {
    memory.patch.settle(contacts, exact, step.thickness, kPatchOfMargin * step.rest_margin);
  } else {
    memory.patch.release();
  }
  memory.rebounding.find(step, first, contacts);
  of_step.rebounding = &memory.rebounding;
  of_step.turning = &memory.turning;
  of_step.asides = memory.asides;
  of_step.hold = renew_hold(step, contacts, memory.held_b_from_a);
  memory.held_b_from_a = of_step.hold.b_from_a;
  memory.owed_energy = 0.0;
  if (step.restitution > 0.0 || step.owed_energy > 0.0) {
    for (const Contact& contact : contacts) {
      if (memory.rebounding.count_with(contact.id) == 0) continue;
      const Rebound rebound = rebound_of(step, impact_of(step, contact));
      memory.owed_energy = std::max(memory.owed_energy, rebound.owed_energy);
    }
  }
  return of_step;
}

WorldContact to_world(const PairStep& step, const StepContacts& of_step, const Contact& contact,
                      double rolling_lever) {
  const PosedPair& pair = *step.pair;
  WorldContact world = pair.to_world(contact);
  const auto slid = std::ranges::lower_bound(of_step.asides, contact.id, {}, &Aside::id);
  if (slid != of_step.asides.end() && slid->id == contact.id) {
    Vec3& of_larger = is_shell_larger(step) == pair.shell_is_a ? world.point_a : world.point_b;
    of_larger = of_larger + pair.shell_side().world_from_geometry().rotate(slid->aside);
  }
  const Impact impact = impact_of(step, contact);
  world.is_resting = is_anchored(step, impact);
  world.keeps_impulse = step.is_still || world.is_resting;
  if (world.is_resting) {
    const Vec3 slip =
        pair.shell_side().world_from_geometry().rotate(slip_of(step, of_step.hold, contact));
    world.slip = pair.shell_is_a ? slip : -slip;
    world.rolling_friction = rolling_lever;
  }
  world.turning_speed = of_step.turning->speed_of(contact.id);
  if (world.turning_speed > 0.0) return world;
  const SolverRebound rebound =
      rebound_for_solver(step, of_step.rebounding->count_with(contact.id), impact);
  world.restitution = rebound.restitution;
  world.first_impulse = rebound.first_impulse;
  return world;
}

}  // namespace voxshell::bullet
