#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>

#include "arrays.h"
#include "core_module.h"
#include "errors.h"
#include "voxshell/contacts.h"
#include "voxshell/contacts_flat.h"
#include "voxshell/manifold.h"
#include "voxshell/pair.h"

namespace nb = nanobind;

namespace voxshell::python {
namespace {

using SharedField = std::shared_ptr<const Field>;
using SharedShell = std::shared_ptr<const PointShell>;
/// None is the identity.
using OptionalPose = std::optional<PoseArray>;

Pose read_pose(const OptionalPose& pose, const char* name) {
  if (!pose) return {};
  std::array<double, 16> matrix{};
  std::copy_n(pose->data(), matrix.size(), matrix.begin());
  return unwrap(Pose::from_matrix(matrix), name);
}

/// One body's shell against the other's field.
struct Query {
  PairBody shell_body;
  SharedField field;
  SharedShell shell;
  Pose world_from_shell;
  Pose field_from_shell;
};

Query prepare(const SharedField& field_a, const SharedShell& shell_a, const SharedField& field_b,
              const SharedShell& shell_b, const OptionalPose& a_pose, const OptionalPose& b_pose,
              ShellChoice choice) {
  const Pose world_from_a = read_pose(a_pose, "a_pose");
  const Pose world_from_b = read_pose(b_pose, "b_pose");
  const PairBody shell_body =
      unwrap(choose_shell({field_a.get(), shell_a.get()}, {field_b.get(), shell_b.get()}, choice));
  if (shell_body == PairBody::kA) {
    return {shell_body, field_b, shell_a, world_from_a, world_from_b.inverse() * world_from_a};
  }
  return {shell_body, field_a, shell_b, world_from_b, world_from_a.inverse() * world_from_b};
}

/// Contacts in the world frame. The arrays are parallel; `contacts` are the core's own, from which
/// subsets are chosen.
struct ContactSet {
  PairBody shell_body;
  SharedShell shell;
  Pose world_from_shell;
  int level;
  std::vector<Contact> contacts;
  std::vector<Vec3> points_a;
  std::vector<Vec3> points_b;
  std::vector<Vec3> normals;
  std::vector<double> depths;
  std::vector<std::int64_t> ids;
  std::vector<std::int64_t> segments;
};

ContactSet make_contact_set(PairBody shell_body, SharedShell shell, const Pose& world_from_shell,
                            int level, std::vector<Contact> contacts) {
  ContactSet set{shell_body,
                 std::move(shell),
                 world_from_shell,
                 level,
                 std::move(contacts),
                 {},
                 {},
                 {},
                 {},
                 {},
                 {}};
  const std::size_t count = set.contacts.size();
  set.points_a.reserve(count);
  set.points_b.reserve(count);
  set.normals.reserve(count);
  set.depths.reserve(count);
  set.ids.reserve(count);
  set.segments.reserve(count);
  const bool shell_is_a = shell_body == PairBody::kA;
  for (const Contact& contact : set.contacts) {
    const auto depth = static_cast<double>(contact.depth);
    const Vec3 on_shell = world_from_shell.transform_point(static_cast<Vec3>(contact.point));
    const Vec3 outwards = world_from_shell.rotate(static_cast<Vec3>(contact.normal));
    // The field's outward normal leads from the shell's point to the field's surface. The contact's
    // normal is on b and points towards a; subtracting from zero leaves no negative zeros.
    const Vec3 on_field = on_shell + depth * outwards;
    set.points_a.push_back(shell_is_a ? on_shell : on_field);
    set.points_b.push_back(shell_is_a ? on_field : on_shell);
    set.normals.push_back(shell_is_a ? outwards + Vec3{} : Vec3{} - outwards);
    set.depths.push_back(depth);
    set.ids.push_back(contact.id);
    set.segments.push_back(set.shell->tree().segment(contact.id, level));
  }
  return set;
}

enum class Search { kTree, kFlat };

template <Search kSearch>
ContactSet contacts(const SharedField& field_a, const SharedShell& shell_a,
                    const SharedField& field_b, const SharedShell& shell_b,
                    const OptionalPose& a_pose, const OptionalPose& b_pose, ShellChoice choice,
                    float margin, int level) {
  Query query = prepare(field_a, shell_a, field_b, shell_b, a_pose, b_pose, choice);
  const nb::gil_scoped_release released;
  std::vector<Contact> found;
  if constexpr (kSearch == Search::kTree) {
    QueryScratch scratch;
    const auto contacts = find_contacts(*query.field, *query.shell, query.field_from_shell,
                                        {.margin = margin}, scratch);
    found.assign(contacts.begin(), contacts.end());
  } else {
    found =
        find_contacts_flat(*query.field, *query.shell, query.field_from_shell, {.margin = margin});
  }
  return make_contact_set(query.shell_body, std::move(query.shell), query.world_from_shell, level,
                          std::move(found));
}

bool collide(const SharedField& field_a, const SharedShell& shell_a, const SharedField& field_b,
             const SharedShell& shell_b, const OptionalPose& a_pose, const OptionalPose& b_pose,
             ShellChoice choice, float margin) {
  const Query query = prepare(field_a, shell_a, field_b, shell_b, a_pose, b_pose, choice);
  const nb::gil_scoped_release released;
  return collides(*query.field, *query.shell, query.field_from_shell, margin);
}

ContactSet subset(const ContactSet& set, std::span<const Contact> from,
                  std::span<const std::uint32_t> indices) {
  std::vector<Contact> chosen;
  chosen.reserve(indices.size());
  for (const std::uint32_t index : indices) chosen.push_back(from[index]);
  return make_contact_set(set.shell_body, set.shell, set.world_from_shell, set.level,
                          std::move(chosen));
}

ContactSet manifold(const ContactSet& set, std::size_t max_points) {
  return subset(set, set.contacts, select_manifold(set.contacts, max_points).chosen());
}

ContactSet deepest_per_segment(const ContactSet& set) {
  // The core expects ids to ascend, which those of a manifold do not.
  std::vector<Contact> ascending = set.contacts;
  std::sort(ascending.begin(), ascending.end(),
            [](const Contact& a, const Contact& b) { return a.id < b.id; });
  std::vector<std::uint32_t> deepest;
  select_deepest_per_segment(ascending, set.shell->tree(), set.level, deepest);
  return subset(set, ascending, deepest);
}

template <class Function>
void def_contacts(nb::module_& module, const char* name, Function function, const char* doc) {
  module.def(name, function, nb::arg("field_a"), nb::arg("shell_a").none(), nb::arg("field_b"),
             nb::arg("shell_b").none(), nb::arg("a_pose").none(), nb::arg("b_pose").none(),
             nb::arg("choice"), nb::arg("margin"), nb::arg("level"), doc);
}

}  // namespace

void bind_contacts(nb::module_& module) {
  nb::enum_<ShellChoice>(module, "ShellChoice")
      .value("AUTOMATIC", ShellChoice::kAutomatic)
      .value("A", ShellChoice::kA)
      .value("B", ShellChoice::kB);

  nb::class_<ContactSet>(module, "ContactSet", "Contacts of a pair, world frame.")
      .def("__len__", [](const ContactSet& s) { return s.contacts.size(); })
      .def_prop_ro("points_a",
                   [](const ContactSet& s) { return view_rows<double, 3>(std::span(s.points_a)); })
      .def_prop_ro("points_b",
                   [](const ContactSet& s) { return view_rows<double, 3>(std::span(s.points_b)); })
      .def_prop_ro("normals",
                   [](const ContactSet& s) { return view_rows<double, 3>(std::span(s.normals)); })
      .def_prop_ro("depths", [](const ContactSet& s) { return view(std::span(s.depths)); })
      .def_prop_ro("ids", [](const ContactSet& s) { return view(std::span(s.ids)); })
      .def_prop_ro("segments", [](const ContactSet& s) { return view(std::span(s.segments)); })
      .def_prop_ro("shell_is_a", [](const ContactSet& s) { return s.shell_body == PairBody::kA; })
      .def("manifold", &manifold, nb::arg("max_points"), "At most 4 of them, in the order chosen.")
      .def("deepest_per_segment", &deepest_per_segment, "Ascending by id.");

  def_contacts(module, "contacts", &contacts<Search::kTree>, "By the point-sphere tree.");
  def_contacts(module, "contacts_flat", &contacts<Search::kFlat>, "By the flat loop.");
  module.def("collide", &collide, nb::arg("field_a"), nb::arg("shell_a").none(), nb::arg("field_b"),
             nb::arg("shell_b").none(), nb::arg("a_pose").none(), nb::arg("b_pose").none(),
             nb::arg("choice"), nb::arg("margin"));
}

}  // namespace voxshell::python
