#pragma once

#include <nanobind/nanobind.h>

namespace voxshell::python {

void bind_geometries(nanobind::module_& module);
void bind_joints(nanobind::module_& module);
void bind_simulation(nanobind::module_& module);

}  // namespace voxshell::python
