#pragma once

#include <cstddef>
#include <new>

namespace voxshell {

/// What processors load at once, bytes. Eight floats that lie across two lines take twice as long.
inline constexpr std::align_val_t kCacheLine{64};

/// For vectors that begin with a line.
template <class T>
struct LineAllocator {
  using value_type = T;  // NOLINT(readability-identifier-naming): what vectors ask for

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
