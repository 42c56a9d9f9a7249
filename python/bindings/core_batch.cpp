#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "build_watch.h"
#include "contact_arrays.h"
#include "contact_set.h"
#include "core_module.h"
#include "errors.h"
#include "in_ordinary_floats.h"
#include "interpreter_lock.h"
#include "pose_arrays.h"
#include "voxshell/batch.h"

namespace nb = nanobind;

namespace voxshell::python {
namespace {

struct PosePairs {
  std::vector<Pose> world_from_a;
  std::vector<Pose> world_from_b;

  std::size_t size() const { return world_from_a.size(); }
  PairPose operator[](std::size_t i) const { return {world_from_a[i], world_from_b[i]}; }
  std::vector<Pose> field_from_shell(PairBody shell_body) const {
    std::vector<Pose> poses;
    poses.reserve(size());
    for (std::size_t i = 0; i < size(); ++i) {
      poses.push_back((*this)[i].field_from_shell(shell_body));
    }
    return poses;
  }
};

PosePairs read_pose_pairs(std::size_t count, const OptionalPoses& a_poses,
                          const OptionalPoses& b_poses) {
  return {read_poses(a_poses, count, "a_poses"), read_poses(b_poses, count, "b_poses")};
}

/// The poses without contacts in which the tested bodies may enclose others.
template <class IsEmpty>
std::vector<std::size_t> find_enclosed(const Bodies& bodies, const PosePairs& poses, PairBody inner,
                                       const IsEmpty& is_empty) {
  std::vector<std::size_t> enclosed;
  if (bodies.shell_of(inner) == nullptr) return enclosed;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (is_empty(i) && is_enclosed(bodies, poses[i], inner)) enclosed.push_back(i);
  }
  return enclosed;
}

std::vector<Pose> pick(const std::vector<Pose>& poses, const std::vector<std::size_t>& indices) {
  std::vector<Pose> picked;
  picked.reserve(indices.size());
  for (const std::size_t i : indices) picked.push_back(poses[i]);
  return picked;
}

/// Contacts of many poses, one after another.
struct ContactBatchSet {
  SharedBodies bodies;
  int level;
  PosePairs poses;
  std::vector<Role> roles;            ///< one per pose
  std::vector<std::int64_t> offsets;  ///< one more than poses
  std::vector<ShellContact> contacts;
  ContactArrays arrays;

  ContactSet at(std::size_t i) const {
    const auto begin = contacts.begin();
    return make_contact_set({bodies, poses[i], level, roles[i]},
                            {begin + offsets[i], begin + offsets[i + 1]});
  }
};

/// One shell's contacts for all poses, or for those in `of_poses`.
struct Part {
  PairBody shell_body;
  ContactBatch found;

