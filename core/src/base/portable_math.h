#pragma once

namespace voxshell {

// The same bits on every processor and with every C library, for what is stored in models: the last
// bits of the library's own functions differ. Within 4 units in the last place, for finite
// arguments.

/// std::atan2.
double portable_atan2(double y, double x);

/// std::log, of normal numbers above 0.
double portable_log(double x);

/// std::exp, where the result is a normal number.
double portable_exp(double x);

}  // namespace voxshell
