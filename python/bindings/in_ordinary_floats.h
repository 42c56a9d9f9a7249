#pragma once

#include <cstdint>

#include <nanobind/nanobind.h>

#include "voxshell/ordinary_floats.h"

namespace voxshell::python {

/// Add it to the definitions of functions that compute. They then give the same bits, whatever
/// floating-point state another library has left in the thread.
using InOrdinaryFloats = nanobind::call_guard<OrdinaryFloats>;

/// A Python number that is rounded to float32 where it is used. A float argument would be rounded
/// before InOrdinaryFloats begins.
struct RoundedInside {
  double number = 0.0;

  operator float() const { return static_cast<float>(number); }
};

}  // namespace voxshell::python

template <>
struct nanobind::detail::type_caster<voxshell::python::RoundedInside> {
  NB_TYPE_CASTER(voxshell::python::RoundedInside, const_name("float"))

  bool from_python(handle source, std::uint32_t flags, cleanup_list* cleanup) noexcept {
    make_caster<double> caster;
    if (!caster.from_python(source, flags, cleanup)) return false;
    value.number = caster.value;
    return true;
  }
};
