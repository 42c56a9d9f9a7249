#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include <nanobind/stl/array.h>
#include <nanobind/stl/tuple.h>

#include "build_watch.h"
#include "contact_set.h"
#include "core_module.h"
#include "in_ordinary_floats.h"
#include "interpreter_lock.h"
#include "pose_arrays.h"
#include "posed_pair.h"
#include "query_scratch.h"
#include "voxshell/distance.h"
#include "voxshell/parallel.h"

namespace nb = nanobind;

namespace voxshell::python {
namespace {

using Coordinates = std::array<double, 3>;

Coordinates to_coordinates(const Vec3& v) { return {v.x, v.y, v.z}; }

/// Distance, point on a, point on b, normal, and whether the element belongs to a's shell.
using Nearest = std::tuple<double, Coordinates, Coordinates, Coordinates, bool>;

struct NearestElement {
  Contact contact;
  PairBody shell_body;
};

/// @param ask_shell  Returns find_nearest() of one of the shells.
template <class AskShell>
std::optional<NearestElement> find_in_pose(const Bodies& bodies, const PairPose& pose,
                                           const Roles& roles, float max_distance,
                                           const AskShell& ask_shell) {
  std::optional<NearestElement> nearest;
  const auto take = [&](PairBody body, const std::optional<Contact>& found) {
    if (!found || (nearest && found->depth <= nearest->contact.depth)) return;
    nearest = NearestElement{*found, body};
  };
  for (const PairBody body : roles.shell_bodies) take(body, ask_shell(body));
  const bool is_apart = !nearest || nearest->contact.depth <= 0.0f;
  const PairBody inner = other(roles.shell_bodies[0]);
  if (roles.may_swap && is_apart && is_enclosed(bodies, pose, inner)) take(inner, ask_shell(inner));
  if (roles.asks_inside && is_apart) {
    for (const auto& [body, contact] :
         find_inner_contacts(bodies, pose, std::min<float>(max_distance, 0.0f))) {
      take(body, contact);
    }
  }
  return nearest;
}

std::optional<Contact> find_nearest_of(const Bodies& bodies, const PairPose& pose, PairBody body,
                                       float max_distance, QueryScratch& scratch) {
  return find_nearest(*bodies.field_of(other(body)), *bodies.shell_of(body),
                      pose.field_from_shell(body), max_distance, scratch);
}

/// Apart by so much; negative where the bodies overlap.
double distance_of(const NearestElement& nearest) {
  return 0.0 - static_cast<double>(nearest.contact.depth);
}

std::optional<Nearest> distance(const Field& field_a, const Model* model_a, const Field& field_b,
                                const Model* model_b, const OptionalPose& a_pose,
                                const OptionalPose& b_pose, ShellChoice shells,
                                RoundedInside max_distance, SharedScratch* scratch) {
  const Bodies bodies{field_a, model_a, field_b, model_b};
  const PairPose pose{read_pose(a_pose, "a_pose"), read_pose(b_pose, "b_pose")};
  const Roles roles = choose_roles(bodies, shells);
  const ReleasedInterpreter released;
  const auto nearest = find_in_pose(bodies, pose, roles, max_distance, [&](PairBody body) {
    const LockedScratch locked(scratch, body);
    return find_nearest_of(bodies, pose, body, max_distance, *locked);
  });
  if (!nearest) return std::nullopt;
  const WorldContact world = to_world(nearest->contact, nearest->shell_body, pose);
  return Nearest{distance_of(*nearest), to_coordinates(world.point_a),
                 to_coordinates(world.point_b), to_coordinates(world.normal),
                 nearest->shell_body == PairBody::kA};
}

/// Poses that one thread takes at a time: enough to share a scratch, few enough to share the work.
constexpr std::size_t kPosesPerTask = 64;

nb::ndarray<nb::numpy, double, nb::ndim<1>> distance_batch(
    const Field& field_a, const Model* model_a, const Field& field_b, const Model* model_b,
    std::size_t count, const OptionalPoses& a_poses, const OptionalPoses& b_poses,
    ShellChoice shells, RoundedInside max_distance, unsigned threads, nb::handle progress) {
  const Bodies bodies{field_a, model_a, field_b, model_b};
  const std::vector<Pose> world_from_a = read_poses(a_poses, count, "a_poses");
  const std::vector<Pose> world_from_b = read_poses(b_poses, count, "b_poses");
  const Roles roles = choose_roles(bodies, shells);
  auto found =
      std::make_unique<std::vector<double>>(count, std::numeric_limits<double>::infinity());
  const auto ask = [&](std::size_t begin, std::size_t end) {
    std::array<QueryScratch, 2> scratches;
    for (std::size_t i = begin; i < end; ++i) {
      const PairPose pose{world_from_a[i], world_from_b[i]};
      const auto nearest = find_in_pose(bodies, pose, roles, max_distance, [&](PairBody body) {
        QueryScratch& scratch = scratches[body == PairBody::kA ? 0 : 1];
        return find_nearest_of(bodies, pose, body, max_distance, scratch);
      });
      if (nearest) (*found)[i] = distance_of(*nearest);
    }
  };
  BuildWatch watch(progress);
  {
    const ReleasedInterpreter released;
    const Progress report = [&](std::string_view stage, double fraction) {
      return watch.report(stage, fraction);
    };
    parallel_for_ranges(count, kPosesPerTask, threads, "distances", report, ask);
  }
  watch.rethrow();
  double* const values = found->data();
  const nb::capsule owner(found.release(),
                          [](void* p) noexcept { delete static_cast<std::vector<double>*>(p); });
  return nb::ndarray<nb::numpy, double, nb::ndim<1>>(values, {count}, owner);
}

}  // namespace

void bind_distance(nb::module_& module) {
  module.def("distance", &distance, nb::arg("field_a"), nb::arg("model_a").none(),
             nb::arg("field_b"), nb::arg("model_b").none(), nb::arg("a_pose").none(),
             nb::arg("b_pose").none(), nb::arg("shells"), nb::arg("max_distance"),
             nb::arg("scratch").none(), InOrdinaryFloats(),
             "Return distance, point on a, point on b, normal, and whether a's shell is nearest; "
             "or None.");
  module.def("distance_batch", &distance_batch, nb::arg("field_a"), nb::arg("model_a").none(),
             nb::arg("field_b"), nb::arg("model_b").none(), nb::arg("count"),
             nb::arg("a_poses").none(), nb::arg("b_poses").none(), nb::arg("shells"),
             nb::arg("max_distance"), nb::arg("threads"), nb::arg("progress").none(),
             InOrdinaryFloats(), "Return (k,) float64; infinite where nothing is near enough.");
}

}  // namespace voxshell::python
