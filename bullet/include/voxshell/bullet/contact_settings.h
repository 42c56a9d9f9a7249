#pragma once

#include <cstdint>

namespace voxshell::bullet {

enum class ContactMode {
  /// What rests most calmly: segmented, with up to four points a segment on few segments. In steps
  /// with CCD, one point a segment.
  kAutomatic,
  /// One manifold of at most four points: the deepest, then area. Segmented in steps with CCD (see
  /// ContactSettings::ccd_motion_threshold).
  kRegular,
  /// A manifold of one point, the deepest, for each segment of a level; of up to four where a body
  /// lies still on few segments.
  kSegmented,
};

/// Whose points of two models are tested against the other's field.
enum class ShellRule {
  /// Those of the model with which least can be missed, or both's where neither alone is enough: a
  /// constant of the two models (voxshell/pair.h).
  kAutomatic,
  /// Those of the model with fewer points, as the thesis has it.
  kFewest,
};

/// Seconds spent in voxshell's part of the narrow phase since the last reset, for one thread.
struct NarrowPhaseTimings {
  double query = 0.0;      ///< finding contacts
  double reduction = 0.0;  ///< choosing those that go into manifolds, and these
  double manifold = 0.0;   ///< filling manifolds
};

/// How contacts of models become contact points of Bullet.
struct ContactSettings {
  ContactMode mode = ContactMode::kAutomatic;
  ShellRule shell = ShellRule::kAutomatic;

  /// Tree level whose clusters are the segments, 1 (one) to 12; 0: level 4, up to 64 segments, and,
  /// unless contacts are kSegmented, level 5, up to 256, in steps with CCD.
  int level = 0;

  /// Slow points this close to a surface count as contacts, metres: without them a resting body
  /// loses and finds its contacts in turn and keeps rocking. Negative: a thousandth of the smaller
  /// body's diameter, but no more than a 20th of either body's thickness. "Slow" is an approach
  /// that takes longer than a step to cross the margin, so that impacts keep their rebound: a
  /// contact reported before touching makes the solver close the gap instead of reversing the
  /// velocity. Where a btCompoundShape takes part, give the ModelShape a margin above the default
  /// with setMargin() too: compounds skip children whose bounds are apart.
  double margin = -1.0;

  /// A pair that moves farther than this in a step, metres, gets continuous collision detection
  /// (CCD): points that will touch within the step are speculative contacts, so that fast bodies
  /// stop at surfaces, thin ones included. Negative: two fifths of a model's thickness or a 50th of
  /// its longest side, or a quarter of the inner radius of a box, ball, hull ..., whichever is
  /// least. Infinity: no CCD.
  double ccd_motion_threshold = -1.0;

  /// Whether bodies at rest on small patches meet Bullet's rolling friction, which keeps them from
  /// rocking. Not for btNNCGConstraintSolver, which applies it beyond its limits.
  bool rolling_at_rest = true;

  /// Where to add up times, or none. Not for worlds that dispatch on several threads.
  NarrowPhaseTimings* timings = nullptr;
};

}  // namespace voxshell::bullet
