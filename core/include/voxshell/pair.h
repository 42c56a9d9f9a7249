#pragma once

#include "voxshell/field.h"
#include "voxshell/point_shell.h"
#include "voxshell/pose.h"
#include "voxshell/result.h"

namespace voxshell {

/// One body of a pair. Analytic fields come without a shell.
struct Participant {
  const Field* field = nullptr;
  const PointShell* shell = nullptr;
};

enum class PairBody { kA, kB };

/// Which body's points are tested against the other's field.
enum class ShellChoice {
  /// The body with fewer points (thesis, section 5.3), a where they are equal; the other where
  /// these points lie farther apart than its own and its shortest side, so that it could slip
  /// between them, or where that one encloses it: see is_enclosed().
  kAutomatic,
  kA,
  kB,
};

/// Error kInvalidArgument where the chosen body, or neither of them, has a shell.
Result<PairBody> choose_shell(const Participant& a, const Participant& b, ShellChoice choice);

/// Where kAutomatic found no contact of `outer`'s points: whether the roles are to be swapped,
/// because `inner` may lie wholly inside `outer`, as a point of its shell does. One evaluation of a
/// field; false where either body has no shell.
bool is_enclosed(const Participant& inner, const Participant& outer, const Pose& outer_from_inner);

}  // namespace voxshell