  std::span<const Contact> at(std::size_t i) const {
    return std::span(found.contacts)
        .subspan(found.offsets[i], found.offsets[i + 1] - found.offsets[i]);
  }
};

/// `parts` has all poses, `swapped` those that `enclosed` lists.
ContactBatchSet merge(const SharedBodies& bodies, PosePairs poses, int level, float margin,
                      std::size_t max_points, Role role, bool asks_inside,
                      const std::vector<Part>& parts, const std::vector<std::size_t>& enclosed,
                      const Part& swapped) {
  ContactBatchSet set{.bodies = bodies,
                      .level = level,
                      .poses = std::move(poses),
                      .roles = {},
                      .offsets = {0},
                      .contacts = {},
                      .arrays = {}};
  std::size_t most = swapped.found.contacts.size();
  for (const Part& part : parts) most += part.found.contacts.size();
  set.contacts.reserve(most);
  set.arrays.reserve(most);
  std::vector<ShellContact> here;
  std::size_t next_enclosed = 0;
  for (std::size_t i = 0; i < set.poses.size(); ++i) {
    here.clear();
    for (const Part& part : parts) append(here, part.shell_body, part.at(i));
    const bool is_swapped = next_enclosed < enclosed.size() && enclosed[next_enclosed] == i;
    if (is_swapped) append(here, swapped.shell_body, swapped.at(next_enclosed++));
    const PairPose pose = set.poses[i];
    if (asks_inside && max_points > 0 && here.empty()) {
      here = find_inner_contacts(bodies.view(), pose, margin);
    }
    keep_deepest(here, max_points);
    for (const ShellContact& contact : here) set.arrays.append(contact, bodies.view(), pose, level);
    set.contacts.insert(set.contacts.end(), here.begin(), here.end());
    set.offsets.push_back(static_cast<std::int64_t>(set.contacts.size()));
    set.roles.push_back(is_swapped ? role_of(swapped.shell_body) : role);
  }
  return set;
}

/// Reports a stage of the core under another name.
Progress report_as(BuildWatch& watch, std::string_view name) {
  return [&watch, name](std::string_view, double fraction) { return watch.report(name, fraction); };
}

std::string_view name_stage(std::size_t roles, PairBody shell_body) {
  if (roles == 1) return "contacts";
  return shell_body == PairBody::kA ? "contacts of a's points" : "contacts of b's points";
}

constexpr std::string_view kEnclosed = "enclosed bodies";

Result<ContactBatchSet> ask_contacts(const SharedBodies& bodies, PosePairs poses,
                                     const Roles& roles, const ContactOptions& options, int level,
                                     unsigned threads, BuildWatch& watch) {
  const auto ask = [&](PairBody body, const std::vector<Pose>& of_poses, std::string_view name) {
    return find_contacts_batch(*bodies.field_of(other(body)), *bodies.shell_of(body), of_poses,
                               options, threads, report_as(watch, name));
  };
  std::vector<Part> parts;
  for (const PairBody body : roles.shell_bodies) {
    auto found =
        ask(body, poses.field_from_shell(body), name_stage(roles.shell_bodies.size(), body));
    if (!found) return found.error();
    parts.push_back({body, *std::move(found)});
  }
  std::vector<std::size_t> enclosed;
  Part swapped{other(parts[0].shell_body), {}};
  if (roles.may_swap && options.max_points > 0) {
    enclosed = find_enclosed(bodies.view(), poses, swapped.shell_body,
                             [&](std::size_t i) { return parts[0].at(i).empty(); });
  }
  if (!enclosed.empty()) {
    auto found = ask(swapped.shell_body, pick(poses.field_from_shell(swapped.shell_body), enclosed),
                     kEnclosed);
    if (!found) return found.error();
    swapped.found = *std::move(found);
  }
  return merge(bodies, std::move(poses), level, options.margin, options.max_points, roles.role(),
               roles.asks_inside, parts, enclosed, swapped);
}

ContactBatchSet contacts_batch(const SharedField& field_a, const SharedModel& model_a,
                               const SharedField& field_b, const SharedModel& model_b,
                               std::size_t count, const OptionalPoses& a_poses,
                               const OptionalPoses& b_poses, ShellChoice shells,
                               RoundedInside margin, int level,
                               std::optional<std::size_t> max_points, unsigned threads,
                               nb::handle progress) {
  const SharedBodies bodies{field_a, model_a, field_b, model_b};
  PosePairs poses = read_pose_pairs(count, a_poses, b_poses);
  const Roles roles = choose_roles(bodies.view(), shells);
  BuildWatch watch(progress);
  auto result = [&] {
    const ReleasedInterpreter released;
    const ContactOptions options{.margin = margin, .max_points = max_points.value_or(SIZE_MAX)};
    return ask_contacts(bodies, std::move(poses), roles, options, level, threads, watch);
  }();
  watch.rethrow();
  return unwrap(std::move(result));
}

Result<std::vector<char>> ask_collisions(const Bodies& bodies, const PosePairs& poses,
                                         const Roles& roles, float margin, unsigned threads,
                                         BuildWatch& watch) {
  const auto ask = [&](PairBody body, const std::vector<Pose>& of_poses, std::string_view name) {
    return collides_batch(*bodies.field_of(other(body)), *bodies.shell_of(body), of_poses, margin,
                          threads, report_as(watch, name));
  };
  std::vector<char> touches(poses.size());
  const auto add = [&](std::size_t i, char of_shell) {
    if (of_shell != 0) touches[i] = 1;
  };
  for (const PairBody body : roles.shell_bodies) {
    const auto found = ask(body, poses.field_from_shell(body), "collisions");
    if (!found) return found.error();
    for (std::size_t i = 0; i < touches.size(); ++i) add(i, (*found)[i]);
  }
  if (roles.asks_inside) {
    for (std::size_t i = 0; i < touches.size(); ++i) {
      if (touches[i] == 0) add(i, find_inner_contacts(bodies, poses[i], margin).empty() ? 0 : 1);
    }
  }
  if (!roles.may_swap) return touches;
  const PairBody inner = other(roles.shell_bodies[0]);
  const auto enclosed =
      find_enclosed(bodies, poses, inner, [&](std::size_t i) { return touches[i] == 0; });
  if (enclosed.empty()) return touches;
  const auto found = ask(inner, pick(poses.field_from_shell(inner), enclosed), kEnclosed);
  if (!found) return found.error();
  for (std::size_t i = 0; i < enclosed.size(); ++i) add(enclosed[i], (*found)[i]);
  return touches;
}

nb::ndarray<nb::numpy, bool, nb::ndim<1>> collide_batch(
    const Field& field_a, const Model* model_a, const Field& field_b, const Model* model_b,
    std::size_t count, const OptionalPoses& a_poses, const OptionalPoses& b_poses,
    ShellChoice shells, RoundedInside margin, unsigned threads, nb::handle progress) {
  const Bodies bodies{field_a, model_a, field_b, model_b};
  const PosePairs poses = read_pose_pairs(count, a_poses, b_poses);
  const Roles roles = choose_roles(bodies, shells);
  BuildWatch watch(progress);
  auto result = [&] {
    const ReleasedInterpreter released;
    return ask_collisions(bodies, poses, roles, margin, threads, watch);
  }();
  watch.rethrow();
  const std::vector<char> touches = unwrap(std::move(result));
  auto* owned = new bool[touches.size()];
  std::copy(touches.begin(), touches.end(), owned);
  const nb::capsule owner(owned, [](void* p) noexcept { delete[] static_cast<bool*>(p); });
  return nb::ndarray<nb::numpy, bool, nb::ndim<1>>(owned, {touches.size()}, owner);
}

}  // namespace

