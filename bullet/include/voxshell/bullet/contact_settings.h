#pragma once

#include <cstdint>

namespace voxshell::bullet {

enum class ContactMode {
  /// Segmented, for the calmest rest, with up to four points per segment if there are few segments.
  /// In steps with CCD, one point per segment.
  kAutomatic,
  /// One manifold of at most four points: the deepest, then area. Segmented in steps with CCD (see
  /// ContactSettings::ccd_motion_threshold).
  kRegular,
  /// A manifold of one point, the deepest, for each segment of a level; of up to four if a body
  /// lies still on few segments.
  kSegmented,
};

/// Which of two models is the shell.
enum class ShellRule {
  /// The model that misses least, or both if neither alone is enough. It depends on the two models
  /// alone (voxshell/pair.h).
  kAutomatic,
  /// The model with fewer points, as in the thesis.
  kFewest,
};

/// Seconds spent in voxshell's narrow phase since the last reset, for one thread.
struct NarrowPhaseTimings {
  double query = 0.0;      ///< finding contacts
  double reduction = 0.0;  ///< choosing contacts for the manifolds
  double manifold = 0.0;   ///< filling manifolds
};

/// How contacts of models become contact points in Bullet.
struct ContactSettings {
  ContactMode mode = ContactMode::kAutomatic;
  ShellRule shell = ShellRule::kAutomatic;

  /// Tree level whose clusters are the segments, 1 (one segment) to 12. 0: level 4, up to 64
  /// segments; and level 5, up to 256, in steps with CCD unless contacts are kSegmented.
  int level = 0;

  /// Slow points this close to a surface count as contacts, meters. Without them a resting body
  /// loses and finds its contacts in turn and keeps rocking. Negative: a thousandth of the smaller
  /// body's diameter, but at most a 20th of either body's thickness. "Slow" is an approach that
  /// takes longer than a step to cross the margin. Impacts therefore keep their rebound: a contact
  /// reported before touching makes the solver close the gap instead of reversing the velocity. If
  /// a btCompoundShape takes part and the margin is above the default, also give it to the
  /// ModelShape with setMargin(), because compounds skip children whose bounds are apart.
  double margin = -1.0;

  /// A pair that moves farther than this in a step, meters, gets continuous collision detection
  /// (CCD): points that will touch within the step are speculative contacts, so fast bodies stop at
  /// surfaces, including thin ones. Negative: a tenth of a model's thickness, a 200th of its
  /// longest side, or a 16th of the inner radius of a box, ball or hull, whichever is least; for
  /// pairs with restitution, by kAutomatic, at most the margin. Infinity: no CCD.
  double ccd_motion_threshold = -1.0;

  /// Whether bodies at rest on small patches get Bullet's rolling friction, which keeps them from
  /// rocking. Not for btNNCGConstraintSolver, which applies it beyond its limits.
  bool rolling_at_rest = true;

  /// Whether contacts of round bodies that move along concave surfaces tell the solver how fast
  /// these turn toward them. Only CoulombSolver listens: with it, balls keep their speed in bowls
  /// and bends (docs/decisions/0061-contacts-turn-within-a-step.md).
  bool solver_turns_contacts = false;

  /// Where to add up times, or null. Not for worlds that dispatch on several threads.
  NarrowPhaseTimings* timings = nullptr;
};

}  // namespace voxshell::bullet
