#pragma once

#include <nanobind/nanobind.h>

namespace voxshell::python {

void bind_field(nanobind::module_& module);
void bind_shell(nanobind::module_& module);
void bind_model(nanobind::module_& module);
void bind_contact_set(nanobind::module_& module);
void bind_contacts(nanobind::module_& module);
void bind_distance(nanobind::module_& module);
void bind_sweep(nanobind::module_& module);
void bind_wrench(nanobind::module_& module);
void bind_batch(nanobind::module_& module);

}  // namespace voxshell::python
