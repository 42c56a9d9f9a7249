#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <new>
#include <stdexcept>
#include <thread>
#include <utility>

#include <nanobind/nanobind.h>

#include "bullet/simulation.h"
#include "interpreter_lock.h"
#include "voxshell/ordinary_floats.h"

namespace voxshell::python {

/// A fair, recursive lock: threads get it in order of arrival. Its holder may take it again, as
/// happens if a garbage collection runs within a method. A mutex is not fair: a thread that steps
/// in a loop would block all others.
class FairLock {
 public:
  bool try_lock() {
    const std::lock_guard guard(mutex_);
    if (depth_ > 0 ? holder_ != std::this_thread::get_id() : next_ != served_) return false;
    if (depth_ == 0) ++next_;
    hold();
    return true;
  }
  void lock() {
    std::unique_lock guard(mutex_);
    if (depth_ == 0 || holder_ != std::this_thread::get_id()) {
      const std::uint64_t ticket = next_++;
      changed_.wait(guard, [&] { return depth_ == 0 && ticket == served_; });
    }
    hold();
  }
  void unlock() {
    const std::lock_guard guard(mutex_);
    if (--depth_ > 0) return;
    ++served_;
    changed_.notify_all();
  }

 private:
  void hold() {
    holder_ = std::this_thread::get_id();
    ++depth_;
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::uint64_t next_ = 0;    ///< ticket
  std::uint64_t served_ = 0;  ///< ticket of the holder, or of the next thread
  std::thread::id holder_;
  int depth_ = 0;
};

/// The simulation of a World, which threads may share: each method waits for its turn.
class SharedSimulation {
 public:
  explicit SharedSimulation(const SimulationSettings& settings)
      : simulation_(std::make_unique<Simulation>(settings)) {}

  FairLock lock;

  /// Call this only in one's turn. Throws std::out_of_range if the simulation no longer exists.
  Simulation& get() {
    if (simulation_ == nullptr) {
      throw std::out_of_range("memory ran out while this world changed; make another world");
    }
    return *simulation_;
  }

  /// Calls `change` with the simulation. If memory runs out during it, the change is incomplete,
  /// and Bullet can neither continue nor be destroyed: its memory is leaked.
  template <class Change>
  auto change(const Change& change) {
    try {
      return change(get());
    } catch (const std::bad_alloc&) {
      [[maybe_unused]] const Simulation* const left_behind = simulation_.release();
      throw;
    }
  }

 private:
  std::unique_ptr<Simulation> simulation_;
};

/// One call: a turn of the simulation, with ordinary floating-point state. Needs the GIL, and
/// releases it while it waits, so that the present holder can finish.
class Turn {
 public:
  explicit Turn(SharedSimulation& simulation) : lock_(simulation.lock) {
    if (lock_.try_lock()) return;
    const ReleasedInterpreter released;
    lock_.lock();
  }
  ~Turn() { lock_.unlock(); }
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;

 private:
  FairLock& lock_;
  OrdinaryFloats floats_;
};

/// A Python method that takes its turn.
template <class Result, class... Args>
auto in_turn(Result (*function)(Simulation&, Args...)) {
  return [function](SharedSimulation& shared, Args... args) -> Result {
    const Turn turn(shared);
    return shared.change([&](Simulation& simulation) -> Result {
      return function(simulation, std::forward<Args>(args)...);
    });
  };
}
template <class Result, class... Args>
auto in_turn(Result (Simulation::*method)(Args...)) {
  return [method](SharedSimulation& shared, Args... args) -> Result {
    const Turn turn(shared);
    return shared.change([&](Simulation& simulation) -> Result {
      return (simulation.*method)(std::forward<Args>(args)...);
    });
  };
}
template <class Result, class... Args>
auto in_turn(Result (*function)(const Simulation&, Args...)) {
  return [function](SharedSimulation& shared, Args... args) -> Result {
    const Turn turn(shared);
    return function(shared.get(), std::forward<Args>(args)...);
  };
}
template <class Result, class... Args>
auto in_turn(Result (Simulation::*method)(Args...) const) {
  return [method](SharedSimulation& shared, Args... args) -> Result {
    const Turn turn(shared);
    return (shared.get().*method)(std::forward<Args>(args)...);
  };
}
template <class Lambda>
auto in_turn(Lambda lambda) {
  return in_turn(+lambda);
}

/// The Python class: all methods defined through it take their turn.
class SimulationMethods {
 public:
  explicit SimulationMethods(nanobind::class_<SharedSimulation>& of) : class_(of) {}

  template <class Method, class... Extra>
  SimulationMethods& def(const char* name, Method method, const Extra&... extra) {
    class_.def(name, in_turn(method), extra...);
    return *this;
  }

 private:
  nanobind::class_<SharedSimulation>& class_;
};

}  // namespace voxshell::python
