#include "contact_set.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "contact_arrays.h"
#include "core_module.h"
#include "in_ordinary_floats.h"
#include "voxshell/ambiguity.h"
#include "voxshell/manifold.h"

namespace nb = nanobind;

namespace voxshell::python {

void ContactArrays::reserve(std::size_t count) {
  points_a.reserve(count);
  points_b.reserve(count);
  normals.reserve(count);
  depths.reserve(count);
  ids.reserve(count);
  segments.reserve(count);
  shells.reserve(count);
  inner.reserve(count);
}

void ContactArrays::append(const ShellContact& of_shell, const Bodies& bodies, const PairPose& pose,
                           int level) {
  const auto& [shell_body, contact] = of_shell;
  const WorldContact world = to_world(contact, shell_body, pose);
  points_a.push_back(world.point_a);
  points_b.push_back(world.point_b);
  normals.push_back(world.normal);
  depths.push_back(static_cast<double>(contact.depth));
  ids.push_back(contact.id);
  const PointShell& shell = *bodies.shell_of(shell_body);
  const bool is_inner = contact.id >= shell.element_count();
  segments.push_back(is_inner ? 0 : shell.segment_of(contact.id, level));
  inner.push_back(is_inner ? 1 : 0);
  shells.push_back(shell_body == PairBody::kA ? 0 : 1);
}

ContactSet make_contact_set(ContactScene scene, std::vector<ShellContact> contacts) {
  ContactSet set{.scene = std::move(scene), .contacts = std::move(contacts), .arrays = {}};
  set.arrays.reserve(set.contacts.size());
  for (const ShellContact& contact : set.contacts) {
    set.arrays.append(contact, set.scene.bodies.view(), set.scene.pose, set.scene.level);
  }
  return set;
}

std::vector<ShellContact> find_inner_contacts(const Bodies& bodies, const PairPose& pose,
                                              float margin) {
  std::vector<ShellContact> found;
  for (const PairBody body : {PairBody::kA, PairBody::kB}) {
    const auto contact = find_inner_contact(bodies.participant(body), *bodies.field_of(other(body)),
                                            pose.field_from_shell(body), margin);
    if (contact) found.push_back({body, *contact});
  }
  return found;
}

void keep_deepest(std::vector<ShellContact>& contacts, std::size_t max_points) {
  if (contacts.size() <= max_points) return;
  std::vector<std::size_t> order(contacts.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    return contacts[i].contact.depth > contacts[j].contact.depth;
  });
  order.resize(max_points);
  std::sort(order.begin(), order.end());
  std::vector<ShellContact> kept;
  kept.reserve(max_points);
  for (const std::size_t i : order) kept.push_back(contacts[i]);
  contacts = std::move(kept);
}

namespace {

ContactSet subset(const ContactSet& set, std::vector<ShellContact> chosen) {
  ContactSet result = make_contact_set(set.scene, std::move(chosen));
  result.is_exact = set.is_exact;
  result.depth_bound = set.depth_bound;
  return result;
}

/// The contacts of all shells in one frame: the shell's frame for a single shell, a's for both.
std::vector<Contact> in_one_frame(const ContactSet& set) {
  std::vector<Contact> contacts;
  contacts.reserve(set.contacts.size());
  const bool is_merged = set.scene.role == Role::kBoth;
  const Pose a_from_b = set.scene.pose.field_from_shell(PairBody::kB);
  for (const auto& [shell_body, contact] : set.contacts) {
    contacts.push_back(contact);
    if (!is_merged || shell_body == PairBody::kA) continue;
    Vec3f& point = contacts.back().point;
    point = static_cast<Vec3f>(a_from_b.transform_point(static_cast<Vec3>(point)));
  }
  return contacts;
}

ContactSet deepest_per_segment(const ContactSet& set) {
  std::vector<ShellContact> chosen;
  for (const PairBody shell_body : {PairBody::kA, PairBody::kB}) {
    std::vector<Contact> of_shell;
    for (const ShellContact& c : set.contacts) {
      if (c.shell_body == shell_body) of_shell.push_back(c.contact);
    }
    if (of_shell.empty()) continue;
    const PointShell& shell = *set.scene.bodies.shell_of(shell_body);
    if (of_shell.front().id >= shell.element_count()) {
      chosen.push_back({shell_body, of_shell.front()});
      continue;
    }
    // The core expects ascending ids, but a manifold's order differs.
    std::sort(of_shell.begin(), of_shell.end(),
              [](const Contact& a, const Contact& b) { return a.id < b.id; });
    std::vector<std::uint32_t> deepest;
    select_deepest_per_segment(of_shell, shell, set.scene.level, deepest);
    for (const std::uint32_t i : deepest) chosen.push_back({shell_body, of_shell[i]});
  }
  return subset(set, std::move(chosen));
}

nb::ndarray<nb::numpy, bool, nb::ndim<1>> find_ambiguous(const ContactSet& set) {
  const std::size_t count = set.contacts.size();
  auto* owned = new bool[count];
  const nb::capsule owner(owned, [](void* p) noexcept { delete[] static_cast<bool*>(p); });
  const Bodies bodies = set.scene.bodies.view();
  for (std::size_t i = 0; i < count; ++i) {
    const auto& [shell_body, contact] = set.contacts[i];
    owned[i] =
        set.arrays.inner[i] != 0 || is_ambiguous(contact, *bodies.field_of(other(shell_body)),
                                                 set.scene.pose.field_from_shell(shell_body));
  }
  return nb::ndarray<nb::numpy, bool, nb::ndim<1>>(owned, {count}, owner);
}

}  // namespace

ContactSet select_manifold(const ContactSet& set, std::size_t max_points) {
  std::vector<ShellContact> chosen;
  const ManifoldPoints points = voxshell::select_manifold(in_one_frame(set), max_points);
  for (const std::uint32_t index : points.chosen()) chosen.push_back(set.contacts[index]);
  return subset(set, std::move(chosen));
}

void bind_contact_set(nb::module_& module) {
  nb::enum_<ShellChoice>(module, "Shells")
      .value("AUTOMATIC", ShellChoice::kAutomatic)
      .value("FEWEST", ShellChoice::kFewest)
      .value("A", ShellChoice::kA)
      .value("B", ShellChoice::kB)
      .value("BOTH", ShellChoice::kBoth);

  nb::enum_<Role>(module, "Role")
      .value("A", Role::kA)
      .value("B", Role::kB)
      .value("BOTH", Role::kBoth);

  nb::class_<ContactSet> set(module, "ContactSet", "Contacts of a pair, world frame.");
  def_contact_arrays(set);
  set.def("__len__", [](const ContactSet& s) { return s.contacts.size(); })
      .def_prop_ro("role", [](const ContactSet& s) { return s.scene.role; })
      .def("find_ambiguous", &find_ambiguous, InOrdinaryFloats(),
           "Return for each contact whether its depth and normal are ambiguous.")
      .def_ro("exact", &ContactSet::is_exact)
      .def_ro("depth_bound", &ContactSet::depth_bound)
      .def("manifold", &select_manifold, nb::arg("max_points"), InOrdinaryFloats(),
           "Return at most 4 contacts, in the order of choice.")
      .def("deepest_per_segment", &deepest_per_segment, InOrdinaryFloats(),
           "Return those of a's shell, then of b's, each in ascending order of ids.");
}

}  // namespace voxshell::python
