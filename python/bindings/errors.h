#pragma once

#include <string>
#include <utility>

#include <nanobind/nanobind.h>

#include "voxshell/result.h"

namespace voxshell::python {

/// Throws the Python exception of voxshell.errors for an error of the core. This is the only place
/// that maps them. Needs the GIL.
[[noreturn]] void raise(const Error& error);

/// Registers the translation of C++ exceptions to those of voxshell.errors.
void translate_exceptions();

/// Returns the value of a result, or raises its error. `subject` names the argument.
template <class T>
T unwrap(Result<T> result, const char* subject = nullptr) {
  if (result) return *std::move(result);
  if (subject == nullptr) raise(result.error());
  raise({result.error().code, std::string(subject) + ": " + result.error().message});
}

}  // namespace voxshell::python
