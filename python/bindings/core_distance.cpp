#include <algorithm>
#include <array>
#include <optional>

#include <nanobind/stl/array.h>
#include <nanobind/stl/tuple.h>

#include "contact_set.h"
#include "core_module.h"
#include "in_ordinary_floats.h"
#include "interpreter_lock.h"
#include "posed_pair.h"
#include "query_scratch.h"
#include "voxshell/distance.h"

namespace nb = nanobind;

namespace voxshell::python {
namespace {

using Coordinates = std::array<double, 3>;

Coordinates to_coordinates(const Vec3& v) { return {v.x, v.y, v.z}; }

/// Distance, point on a, point on b, normal, and whether the element belongs to a's shell.
using Nearest = std::tuple<double, Coordinates, Coordinates, Coordinates, bool>;

std::optional<Nearest> distance(const Field& field_a, const Model* model_a, const Field& field_b,
                                const Model* model_b, const OptionalPose& a_pose,
                                const OptionalPose& b_pose, ShellChoice shells,
                                RoundedInside max_distance, SharedScratch* scratch) {
  const Bodies bodies{field_a, model_a, field_b, model_b};
  const PairPose pose{read_pose(a_pose, "a_pose"), read_pose(b_pose, "b_pose")};
  const Roles roles = choose_roles(bodies, shells);
  const ReleasedInterpreter released;
  std::optional<Contact> nearest;
  PairBody shell_body = roles.shell_bodies[0];
  const auto ask = [&](PairBody body) {
    const LockedScratch locked(scratch, body);
    const auto found = find_nearest(*bodies.field_of(other(body)), *bodies.shell_of(body),
                                    pose.field_from_shell(body), max_distance, *locked);
    if (!found || (nearest && found->depth <= nearest->depth)) return;
    nearest = found;
    shell_body = body;
  };
  for (const PairBody body : roles.shell_bodies) ask(body);
  const bool is_apart = !nearest || nearest->depth <= 0.0f;
  const PairBody inner = other(roles.shell_bodies[0]);
  if (roles.may_swap && is_apart && is_enclosed(bodies, pose, inner)) ask(inner);
  if (roles.asks_inside && is_apart) {
    for (const auto& [body, contact] :
         find_inner_contacts(bodies, pose, std::min<float>(max_distance, 0.0f))) {
      if (nearest && contact.depth <= nearest->depth) continue;
      nearest = contact;
      shell_body = body;
    }
  }
  if (!nearest) return std::nullopt;
  const WorldContact world = to_world(*nearest, shell_body, pose);
  return Nearest{0.0 - static_cast<double>(nearest->depth), to_coordinates(world.point_a),
                 to_coordinates(world.point_b), to_coordinates(world.normal),
                 shell_body == PairBody::kA};
}

}  // namespace

void bind_distance(nb::module_& module) {
  module.def("distance", &distance, nb::arg("field_a"), nb::arg("model_a").none(),
             nb::arg("field_b"), nb::arg("model_b").none(), nb::arg("a_pose").none(),
             nb::arg("b_pose").none(), nb::arg("shells"), nb::arg("max_distance"),
             nb::arg("scratch").none(), InOrdinaryFloats(),
             "Return distance, point on a, point on b, normal, and whether a's shell is nearest; "
             "or None.");
}

}  // namespace voxshell::python
