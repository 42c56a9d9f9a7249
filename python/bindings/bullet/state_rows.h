#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "bullet/simulation_state.h"

namespace voxshell::python {

/// A table of numbers, row by row.
struct NumberTable {
  std::size_t columns = 0;
  std::vector<double> numbers;
};

/// A state as plain numbers, which mean the same in another process. Bodies and joints have their
/// places in the state instead of their numbers, and everything is finite unless the world is not.
struct StateRows {
  NumberTable whole;  ///< one row
  NumberTable bodies;
  NumberTable joints;
  NumberTable apart;
  NumberTable manifolds;
  NumberTable points;  ///< of all manifolds
  NumberTable contacts;
};

StateRows to_rows(const SimulationState& state);

/// Throws std::invalid_argument if the rows are not those of any state.
std::shared_ptr<const SimulationState> from_rows(const StateRows& rows);

/// The same state with other numbers of bodies and joints, in the order of those that it has.
/// Throws std::out_of_range if their counts differ.
std::shared_ptr<SimulationState> renumber(const SimulationState& state,
                                          const std::vector<std::size_t>& bodies,
                                          const std::vector<std::size_t>& joints);

}  // namespace voxshell::python
