#pragma once

#include <optional>
#include <span>
#include <vector>

#include "contact_manifold.h"
#include "motion.h"
#include "posed_pair.h"
#include "resting_patch.h"
#include "shape_features.h"
#include "voxshell/bullet/contact_settings.h"

namespace voxshell::bullet {

/// Which points near a surface are contacts of this step, and what the solver is told of them:
///   - points that penetrate;
///   - slow points within the rest margin, or a resting body loses and finds its contacts in turn;
///   - where the bodies move by more than their detail in this step: points that are going to touch
///     within it (Xu and Barbic 2016), with the gap that is left to them; and where there are any
///     contacts, those that move on might after the solver has turned the body.
/// docs/decisions/0003-contact-rule.md says why, and what it was measured to do.
class ContactRule {
 public:
  /// What one step leaves to the next.
  struct Memory {
    /// Of a rebound that was stopped at the surface first, because its apex is lower than the place
    /// where the step began: the energy that it still has, J/kg along the normal.
    double owed = 0.0;
    RestingPatch patch;
    /// b_from_a, where resting bodies took hold of each other.
    std::optional<Pose> hold;
  };

  ContactRule(const PosedPair& pair, const ContactSettings& settings, double time_step,
              Memory& memory);

  /// Distance up to which points may be contacts, metres.
  double margin() const { return margin_; }
  /// Up to which slow points count as contacts, metres.
  double rest_margin() const { return rest_margin_; }
  /// Whether points are followed through the step.
  bool sweeps() const { return sweeps_; }
  /// No place of the bodies moves by more in the step as the other sees it, metres.
  double farthest_way() const { return farthest_way_; }
  /// From which on bodies count as touching, metres.
  double touching_gap() const;
  /// Where the bodies are after a share of the step, if nothing stops them.
  Pose field_from_shell_after(double share) const;
  /// Whether the bodies hardly move, so that they may come to rest on the points that they lie on.
  bool is_still() const { return is_still_; }

  /// Leaves those of `contacts` that are contacts, as the solver is to see them: a point that is
  /// going to touch has the normal of the place where it will.
  ///
  /// @param features  Those that some of the contacts are of.
  /// @param share     Of the step, after which the contacts were looked for: those of triangles.
  void apply(std::vector<Contact>& contacts, std::span<const Feature> features, double share);

  /// The lever of the torque that `contacts` of a still body withstand where it is so short that
  /// the solver would hardly feel it, metres; 0 for others. Not empty.
  double lever_of(std::span<const Contact> contacts) const;

  /// One of those that apply() left, for the manifold of contacts that have this lever.
  WorldContact to_world(const Contact& contact, double lever) const;

 private:
  /// How the bodies meet at a contact, along its normal.
  struct Impact {
    double gap;                 ///< metres, negative where they overlap
    double approach;            ///< m/s
    double approach_of_forces;  ///< what forces add to it in the step, m/s
    double squared_speed;       ///< in any direction, m^2/s^2

    double time() const;  ///< when the surfaces meet or met, seconds; infinity where they part
  };
  /// The speed apart that a step is to end with, m/s.
  struct Rebound {
    double speed;
    double owed;  ///< see Memory
  };

  Impact impact_of(const Contact& contact) const;
  Rebound rebound_of(const Impact& impact) const;
  bool is_slow(const Impact& impact) const;
  bool is_resting(const Impact& impact) const;
  bool is_contact(const Impact& impact) const;
  bool holds(const Impact& impact) const;
  void hold(std::span<const Contact> contacts);
  bool is_held(const Vec3& slip) const;
  /// How far a point of the shell has slipped along the surface since the bodies took hold of each
  /// other. Metres, in the shell's frame.
  Vec3 slip_of(const Contact& contact) const {
    const auto point = static_cast<Vec3>(contact.point);
    const auto normal = static_cast<Vec3>(contact.normal);
    const Vec3 slip = point - shell_from_held_.transform_point(point);
    return slip - dot(slip, normal) * normal;
  }
  bool is_first(const Impact& impact) const;
  void carry_back(std::vector<Contact>& contacts, double share) const;
  void put_on_field(Contact& contact, const Vec3& on_field) const;
  std::optional<Contact> sweep(const Contact& contact) const;
  std::optional<Contact> sweep_into_shell(const Feature& feature, std::uint32_t id) const;
  bool shell_is_larger() const;
  void drop_beside(std::vector<Contact>& contacts);
  bool is_beside(const Contact& contact) const;

  const PosedPair& pair_;
  double time_step_;
  Memory& memory_;
  const Side* larger_ = nullptr;  ///< of the bodies, if one is
  double radius_;                 ///< of the smaller body, metres
  double rest_margin_;
  Motion motion_a_;
  Motion motion_b_;
  double restitution_;
  bool sweeps_;
  bool is_still_;
  bool rolling_at_rest_;
  double farthest_way_;
  double margin_;
  double detail_;  ///< of the finer body, metres
  std::span<const Feature> features_;
  RelativeMotion motion_{};  ///< of the shell as the field sees it, in the shell's frame
  Pose field_from_shell_;
  Pose shell_from_held_;     ///< takes a point to where it would be had it not slipped
  double owed_;              ///< by the step before
  double first_touch_;       ///< of the contacts, seconds from the start of the step on
  std::size_t first_count_;  ///< how many of them touch then
};

}  // namespace voxshell::bullet
