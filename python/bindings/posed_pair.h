#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>

#include "pose_matrix.h"
#include "voxshell/contacts.h"
#include "voxshell/field.h"
#include "voxshell/model.h"
#include "voxshell/pair.h"
#include "voxshell/pose.h"

namespace voxshell::python {

using SharedField = std::shared_ptr<const Field>;
/// Null for an analytic field.
using SharedModel = std::shared_ptr<const Model>;
/// Null is the identity.
using OptionalPose = std::optional<PoseMatrix>;

/// From 16 numbers by rows. Errors name the pose. These functions need the GIL.
Pose read_matrix(const double* matrix, const std::string& name);
Pose read_pose(const OptionalPose& pose, const char* name);

inline Role role_of(PairBody body) { return body == PairBody::kA ? Role::kA : Role::kB; }

inline Participant make_participant(const Field& field, const Model* model) {
  if (model == nullptr) return {.field = &field};
  return {.field = &field,
          .shell = &model->shell(),
          .accuracy = &model->accuracy(),
          .thickness = model->thickness(),
          .inner_point = &model->inner_point()};
}

/// The bodies of a query. The caller's arguments keep them alive, also without the GIL.
struct Bodies {
  Participant a;
  Participant b;

  Bodies(const Field& field_a, const Model* model_a, const Field& field_b, const Model* model_b)
      : a(make_participant(field_a, model_a)), b(make_participant(field_b, model_b)) {}

  const Participant& participant(PairBody body) const { return body == PairBody::kA ? a : b; }
  const PointShell* shell_of(PairBody body) const { return participant(body).shell; }
  const Field* field_of(PairBody body) const { return participant(body).field; }
};

/// The same bodies, kept alive for results that outlive the call.
struct SharedBodies {
  SharedField field_a;
  SharedModel model_a;
  SharedField field_b;
  SharedModel model_b;

  Bodies view() const { return {*field_a, model_a.get(), *field_b, model_b.get()}; }
  const PointShell* shell_of(PairBody body) const { return view().shell_of(body); }
  const Field* field_of(PairBody body) const { return view().field_of(body); }
};

/// The bodies whose points to test, in this order. `may_swap`: if these find nothing and enclose
/// the other body, test the other body's points.
struct Roles {
  std::span<const PairBody> shell_bodies;  ///< one or two, static data
  bool may_swap;
  bool asks_inside;  ///< if nothing is found, test whether an inner point is in the other body

  Role role() const { return shell_bodies.size() == 2 ? Role::kBoth : role_of(shell_bodies[0]); }
};

/// Raises SettingsError if a requested body has no shell. Needs the GIL.
Roles choose_roles(const Bodies& bodies, ShellChoice choice);

struct PairPose {
  Pose world_from_a;
  Pose world_from_b;

  const Pose& world_from(PairBody body) const {
    return body == PairBody::kA ? world_from_a : world_from_b;
  }
  /// Transforms from the frame of `shell_body` to that of the other body.
  Pose field_from_shell(PairBody shell_body) const {
    return world_from(other(shell_body)).inverse() * world_from(shell_body);
  }
};

inline bool is_enclosed(const Bodies& bodies, const PairPose& pose, PairBody inner) {
  return voxshell::is_enclosed(bodies.participant(inner), bodies.participant(other(inner)),
                               pose.field_from_shell(inner));
}

/// A contact's points and normal in the world frame: the normal is on b and points toward a.
struct WorldContact {
  Vec3 point_a;
  Vec3 point_b;
  Vec3 normal;
};

WorldContact to_world(const Contact& contact, PairBody shell_body, const PairPose& pose);

}  // namespace voxshell::python
