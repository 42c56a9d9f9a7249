#pragma once

#include <cstddef>
#include <new>

namespace voxshell {

/// Size of a cache line, bytes. Loading eight floats across two lines takes twice as long.
inline constexpr std::align_val_t kCacheLine{64};

/// Allocator for vectors that begin at a cache line.
template <class T>
struct LineAllocator {
  using value_type = T;  // NOLINT(readability-identifier-naming): required by std::vector

  LineAllocator() = default;
  template <class U>
  explicit(false) LineAllocator(const LineAllocator<U>&) {}

  T* allocate(std::size_t count) {
    return static_cast<T*>(::operator new(count * sizeof(T), kCacheLine));
  }
  void deallocate(T* memory, std::size_t) { ::operator delete(memory, kCacheLine); }

  friend bool operator==(const LineAllocator&, const LineAllocator&) { return true; }
};

}  // namespace voxshell
