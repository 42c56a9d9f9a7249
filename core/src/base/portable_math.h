#pragma once

namespace voxshell {

// The same bits on every processor and with every C library, for what is stored in models and for
// motions: the last bits of the library's own functions differ. Within 4 units in the last place,
// for finite arguments.

/// std::atan2.
double portable_atan2(double y, double x);

/// std::log, of normal numbers above 0.
double portable_log(double x);

/// std::exp, where the result is a normal number.
double portable_exp(double x);

/// std::sin and std::cos, of at most 1e5 radians; within 1e-15 of zero absolutely.
double portable_sin(double x);
double portable_cos(double x);

}  // namespace voxshell
