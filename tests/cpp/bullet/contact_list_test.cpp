#include "contact_list.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace voxshell::bullet {
namespace {

std::vector<Contact> make_contacts(std::size_t count) {
  std::vector<Contact> contacts(count);
  for (std::size_t i = 0; i < count; ++i) {
    contacts[i].id = static_cast<std::uint32_t>(3 * i + 2);
    contacts[i].depth = static_cast<float>((i * 7 + count) % 5) - 10.0f;
  }
  return contacts;
}

TEST(ContactList, FindsIdsAsBinarySearchDoes) {
  for (std::size_t count = 0; count < 20; ++count) {
    const std::vector<Contact> contacts = make_contacts(count);
    for (std::uint32_t id = 0; id < 3 * count + 5; ++id) {
      const auto expected = std::ranges::lower_bound(contacts, id, {}, &Contact::id);
      EXPECT_EQ(find_from_id(contacts, id), static_cast<std::size_t>(expected - contacts.begin()))
          << id << " of " << count;
    }
  }
}

TEST(ContactList, FindsTheFirstOfTheDeepest) {
  for (std::size_t count = 1; count < 20; ++count) {
    const std::vector<Contact> contacts = make_contacts(count);
    EXPECT_EQ(&find_deepest(contacts), &*std::ranges::max_element(contacts, {}, &Contact::depth));
  }
}

TEST(ContactList, KeepsWhatItIsToldInOrder) {
  for (std::uint32_t set = 0; set < 128; ++set) {
    std::vector<std::uint32_t> values{0, 1, 2, 3, 4, 5, 6};
    std::vector<std::uint32_t> expected = values;
    const auto is_kept = [&](std::uint32_t value) { return (set >> value & 1) != 0; };
    keep_if(values, is_kept);
    std::erase_if(expected, [&](std::uint32_t value) { return !is_kept(value); });
    EXPECT_EQ(values, expected);
  }
}

}  // namespace
}  // namespace voxshell::bullet
