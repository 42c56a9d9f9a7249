#include "core_module.h"

#include "errors.h"

NB_MODULE(_core, module) {
  using namespace voxshell::python;
  // What a thread still uses when the program ends is no leak, and no news for the user.
  nanobind::set_leak_warnings(false);
  module.doc() = "The compiled core. Use it through the package voxshell, which checks arguments.";
  module.attr("version") = VOXSHELL_VERSION;
  translate_exceptions();
  bind_field(module);
  bind_shell(module);
  bind_model(module);
  bind_contact_set(module);
  bind_contacts(module);
  bind_distance(module);
  bind_sweep(module);
  bind_wrench(module);
  bind_batch(module);
}
