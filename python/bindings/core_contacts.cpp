#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include <nanobind/stl/tuple.h>

#include "contact_set.h"
#include "core_module.h"
#include "errors.h"
#include "in_ordinary_floats.h"
#include "interpreter_lock.h"
#include "query_scratch.h"
#include "voxshell/contacts.h"
#include "voxshell/contacts_flat.h"
#include "voxshell/manifold.h"

namespace nb = nanobind;

namespace voxshell::python {
namespace {

enum class Search { kTree, kFlat };

/// Queries one shell after another and collects their contacts.
template <Search kSearch>
class Asking {
 public:
  Asking(const Bodies& bodies, const PairPose& pose, const ContactOptions& options,
         std::optional<std::size_t> budget, SharedScratch* scratch)
      : bodies_(bodies), pose_(pose), options_(options), budget_(budget), scratch_(scratch) {}

  void ask(PairBody shell_body) {
    const Field& field = *bodies_.field_of(other(shell_body));
    const PointShell& shell = *bodies_.shell_of(shell_body);
    const Pose field_from_shell = pose_.field_from_shell(shell_body);
    if constexpr (kSearch == Search::kFlat) {
      append(contacts, shell_body, find_contacts_flat(field, shell, field_from_shell, options_));
      return;
    }
    const LockedScratch scratch(scratch_, shell_body);
    if (!budget_) {
      append(contacts, shell_body,
             find_contacts(field, shell, field_from_shell, options_, *scratch));
      return;
    }
    const BudgetedContacts found =
        find_contacts_within_budget(field, shell, field_from_shell, options_, *budget_, *scratch);
    append(contacts, shell_body, found.contacts);
    is_exact = is_exact && found.is_exact;
    depth_bound = std::max(depth_bound, static_cast<double>(found.depth_bound));
  }

  std::vector<ShellContact> contacts;
  bool is_exact = true;
  double depth_bound = -std::numeric_limits<double>::infinity();

