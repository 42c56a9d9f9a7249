#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pair_step.h"
#include "voxshell/contacts.h"

namespace voxshell::bullet {

/// The elements of a shell that are inside the field at poses that the bodies will pass within the
/// step. The nearest element of a segment need not be the one that will touch: beside a slot that
/// falls over a pin, the flanks are near and slide past, and the end of the slot, farther away,
/// hits.
class SweptHits {
 public:
  /// Looks for the deepest element of each segment, and merges those that are not there yet into
  /// `contacts`, ascending by id, with the place, normal and depth that they have now. Leaves out
  /// those that are within the rest margin now.
  /// @param field        Of the other body.
  /// @param is_of_field  Whether the shell is that of the pair's field side.
  /// @param lists        Room for the search.
  void find(const PairStep& step, const PointShell& shell, const Field& field, bool is_of_field,
            int level, QueryLists& lists, std::vector<Contact>& contacts);

  /// Ascending.
  std::span<const std::uint32_t> ids() const { return ids_; }
  void clear() { ids_.clear(); }

 private:
  QueryScratch scratch_;
  std::vector<Contact> found_;
  std::vector<std::uint32_t> ids_;
};

}  // namespace voxshell::bullet
