#pragma once

#include <optional>

#include "voxshell/contacts.h"
#include "voxshell/rigid_motion.h"

namespace voxshell {

struct SweepOptions {
  float margin = 0.0f;  ///< elements with a distance below this touch, meters
  /// Meters, above 0. Bodies that come within this distance of touching may count as touching.
  double tolerance = 0.0;
  double end = 1.0;  ///< fraction of the motion to examine, 0 to 1
};

/// Result of a sweep.
struct Sweep {
  /// Time of impact: find_contacts() finds nothing at any earlier fraction of the motion.
  double fraction = 0.0;
  /// One of the nearest elements at that fraction; none if nothing touches up to the end.
  std::optional<Contact> contact;
};

/// Finds the fraction of a motion at which a shell first touches a field, by conservative
/// advancement (Mirtich 1996) on the point-sphere tree. An interval of time is skipped if no
/// element can come below the margin within it. To decide this, the sweep uses the field's lower
/// bounds about the places at the middle of the interval, and a bound of how far an element moves.
/// Therefore it misses nothing, however thin bodies are and however fast they move
/// (docs/decisions/0042-swept-queries.md). The motion may have any length; turns count as given,
/// also beyond a whole turn. If fields are not continuous, bodies may stop earlier than the
/// tolerance says, by the step of the field. If the margin reaches beyond a grid, they may stop
/// earlier by as much as it reaches.
Sweep sweep(const Field& field, const PointShell& shell, const RigidMotion& world_from_field,
            const RigidMotion& world_from_shell, const SweepOptions& options,
            QueryScratch& scratch);

}  // namespace voxshell
