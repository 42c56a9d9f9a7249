#include <cstdlib>
#include <new>

#include <LinearMath/btAlignedAllocator.h>
#include <nanobind/nanobind.h>

#include "bullet/bindings.h"
#include "bullet/simulation.h"

namespace {

/// Bullet does not check for failed allocations, and would write to address 0.
void* allocate_or_throw(std::size_t size) {
  void* const memory = std::malloc(size);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

NB_MODULE(_bullet, module) {
  // What a thread still uses when the program ends is no leak, and no news for the user.
  nanobind::set_leak_warnings(false);
  btAlignedAllocSetCustom(&allocate_or_throw, &std::free);
  module.doc() = "Stock Bullet with voxshell's models. Use it through voxshell.World.";
  voxshell::python::bind_geometries(module);
  voxshell::python::bind_joints(module);
  voxshell::python::bind_simulation(module);
  module.attr("most_timings") = voxshell::python::Simulation::kMostTimings;
  module.attr("bullet_version") = btGetVersion();
}
