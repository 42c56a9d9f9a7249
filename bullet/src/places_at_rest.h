#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "contact_list.h"
#include "voxshell/contacts.h"

namespace voxshell::bullet {

/// Where contacts of a step have slid to. `Of` is what else is known of each.
template <class Of>
class PlacesAtRest {
 public:
  struct AtRest {
    std::uint32_t id;
    bool was_there;  ///< in the step before, by that id
    float depth;     ///< meters
    Vec3 position;   ///< meters, the shell's frame
    Of of;
  };

  bool empty() const { return at_rest_.empty(); }
  const std::vector<AtRest>& all() const { return at_rest_; }

  /// A new step begins. Places are of the same surfaces as before, or `forgets` those.
  void begin(bool forgets) {
    at_rest_.swap(before_);
    if (forgets) before_.clear();
    std::ranges::sort(before_, {}, &AtRest::id);
    at_rest_.clear();
    by_x_.clear();
  }

  void add(std::uint32_t id, float depth, const Vec3& position, const Of& of) {
    const Along along{position.x, at_rest_.size()};
    by_x_.insert(std::ranges::upper_bound(by_x_, along.x, {}, &Along::x), along);
    at_rest_.push_back({id, false, depth, position, of});
  }

  /// Moves each place to the one that `go_on(place)` returns, an AtRest or none.
  template <class GoOn>
  void follow(const GoOn& go_on) {
    for (AtRest& at_rest : at_rest_) {
      if (const std::optional<AtRest> now = go_on(std::as_const(at_rest))) at_rest = *now;
    }
    for (Along& along : by_x_) along.x = at_rest_[along.index].position.x;
    std::ranges::sort(by_x_, {}, &Along::x);
  }

  const AtRest* find(const Vec3& position, double within) const {
    for (auto near = std::ranges::lower_bound(by_x_, position.x - within, {}, &Along::x);
         near != by_x_.end() && near->x <= position.x + within; ++near) {
      const AtRest& known = at_rest_[near->index];
      if (squared_length(known.position - position) <= within * within) return &known;
    }
    return nullptr;
  }

  /// Of at least one.
  const AtRest& nearest(const Vec3& position) const {
    const AtRest* nearest = &at_rest_.front();
    double least = std::numeric_limits<double>::infinity();
    const auto look_at = [&](const Along& along) {
      const double aside = along.x - position.x;
      if (aside * aside >= least) return false;
      const AtRest& known = at_rest_[along.index];
      const double squared = squared_length(known.position - position);
      if (squared < least) {
        least = squared;
        nearest = &known;
      }
      return true;
    };
    const auto middle = std::ranges::lower_bound(by_x_, position.x, {}, &Along::x);
    for (auto right = middle; right != by_x_.end() && look_at(*right); ++right) {
    }
    for (auto left = middle; left != by_x_.begin() && look_at(*std::prev(left)); --left) {
    }
    return *nearest;
  }

  /// Gives contacts the ids of those that were within a distance of them in the step before: what
  /// rolls touches with one contact, not with one after the other.
  void keep_ids(std::vector<Contact>& contacts, double within) {
    // Most have kept theirs.
    std::size_t lost = 0;
    auto now = at_rest_.begin();
    for (const AtRest& then : before_) {
      while (now != at_rest_.end() && now->id < then.id) ++now;
      if (now != at_rest_.end() && now->id == then.id) {
        now->was_there = true;
      } else {
        before_[lost++] = then;
      }
    }
    before_.resize(lost);
    if (before_.empty()) return;
    changes_.clear();
    for (AtRest& at_rest : at_rest_) {
      if (before_.empty()) break;
      if (at_rest.was_there) continue;
      const auto apart = [&](const AtRest& then) {
        return squared_length(then.position - at_rest.position);
      };
      const auto nearest = std::ranges::min_element(before_, {}, apart);
      if (apart(*nearest) > within * within) continue;
      const std::uint32_t id = nearest->id;
      before_.erase(nearest);
      if (has_id(contacts, id)) continue;
      changes_.push_back({find_from_id(contacts, at_rest.id), id});
      at_rest.id = id;
    }
    if (changes_.empty()) return;
    for (const auto& [place, id] : changes_) contacts[place].id = id;
    std::ranges::sort(contacts, {}, &Contact::id);
  }

  /// Appends the ids, ascending, each plus `first`.
  void append_ids(std::uint32_t first, std::vector<std::uint32_t>& ids) const {
    const auto before = static_cast<std::ptrdiff_t>(ids.size());
    for (const AtRest& at_rest : at_rest_) ids.push_back(first + at_rest.id);
    std::sort(ids.begin() + before, ids.end());
  }

 private:
  struct Along {
    double x;           ///< of the position
    std::size_t index;  ///< in at_rest_
  };

  std::vector<AtRest> at_rest_;
  std::vector<Along> by_x_;                                     ///< those, ascending by x
  std::vector<AtRest> before_;                                  ///< those of the step before
  std::vector<std::pair<std::size_t, std::uint32_t>> changes_;  ///< of ids, by place in the list
};

}  // namespace voxshell::bullet
