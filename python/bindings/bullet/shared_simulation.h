#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>

#include <nanobind/nanobind.h>

#include "bullet/simulation.h"
#include "voxshell/ordinary_floats.h"

namespace voxshell::python {

/// A lock that goes to threads in the order in which they come, and that its holder may take again,
/// as Python does where a garbage collection runs within a method. A mutex is not fair: who steps
/// without end would keep all others waiting.
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
  std::uint64_t served_ = 0;  ///< ticket: of the holder, or of whoever is next
  std::thread::id holder_;
  int depth_ = 0;
};

/// The simulation of a World, which threads may share: each method waits for its turn.
struct SharedSimulation : Simulation {
  using Simulation::Simulation;

  FairLock lock;
};

/// One call: a turn of the simulation's, and ordinary floating-point numbers. Needs the GIL, which
/// it gives away while it waits, so that whoever holds the turn can end.
class Turn {
 public:
  explicit Turn(SharedSimulation& simulation) : lock_(simulation.lock) {
    if (lock_.try_lock()) return;
    const nanobind::gil_scoped_release released;
    lock_.lock();
  }
  ~Turn() { lock_.unlock(); }
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;

 private:
  FairLock& lock_;
  OrdinaryFloats floats_;
};

/// A method of Python's that takes its turn.
template <class Result, class Self, class... Args>
auto in_turn(Result (*function)(Self&, Args...)) {
  return [function](SharedSimulation& simulation, Args... args) -> Result {
    const Turn turn(simulation);
    return function(simulation, std::forward<Args>(args)...);
  };
}
template <class Result, class... Args>
auto in_turn(Result (Simulation::*method)(Args...)) {
  return [method](SharedSimulation& simulation, Args... args) -> Result {
    const Turn turn(simulation);
    return (simulation.*method)(std::forward<Args>(args)...);
  };
}
template <class Result, class... Args>
auto in_turn(Result (Simulation::*method)(Args...) const) {
  return [method](SharedSimulation& simulation, Args... args) -> Result {
    const Turn turn(simulation);
    return (simulation.*method)(std::forward<Args>(args)...);
  };
}
template <class Lambda>
auto in_turn(Lambda lambda) {
  return in_turn(+lambda);
}

/// The class as Python has it: no method can be defined that does not take its turn.
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
