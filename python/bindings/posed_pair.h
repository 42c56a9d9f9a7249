#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>

#include "arrays.h"
#include "voxshell/contacts.h"
#include "voxshell/field.h"
#include "voxshell/pair.h"
#include "voxshell/point_shell.h"
#include "voxshell/pose.h"

namespace voxshell::python {

using SharedField = std::shared_ptr<const Field>;
using SharedShell = std::shared_ptr<const PointShell>;
/// None is the identity.
using OptionalPose = std::optional<PoseArray>;

/// From 16 numbers by rows. Errors name the pose. These need the GIL.
Pose read_matrix(const double* matrix, const std::string& name);
Pose read_pose(const OptionalPose& pose, const char* name);

/// Which body's points are tested, or both's, one after the other.
enum class Shells { kAutomatic, kA, kB, kBoth };

inline PairBody other(PairBody body) { return body == PairBody::kA ? PairBody::kB : PairBody::kA; }

struct Bodies {
  SharedField field_a;
  SharedShell shell_a;
  SharedField field_b;
  SharedShell shell_b;

  const SharedShell& shell_of(PairBody body) const {
    return body == PairBody::kA ? shell_a : shell_b;
  }
  const SharedField& field_of(PairBody body) const {
    return body == PairBody::kA ? field_a : field_b;
  }
  Participant participant(PairBody body) const {
    return {field_of(body).get(), shell_of(body).get()};
  }
};

/// Whose points to ask about, in this order. `may_swap`: where they find nothing and enclose the
/// other body, the other's.
struct Roles {
  std::vector<PairBody> shell_bodies;
  bool may_swap;
};

/// Raises SettingsError where a body that is asked for has no shell. Needs the GIL.
Roles choose_roles(const Bodies& bodies, Shells shells);

struct PairPose {
  Pose world_from_a;
  Pose world_from_b;

  const Pose& world_from(PairBody body) const {
    return body == PairBody::kA ? world_from_a : world_from_b;
  }
  /// The frame of the other body from that of `shell_body`.
  Pose field_from_shell(PairBody shell_body) const {
    return world_from(other(shell_body)).inverse() * world_from(shell_body);
  }
};

inline bool is_enclosed(const Bodies& bodies, const PairPose& pose, PairBody inner) {
  return voxshell::is_enclosed(bodies.participant(inner), bodies.participant(other(inner)),
                               pose.field_from_shell(inner));
}

/// A contact's points and normal in the world frame: the normal is on b and points towards a.
struct WorldContact {
  Vec3 point_a;
  Vec3 point_b;
  Vec3 normal;
};

WorldContact to_world(const Contact& contact, PairBody shell_body, const PairPose& pose);

}  // namespace voxshell::python
