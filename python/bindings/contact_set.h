#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "posed_pair.h"

namespace voxshell::python {

/// A contact with the body whose shell it belongs to.
struct ShellContact {
  PairBody shell_body;
  Contact contact;
};

/// Contacts in the world frame as parallel arrays.
struct ContactArrays {
  std::vector<Vec3> points_a;
  std::vector<Vec3> points_b;
  std::vector<Vec3> normals;
  std::vector<double> depths;
  std::vector<std::int64_t> ids;
  std::vector<std::int64_t> segments;
  std::vector<std::uint8_t> shells;  ///< 0: a's shell, 1: b's shell
  std::vector<std::uint8_t> inner;   ///< 1: at a place deep inside its body

  void reserve(std::size_t count);
  void append(const ShellContact& of_shell, const Bodies& bodies, const PairPose& pose, int level);
};

/// Properties that the contacts of one pose share.
struct ContactScene {
  SharedBodies bodies;
  PairPose pose;
  int level;
  Role role;  ///< whose points were tested
};

/// Contacts of one pose. The core's contacts are kept, to choose subsets from.
struct ContactSet {
  ContactScene scene;
  bool is_exact = true;
  double depth_bound = -std::numeric_limits<double>::infinity();
  std::vector<ShellContact> contacts;
  ContactArrays arrays;
};

ContactSet make_contact_set(ContactScene scene, std::vector<ShellContact> contacts);

inline void append(std::vector<ShellContact>& to, PairBody shell_body,
                   std::span<const Contact> contacts) {
  to.reserve(to.size() + contacts.size());
  for (const Contact& contact : contacts) to.push_back({shell_body, contact});
}

/// The contacts of inner points that are inside the other body; a's before b's.
std::vector<ShellContact> find_inner_contacts(const Bodies& bodies, const PairPose& pose,
                                              float margin);

/// The contacts that select_manifold() chooses from the set, in the order of choice.
ContactSet select_manifold(const ContactSet& set, std::size_t max_points);

/// The deepest of several shells' contacts, each in ascending order of ids; the first if equal.
void keep_deepest(std::vector<ShellContact>& contacts, std::size_t max_points);

}  // namespace voxshell::python
