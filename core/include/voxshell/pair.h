#pragma once

#include "voxshell/field.h"
#include "voxshell/point_shell.h"
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
  kAutomatic,  ///< the body with fewer points (thesis, section 5.3); a where they are equal
  kA,
  kB,
};

/// Error kInvalidArgument where the chosen body, or neither of them, has a shell.
Result<PairBody> choose_shell(const Participant& a, const Participant& b, ShellChoice choice);

}  // namespace voxshell
