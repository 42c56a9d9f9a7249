#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "voxshell/contacts.h"
#include "voxshell/contacts_flat.h"
#include "voxshell/manifold.h"

namespace voxshell::test_support {

/// Compares the deepest contacts per segment of those elements that arrive; `flat` are all
/// contacts. Returns how many arrive.
inline std::size_t expect_arriving_equal_to_flat(const Field& field, const PointShell& shell,
                                                 const Pose& pose, float margin,
                                                 std::span<const Contact> flat,
                                                 std::span<const Arrival> arrivals) {
  static QueryScratch scratch;
  std::vector<Contact> arriving;
  for (const Contact& contact : flat) {
    if (arrives_flat(field, shell, contact.id, arrivals)) arriving.push_back(contact);
  }
  std::vector<std::uint32_t> deepest;
  for (const int level : {1, 3, 4, 5, 7, 12}) {
    select_deepest_per_segment(arriving, shell, level, deepest);
    const auto found =
        find_deepest_per_segment(field, shell, pose, level, margin, scratch, arrivals);
    EXPECT_TRUE(std::ranges::equal(found, deepest, {}, {},
                                   [&](std::uint32_t index) { return arriving[index]; }))
        << "margin " << margin << ", level " << level;
  }
  return arriving.size();
}

/// Compares the tree's answer with the flat loop's, all fields and the order included.
inline void expect_equal_to_flat(const Field& field, const PointShell& shell, const Pose& pose,
                                 float margin, QueryScratch& scratch) {
  const auto contacts = find_contacts(field, shell, pose, {.margin = margin}, scratch);
  const auto flat = find_contacts_flat(field, shell, pose, {.margin = margin});
  ASSERT_EQ(contacts.size(), flat.size()) << "margin " << margin;
  for (std::size_t i = 0; i < flat.size(); ++i) ASSERT_EQ(contacts[i], flat[i]) << i;
  ASSERT_EQ(collides(field, shell, pose, margin), !flat.empty()) << "margin " << margin;

  static QueryScratch others;  // `scratch` keeps the contacts
  const auto expect_chosen = [&](std::span<const Contact> found,
                                 std::span<const std::uint32_t> chosen) {
    ASSERT_EQ(found.size(), chosen.size()) << "margin " << margin;
    for (std::size_t i = 0; i < found.size(); ++i) ASSERT_EQ(found[i], flat[chosen[i]]) << i;
  };
  expect_chosen(find_manifold(field, shell, pose, margin, others), select_manifold(flat).chosen());
  std::vector<std::uint32_t> deepest;
  for (const int level : {1, 3, 12}) {
    select_deepest_per_segment(flat, shell, level, deepest);
    expect_chosen(find_deepest_per_segment(field, shell, pose, level, margin, others), deepest);
  }
  const double size = static_cast<double>(shell.tree().spheres(1)[0].radius);
  std::vector<Arrival> arrivals;
  for (int i = 1; i <= 3; ++i) {
    // Into the field, along it and away from it.
    Pose moved = pose;
    moved.translation += 0.1 * size * Vec3{0.2 * i, i == 2 ? 1.0 : -0.3, i == 1 ? -1.0 : 0.4};
    arrivals.push_back({moved, static_cast<float>(0.03 * size * (3 - i))});
    expect_arriving_equal_to_flat(field, shell, pose, margin, flat, arrivals);
  }
}

}  // namespace voxshell::test_support
