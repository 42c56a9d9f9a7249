#pragma once

#include <nanobind/nanobind.h>

#include "arrays.h"
#include "contact_set.h"

namespace voxshell::python {

/// The properties that contact sets and batches share.
template <class Set>
void def_contact_arrays(nanobind::class_<Set>& set) {
  const auto rows = [&](const char* name, std::vector<Vec3> ContactArrays::* array) {
    set.def_prop_ro(name, [array](const Set& s) {
      return view_rows<double, 3>(std::span<const Vec3>(s.arrays.*array));
    });
  };
  rows("points_a", &ContactArrays::points_a);
  rows("points_b", &ContactArrays::points_b);
  rows("normals", &ContactArrays::normals);
  set.def_prop_ro("depths", [](const Set& s) { return view(std::span(s.arrays.depths)); })
      .def_prop_ro("ids", [](const Set& s) { return view(std::span(s.arrays.ids)); })
      .def_prop_ro("segments", [](const Set& s) { return view(std::span(s.arrays.segments)); })
      .def_prop_ro(
          "shells", [](const Set& s) { return view(std::span(s.arrays.shells)); },
          "0: a's shell, 1: b's shell.")
      .def_prop_ro("inner", [](const Set& s) { return view(std::span(s.arrays.inner)); });
}

}  // namespace voxshell::python
