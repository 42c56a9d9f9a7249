#include <array>
#include <utility>

#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>

#include "core_module.h"
#include "in_ordinary_floats.h"
#include "interpreter_lock.h"
#include "posed_pair.h"
#include "query_scratch.h"
#include "voxshell/wrench.h"

namespace nb = nanobind;

namespace voxshell::python {
namespace {

using Coordinates = std::array<double, 3>;

/// Replaces negative zeros.
Coordinates to_coordinates(const Vec3& v) { return {v.x + 0.0, v.y + 0.0, v.z + 0.0}; }

/// Wrench on a about a's origin, from the core's wrench on the shell's body; all in the world
/// frame.
Wrench on_a(const Wrench& on_shell, PairBody shell_body, const PairPose& pose) {
  const Pose& world_from_shell = pose.world_from(shell_body);
  const Vec3 force = world_from_shell.rotate(on_shell.force);
  const Vec3 torque = world_from_shell.rotate(on_shell.torque);
  if (shell_body == PairBody::kA) return {force, torque};
  const Vec3 arm = pose.world_from_b.translation - pose.world_from_a.translation;
  return {-force, -(torque + cross(arm, force))};
}

std::pair<Coordinates, Coordinates> wrench(const Field& field_a, const Model* model_a,
                                           const Field& field_b, const Model* model_b,
                                           const OptionalPose& a_pose, const OptionalPose& b_pose,
                                           ShellChoice shells, double stiffness,
                                           SharedScratch* scratch) {
  const Bodies bodies{field_a, model_a, field_b, model_b};
  const PairPose pose{read_pose(a_pose, "a_pose"), read_pose(b_pose, "b_pose")};
  const Roles roles = choose_roles(bodies, shells);
  const ReleasedInterpreter released;
  bool touches = false;
  Wrench result{};
  const auto ask = [&](PairBody body, double weight) {
    const LockedScratch locked(scratch, body);
    const Wrench found = compute_wrench(*bodies.field_of(other(body)), *bodies.shell_of(body),
                                        pose.field_from_shell(body), weight * stiffness, *locked);
    touches = touches || !(*locked).contacts().empty();
    const Wrench of_shell = on_a(found, body, pose);
    result.force += of_shell.force;
    result.torque += of_shell.torque;
  };
  // The surfaces of both shells represent the same layer of springs. Their mean counts it once, and
  // is continuous because both are.
  const double weight = 1.0 / static_cast<double>(roles.shell_bodies.size());
  for (const PairBody body : roles.shell_bodies) ask(body, weight);
  const PairBody inner = other(roles.shell_bodies[0]);
  if (roles.may_swap && !touches && is_enclosed(bodies, pose, inner)) ask(inner, 1.0);
  return {to_coordinates(result.force), to_coordinates(result.torque)};
}

}  // namespace

void bind_wrench(nb::module_& module) {
  module.def(
      "wrench", &wrench, nb::arg("field_a"), nb::arg("model_a").none(), nb::arg("field_b"),
      nb::arg("model_b").none(), nb::arg("a_pose").none(), nb::arg("b_pose").none(),
      nb::arg("shells"), nb::arg("stiffness"), nb::arg("scratch").none(), InOrdinaryFloats(),
      "Return force and torque on a about its origin, world frame; for both shells the mean.");
}

}  // namespace voxshell::python
