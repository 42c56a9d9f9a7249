#pragma once

#include <nanobind/nanobind.h>

namespace voxshell::python {

void bind_field(nanobind::module_& module);
void bind_shell(nanobind::module_& module);
void bind_model(nanobind::module_& module);
void bind_contacts(nanobind::module_& module);

}  // namespace voxshell::python
