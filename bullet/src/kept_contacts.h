#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "pair_step.h"
#include "posed_pair.h"
#include "voxshell/contacts.h"

namespace voxshell::bullet {

/// The contacts that a pair was last given, and what they were searched for with. While
/// the pair moves by far less than its rest margin, they go along with the bodies, and nothing is
/// searched for. Decision 47.
class KeptContacts {
 public:
  /// Keeps what a search in this step found, ascending by id.
  void keep(const PairStep& step, std::span<const Contact> found);
  /// Forgets those that are not among `chosen`.
  void reduce_to(std::span<const Contact> chosen);
  /// Keeps what the same contacts are in this step.
  void renew(const PairStep& step, std::span<const Contact> contacts);

  /// Whether a search in this step would find the same contacts, but for a small fraction of the
  /// rest margin. `are_followed`: those of round surfaces are.
  bool hold_in(const PairStep& step, bool are_followed) const;
  /// Whether the pair has moved so far since the contacts were kept or renewed that round surfaces
  /// touch elsewhere.
  bool have_moved_in(const PairStep& step) const;
  /// Moves the contacts to where they are in this step; none if none were kept.
  void move_to(const PairStep& step, std::vector<Contact>& contacts) const;

 private:
  /// What the answer of a search depends on.
  struct Question {
    std::array<GeometryKey, 2> geometry;
    bool shell_is_a;
    bool is_still;
    bool uses_ccd;
    double time_step;
    double rest_margin;
    double thickness;
    Pose field_from_shell;
    /// Of the shell's body as the field's sees it, and if something else stops one of them.
    std::array<RelativeMotion, 3> motions;

    static Question of(const PairStep& step);
  };

  std::optional<Question> asked_;
  std::vector<Contact> contacts_;
  Pose field_from_shell_;              ///< where they are contacts
  std::vector<std::uint32_t> chosen_;  ///< room for ids
};

}  // namespace voxshell::bullet