void bind_batch(nb::module_& module) {
  nb::class_<ContactBatchSet> batch(module, "ContactBatch", "Contacts of many poses of a pair.");
  def_contact_arrays(batch);
  batch.def("__len__", [](const ContactBatchSet& s) { return s.poses.size(); })
      .def_prop_ro("offsets", [](const ContactBatchSet& s) { return view(std::span(s.offsets)); })
      .def(
          "at",
          [](const ContactBatchSet& s, std::size_t i) {
            if (i >= s.poses.size()) throw nb::index_error();
            return s.at(i);
          },
          InOrdinaryFloats());

  module.def("contacts_batch", &contacts_batch, nb::arg("field_a"), nb::arg("model_a").none(),
             nb::arg("field_b"), nb::arg("model_b").none(), nb::arg("count"),
             nb::arg("a_poses").none(), nb::arg("b_poses").none(), nb::arg("shells"),
             nb::arg("margin"), nb::arg("level"), nb::arg("max_points").none(), nb::arg("threads"),
             nb::arg("progress").none(), InOrdinaryFloats(),
             "Poses are (count, 4, 4); a single pose that applies to all is (1, 4, 4).");
  module.def("collide_batch", &collide_batch, nb::arg("field_a"), nb::arg("model_a").none(),
             nb::arg("field_b"), nb::arg("model_b").none(), nb::arg("count"),
             nb::arg("a_poses").none(), nb::arg("b_poses").none(), nb::arg("shells"),
             nb::arg("margin"), nb::arg("threads"), nb::arg("progress").none(), InOrdinaryFloats(),
             "Return (k,) bool.");
}

}  // namespace voxshell::python
