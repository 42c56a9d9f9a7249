#include "contact_list.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace voxshell::bullet::contact_list_test {
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

TEST(ContactList, MergesByIdAllWhoseIdsAreFree) {
  std::vector<Contact> contacts = make_contacts(4);  // 2, 5, 8, 11
  std::vector<Contact> others(4);
  for (std::size_t i = 0; i < others.size(); ++i) {
    others[i].id = static_cast<std::uint32_t>(4 * i);  // 0, 4, 8, 12
    others[i].depth = 1.0f;
  }
  merge_by_id(others, contacts);
  std::vector<std::uint32_t> ids;
  for (const Contact& contact : contacts) ids.push_back(contact.id);
  EXPECT_EQ(ids, (std::vector<std::uint32_t>{0, 2, 4, 5, 8, 11, 12}));
  EXPECT_LT(contacts[4].depth, 0.0f);
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
}  // namespace voxshell::bullet::contact_list_test
