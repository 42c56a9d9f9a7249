#include <nanobind/nanobind.h>

#include "bullet/bindings.h"
#include "bullet/simulation.h"

NB_MODULE(_bullet, module) {
  module.doc() = "Stock Bullet with voxshell's models. Use it through voxshell.World.";
  voxshell::python::bind_geometries(module);
  voxshell::python::bind_joints(module);
  voxshell::python::bind_simulation(module);
  module.attr("most_timings") = voxshell::python::Simulation::kMostTimings;
  module.attr("bullet_version") = btGetVersion();
}
