#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "voxshell/contacts.h"
#include "voxshell/contacts_flat.h"
#include "voxshell/manifold.h"

namespace voxshell::test_support {

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
}

}  // namespace voxshell::test_support
