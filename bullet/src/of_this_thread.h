#pragma once

#include <memory>
#include <utility>
#include <vector>

namespace voxshell::bullet {

/// What a thread has made for itself, dropped when it ends.
class ThreadObjects {
 public:
  /// The first call on a thread registers a destructor, and glibc ends a process that has no memory
  /// for that. Helpers therefore call it as they begin, from memory set aside (`parallel_for`).
  static ThreadObjects& of_this_thread() {
    thread_local ThreadObjects objects;
    return objects;
  }

  void keep(std::shared_ptr<void> object) { objects_.push_back(std::move(object)); }

 private:
  std::vector<std::shared_ptr<void>> objects_;
};

/// The T of the calling thread: made when it first asks, kept until the thread ends. Unlike a
/// thread_local T, it throws std::bad_alloc where there is no memory for it.
template <typename T>
T& of_this_thread() {
  thread_local T* object = nullptr;
  if (object == nullptr) {
    auto made = std::make_shared<T>();
    ThreadObjects::of_this_thread().keep(made);
    object = made.get();
  }
  return *object;
}

}  // namespace voxshell::bullet