 private:
  Bodies bodies_;
  const PairPose& pose_;
  const ContactOptions& options_;
  std::optional<std::size_t> budget_;
  SharedScratch* scratch_;
};

template <Search kSearch>
ContactSet contacts(const SharedField& field_a, const SharedModel& model_a,
                    const SharedField& field_b, const SharedModel& model_b,
                    const OptionalPose& a_pose, const OptionalPose& b_pose, ShellChoice shells,
                    RoundedInside margin, int level, std::optional<std::size_t> max_points,
                    std::optional<std::size_t> budget, SharedScratch* scratch) {
  const SharedBodies bodies{field_a, model_a, field_b, model_b};
  const PairPose pose{read_pose(a_pose, "a_pose"), read_pose(b_pose, "b_pose")};
  const Roles roles = choose_roles(bodies.view(), shells);
  const ReleasedInterpreter released;
  const ContactOptions options{.margin = margin, .max_points = max_points.value_or(SIZE_MAX)};
  Asking<kSearch> asking(bodies.view(), pose, options, budget, scratch);
  for (const PairBody shell_body : roles.shell_bodies) asking.ask(shell_body);
  Role role = roles.role();
  const PairBody inner = other(roles.shell_bodies[0]);
  if (roles.may_swap && options.max_points > 0 && asking.contacts.empty() &&
      is_enclosed(bodies.view(), pose, inner)) {
    asking.ask(inner);
    role = role_of(inner);
  }
  // After an incomplete search, it is not certain that there are no contacts.
  const bool is_empty = asking.contacts.empty() && asking.is_exact;
  if (roles.asks_inside && options.max_points > 0 && is_empty) {
    asking.contacts = find_inner_contacts(bodies.view(), pose, margin);
  }
  keep_deepest(asking.contacts, options.max_points);
  ContactSet set = make_contact_set({bodies, pose, level, role}, std::move(asking.contacts));
  set.is_exact = asking.is_exact;
  set.depth_bound = asking.depth_bound;
  return set;
}

/// What `find` chooses from each shell's contacts without listing the others.
template <class Find>
ContactSet pick_contacts(const SharedBodies& bodies, const PairPose& pose, const Roles& roles,
                         float margin, int level, SharedScratch* scratch, const Find& find) {
  std::vector<ShellContact> found;
  Role role = roles.role();
  const auto ask = [&](PairBody body) {
    const LockedScratch locked(scratch, body);
    append(found, body,
           find(*bodies.field_of(other(body)), *bodies.shell_of(body), pose.field_from_shell(body),
                *locked));
  };
  for (const PairBody body : roles.shell_bodies) ask(body);
  const PairBody inner = other(roles.shell_bodies[0]);
  if (roles.may_swap && found.empty() && is_enclosed(bodies.view(), pose, inner)) {
    ask(inner);
    role = role_of(inner);
  }
  if (roles.asks_inside && found.empty()) {
    found = find_inner_contacts(bodies.view(), pose, margin);
  }
  return make_contact_set({bodies, pose, level, role}, std::move(found));
}

ContactSet manifold(const SharedField& field_a, const SharedModel& model_a,
                    const SharedField& field_b, const SharedModel& model_b,
                    const OptionalPose& a_pose, const OptionalPose& b_pose, ShellChoice shells,
                    RoundedInside margin, std::size_t max_points, SharedScratch* scratch) {
  const SharedBodies bodies{field_a, model_a, field_b, model_b};
  const PairPose pose{read_pose(a_pose, "a_pose"), read_pose(b_pose, "b_pose")};
  const Roles roles = choose_roles(bodies.view(), shells);
  const ReleasedInterpreter released;
  if (roles.role() == Role::kBoth) {
    // The second point of a manifold depends on the first, which may belong to the other shell.
    const auto list = [&](const Field& field, const PointShell& shell, const Pose& field_from_shell,
                          QueryScratch& own) {
      return find_contacts(field, shell, field_from_shell, {.margin = margin}, own);
    };
    return select_manifold(pick_contacts(bodies, pose, roles, margin, 1, scratch, list),
                           max_points);
  }
  const auto find = [&](const Field& field, const PointShell& shell, const Pose& field_from_shell,
                        QueryScratch& own) {
    return find_manifold(field, shell, field_from_shell, margin, own, max_points);
  };
  return pick_contacts(bodies, pose, roles, margin, 1, scratch, find);
}

ContactSet deepest_per_segment(const SharedField& field_a, const SharedModel& model_a,
                               const SharedField& field_b, const SharedModel& model_b,
                               const OptionalPose& a_pose, const OptionalPose& b_pose,
                               ShellChoice shells, RoundedInside margin, int level,
                               SharedScratch* scratch) {
  const SharedBodies bodies{field_a, model_a, field_b, model_b};
  const PairPose pose{read_pose(a_pose, "a_pose"), read_pose(b_pose, "b_pose")};
  const Roles roles = choose_roles(bodies.view(), shells);
  const ReleasedInterpreter released;
  const auto find = [&](const Field& field, const PointShell& shell, const Pose& field_from_shell,
                        QueryScratch& own) {
    return find_deepest_per_segment(field, shell, field_from_shell, level, margin, own);
  };
  return pick_contacts(bodies, pose, roles, margin, level, scratch, find);
}

bool collide(const Field& field_a, const Model* model_a, const Field& field_b, const Model* model_b,
             const OptionalPose& a_pose, const OptionalPose& b_pose, ShellChoice shells,
             RoundedInside margin) {
  const Bodies bodies{field_a, model_a, field_b, model_b};
  const PairPose pose{read_pose(a_pose, "a_pose"), read_pose(b_pose, "b_pose")};
  const Roles roles = choose_roles(bodies, shells);
  const ReleasedInterpreter released;
  const auto touches = [&](PairBody shell_body) {
    return collides(*bodies.field_of(other(shell_body)), *bodies.shell_of(shell_body),
                    pose.field_from_shell(shell_body), margin);
  };
  if (std::any_of(roles.shell_bodies.begin(), roles.shell_bodies.end(), touches)) return true;
  if (roles.asks_inside) return !find_inner_contacts(bodies, pose, margin).empty();
  const PairBody inner = other(roles.shell_bodies[0]);
  return roles.may_swap && is_enclosed(bodies, pose, inner) && touches(inner);
}

/// Role; what the role, a, b and both may miss; thickness and shortest side of the smaller body;
/// and thickness of the thinner body.
std::tuple<Role, double, double, double, double, double, double, double> role_of_pair(
    const Field& field_a, const Model* model_a, const Field& field_b, const Model* model_b,
    ShellChoice shells) {
  const Bodies bodies{field_a, model_a, field_b, model_b};
  const PairRole pair = unwrap(decide_role(bodies.a, bodies.b, shells));
  return {pair.role,         pair.miss,      pair.miss_of_a, pair.miss_of_b,
          pair.miss_of_both, pair.thickness, pair.side,      pair.wall};
}

std::tuple<double, double> bounds_of_pair(const Field& field_a, const Model* model_a,
                                          const Field& field_b, const Model* model_b, Role role) {
  const Bodies bodies{field_a, model_a, field_b, model_b};
  const PairBounds bounds = bound_pair(bodies.a, bodies.b, role);
  return {bounds.overlap, bounds.clearance};
}

template <class Function>
void def_contacts(nb::module_& module, const char* name, Function function, const char* doc) {
  module.def(name, function, nb::arg("field_a"), nb::arg("model_a").none(), nb::arg("field_b"),
             nb::arg("model_b").none(), nb::arg("a_pose").none(), nb::arg("b_pose").none(),
             nb::arg("shells"), nb::arg("margin"), nb::arg("level"), nb::arg("max_points").none(),
             nb::arg("budget").none(), nb::arg("scratch").none(), InOrdinaryFloats(), doc);
}

}  // namespace

void bind_contacts(nb::module_& module) {
  nb::class_<SharedScratch>(module, "QueryScratch",
                            "Memory of queries. Threads that share one take turns.")
      .def(nb::init<>());
  def_contacts(module, "contacts", &contacts<Search::kTree>,
               "Find contacts with the point-sphere tree.");
  def_contacts(module, "contacts_flat", &contacts<Search::kFlat>,
               "Find contacts with the flat loop.");
  module.def("manifold", &manifold, nb::arg("field_a"), nb::arg("model_a").none(),
             nb::arg("field_b"), nb::arg("model_b").none(), nb::arg("a_pose").none(),
             nb::arg("b_pose").none(), nb::arg("shells"), nb::arg("margin"), nb::arg("max_points"),
             nb::arg("scratch").none(), InOrdinaryFloats(),
             "Find a manifold by branch and bound; for both shells, from all contacts.");
  module.def("deepest_per_segment", &deepest_per_segment, nb::arg("field_a"),
             nb::arg("model_a").none(), nb::arg("field_b"), nb::arg("model_b").none(),
             nb::arg("a_pose").none(), nb::arg("b_pose").none(), nb::arg("shells"),
             nb::arg("margin"), nb::arg("level"), nb::arg("scratch").none(), InOrdinaryFloats(),
             "Find the deepest contacts by branch and bound, for each shell.");
  module.def("role", &role_of_pair, nb::arg("field_a"), nb::arg("model_a").none(),
             nb::arg("field_b"), nb::arg("model_b").none(), nb::arg("shells"), InOrdinaryFloats(),
             "Return the role, and in meters what it, a, b and both may miss, the smaller body's "
             "thickness and shortest side, and the thinner body's thickness.");
  module.def("pair_bounds", &bounds_of_pair, nb::arg("field_a"), nb::arg("model_a").none(),
             nb::arg("field_b"), nb::arg("model_b").none(), nb::arg("role"), InOrdinaryFloats(),
             "Return overlap and clearance, meters.");
  module.def("collide", &collide, nb::arg("field_a"), nb::arg("model_a").none(), nb::arg("field_b"),
             nb::arg("model_b").none(), nb::arg("a_pose").none(), nb::arg("b_pose").none(),
             nb::arg("shells"), nb::arg("margin"), InOrdinaryFloats());
}

}  // namespace voxshell::python
