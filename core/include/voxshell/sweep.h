#pragma once

#include <optional>

#include "voxshell/contacts.h"
#include "voxshell/rigid_motion.h"

namespace voxshell {

struct SweepOptions {
  float margin = 0.0f;  ///< elements with a distance below this touch, metres
  /// Metres, above 0: bodies that come within this of touching may count as touching.
  double tolerance = 0.0;
  double end = 1.0;  ///< fraction of the motion to look at, 0 to 1
};

/// How far bodies can move.
struct Sweep {
  /// At no fraction of the motion before this one does find_contacts() find any.
  double fraction = 0.0;
  /// Of the nearest elements there; none where nothing touches up to the end.
  std::optional<Contact> contact;
};

/// The fraction of a motion at which a shell first touches a field. Conservative advancement
/// (Mirtich 1996) on the point-sphere tree: a time is passed over where no element can come below
/// the margin within it, by the field's own lower bounds about the places in its middle and a bound
/// of how far an element moves. So nothing is missed however thin it is and however fast bodies
/// move (docs/decisions/0042-swept-queries.md). The motion may be of any length; turns count as
/// given, also beyond a whole one. Where fields are not continuous, bodies may stop by their step
/// earlier than the tolerance says; where the margin reaches beyond a grid, by as much as that
/// reaches.
Sweep sweep(const Field& field, const PointShell& shell, const RigidMotion& world_from_field,
            const RigidMotion& world_from_shell, const SweepOptions& options,
            QueryScratch& scratch);

}  // namespace voxshell
