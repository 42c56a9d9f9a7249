#pragma once

#include <array>

#include "ball.h"
#include "motion.h"
#include "posed_pair.h"
#include "support.h"
#include "voxshell/bullet/contact_settings.h"

namespace voxshell::bullet {

/// What is known of a pair at the start of a step, before any contact is looked for. All parts of
/// the contact rule are functions of it; none of them changes it. Meters, seconds.
struct PairStep {
  const PosedPair* pair;  ///< outlives this
  double time_step;
  Motion motion_a;
  Motion motion_b;
  const Side* larger;   ///< the body with the larger bounding ball; null where they are as large
  Ball ball;            ///< about the smaller body, world frame
  double thickness;     ///< of both bodies' margins in Bullet
  double rest_margin;   ///< slow points count as contacts up to this gap
  double deep_overlap;  ///< bodies that are deeper in each other may hold each other's middles
  /// No place of the smaller body moves farther in the step, as the other body sees it.
  double farthest_displacement;
  double detail;        ///< of the finer body; see Side::detail()
  bool uses_ccd;        ///< points that will touch within the step are contacts
  double margin;        ///< points may be contacts up to this gap
  double touch_margin;  ///< points farther apart do not touch within the step; at most the margin
  bool is_supported;    ///< contacts are taken to support the bodies as in the last step
  bool is_still;        ///< the bodies hardly move, and come to rest on the points that they lie on
  bool rolls_at_rest;   ///< ContactSettings::rolling_at_rest
  bool solver_turns_contacts;  ///< ContactSettings::solver_turns_contacts
  bool is_segmented;           ///< each segment's contact is wanted: ContactMode::kSegmented
  double restitution;          ///< of the two objects
  double owed_energy;          ///< of a rebound that the last step stopped at the surface, m2/s2
  Pose field_from_shell;
  RelativeMotion motion;  ///< of the shell as the field sees it, in the shell's frame
  /// The same if something else stops the field's body, or the shell's.
  std::array<RelativeMotion, 2> if_stopped;
  Vec3 middle;        ///< of the smaller body's bounding ball, shell's frame
  Vec3 displacement;  ///< of the middle by that motion

  /// Whether points farther away than the rest margin may be contacts.
  bool looks_ahead() const { return margin > rest_margin; }
  /// The gap at which surfaces count as touching.
  double touching_gap() const;
  /// Where the bodies are after a fraction of the step, if nothing stops them.
  Pose field_from_shell_after(double fraction) const {
    return field_from_shell_after(fraction, motion_a, motion_b);
  }
  /// The same if they move otherwise.
  Pose field_from_shell_after(double fraction, const Motion& of_a, const Motion& of_b) const;
};

/// How a body may turn within a step, as the other one sees it, in the body's own frame.
struct Turning {
  Vec3 center;   ///< about which
  Vec3 turn;     ///< radians about each axis, several times what it is turning by
  Vec3 stopped;  ///< radians by which what stops its motion along each axis may turn it

  /// Whether a normal of its surface may come to point along a direction; both unit length.
  bool may_face(const Vec3& normal, const Vec3& direction, double slack) const;
  /// How much farther along a direction a place of its surface may come than another one is taken
  /// to, which moves as its velocity says, but by at most `gap` along the direction; meters.
  double lead_over(const Vec3& place, const Vec3& normal, const Vec3& other, double gap,
                   const Vec3& direction) const;
};
/// Of the shell's body, or of the field's.
Turning turning_of(const PairStep& step, bool is_of_field);
/// The same by its own spin alone, as a round body sees it whose spin moves no place of its surface
/// toward the other body.
Turning own_turning_of(const PairStep& step, bool is_of_field);

/// @param support  What supports the bodies, which touched in the last step; else null.
PairStep describe_step(const PosedPair& pair, const ContactSettings& settings, double time_step,
                       double owed_energy, const Support* support = nullptr);

}  // namespace voxshell::bullet
