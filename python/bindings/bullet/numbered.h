#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace voxshell::python {

/// Parts of a simulation by their numbers, which ascend and are never reused. Removed parts leave
/// nothing behind. Throws std::out_of_range if there is no part with a number.
template <class Part>
class Numbered {
 public:
  struct Entry {
    std::size_t number;
    std::unique_ptr<Part> part;
  };

  /// `name` is for error messages.
  explicit Numbered(const char* name) : name_(name) {}

  std::size_t add(std::unique_ptr<Part> part) {
    entries_.push_back({next_, std::move(part)});
    return next_++;
  }
  void remove(std::size_t number) { entries_.erase(entries_.begin() + place_of(number)); }

  /// Throws if there is none.
  void check(std::size_t number) const { place_of(number); }
  Part& operator[](std::size_t number) const {
    return *entries_[static_cast<std::size_t>(place_of(number))].part;
  }
  std::vector<std::size_t> numbers() const {
    std::vector<std::size_t> numbers;
    numbers.reserve(entries_.size());
    for (const Entry& entry : entries_) numbers.push_back(entry.number);
    return numbers;
  }

  auto begin() const { return entries_.begin(); }
  auto end() const { return entries_.end(); }

 private:
  std::ptrdiff_t place_of(std::size_t number) const {
    const auto found = std::ranges::lower_bound(entries_, number, {}, &Entry::number);
    if (found == entries_.end() || found->number != number) {
      throw std::out_of_range("the world has no " + std::string(name_) + " " +
                              std::to_string(number));
    }
    return found - entries_.begin();
  }

  const char* name_;
  std::size_t next_ = 0;
  std::vector<Entry> entries_;
};

}  // namespace voxshell::python
