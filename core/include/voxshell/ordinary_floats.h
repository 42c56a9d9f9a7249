#pragma once

#include <cstdint>

namespace voxshell {

/// While an object of this class exists, its thread rounds to nearest, keeps denormal numbers and
/// does not trap. In this state, results have the same bits everywhere. The destructor restores the
/// previous state, flags included. Costs about 12 ns.
class OrdinaryFloats {
 public:
  OrdinaryFloats();
  ~OrdinaryFloats();
  OrdinaryFloats(const OrdinaryFloats&) = delete;
  OrdinaryFloats& operator=(const OrdinaryFloats&) = delete;

 private:
  std::uint64_t found_;
};

}  // namespace voxshell
