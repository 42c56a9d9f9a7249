#pragma once

#include <cstddef>
#include <iterator>

#include "voxshell/vector.h"

namespace voxshell {

/// The points of a point-sphere tree by their ids, in the layout of queries: buckets of eight, with
/// eight x, eight y and eight z. A view that is valid as long as the tree.
class BucketPoints {
 public:
  static constexpr std::size_t kEach = 8;

  class Iterator {
   public:
    // NOLINTBEGIN(readability-identifier-naming): names that the standard library requires
    using iterator_category = std::input_iterator_tag;
    using value_type = Vec3f;
    using difference_type = std::ptrdiff_t;
    using pointer = void;
    using reference = Vec3f;
    // NOLINTEND(readability-identifier-naming)

    Iterator(const float* buckets, std::size_t id) : buckets_(buckets), id_(id) {}

    Vec3f operator*() const { return read(buckets_, id_); }
    Iterator& operator++() {
      ++id_;
      return *this;
    }
    Iterator operator++(int) { return {buckets_, id_++}; }
    friend bool operator==(const Iterator&, const Iterator&) = default;

   private:
    const float* buckets_;
    std::size_t id_;
  };

  BucketPoints(const float* buckets, std::size_t size) : buckets_(buckets), size_(size) {}

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  Vec3f operator[](std::size_t id) const { return read(buckets_, id); }
  Iterator begin() const { return {buckets_, 0}; }
  Iterator end() const { return {buckets_, size_}; }

 private:
  static Vec3f read(const float* buckets, std::size_t id) {
    const float* x = buckets + id / kEach * (3 * kEach) + id % kEach;
    return {x[0], x[kEach], x[2 * kEach]};
  }

  const float* buckets_;
  std::size_t size_;
};

}  // namespace voxshell
