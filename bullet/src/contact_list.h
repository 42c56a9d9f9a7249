#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "voxshell/contacts.h"

// What every step does with its list of contacts, without a branch for each: processors would guess
// every few of them wrong.

namespace voxshell::bullet {

/// The index of the contact with the largest score, the first of equals. Not empty.
template <class Score>
std::size_t find_largest(std::span<const Contact> contacts, const Score& score) {
  std::size_t largest = 0;
  float most = -std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const float value = score(contacts[i]);
    largest = value > most ? i : largest;
    most = value > most ? value : most;
  }
  return largest;
}

inline const Contact& find_deepest(std::span<const Contact> contacts) {
  return contacts[find_largest(contacts, [](const Contact& contact) { return contact.depth; })];
}

/// The index of the first of `contacts`, ascending by id, whose id is not smaller.
inline std::size_t find_from_id(std::span<const Contact> contacts, std::uint32_t id) {
  std::size_t begin = 0;
  for (std::size_t count = contacts.size(); count > 0;) {
    const std::size_t half = (count + 1) / 2;
    begin += contacts[begin + half - 1].id < id ? half : 0;
    count -= half;
  }
  return begin;
}

/// Whether one of `contacts`, ascending by id, has the id.
inline bool has_id(std::span<const Contact> contacts, std::uint32_t id) {
  const std::size_t found = find_from_id(contacts, id);
  return found < contacts.size() && contacts[found].id == id;
}

/// Merges `others` into `contacts`, both ascending by id, except those whose ids are taken.
inline void merge_by_id(std::span<const Contact> others, std::vector<Contact>& contacts) {
  const auto middle = static_cast<std::ptrdiff_t>(contacts.size());
  for (const Contact& other : others) {
    if (!has_id(std::span(contacts).first(static_cast<std::size_t>(middle)), other.id)) {
      contacts.push_back(other);
    }
  }
  std::ranges::inplace_merge(contacts, contacts.begin() + middle, {}, &Contact::id);
}

/// Leaves those of `values` of which `is_kept` says so.
template <class T, class IsKept>
void keep_if(std::vector<T>& values, const IsKept& is_kept) {
  const auto first = std::ranges::find_if_not(values, is_kept);
  auto count = static_cast<std::size_t>(first - values.begin());
  for (std::size_t i = count; i < values.size(); ++i) {
    const bool is_next = is_kept(values[i]);
    values[count] = values[i];
    count += is_next ? 1u : 0u;
  }
  values.resize(count);
}

}  // namespace voxshell::bullet
