#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "voxshell/field.h"
#include "voxshell/point_shell.h"
#include "voxshell/pose.h"

namespace voxshell {

/// A point of the shell, or the deepest place of one of its edge segments, that is inside the field
/// or within the margin of its surface. Meters, the shell's frame.
struct Contact {
  std::uint32_t id;  ///< of the shell's element
  float depth;       ///< minus the signed distance: positive inside, above -margin
  Vec3f point;       ///< the shell's point, or the place on its edge
  Vec3f normal;      ///< the field's outward unit normal there

  friend bool operator==(const Contact&, const Contact&) = default;
};

struct ContactOptions {
  float margin = 0.0f;  ///< elements with a distance below this are contacts, meters
  /// Largest number of contacts. If there are more, the deepest stay; ties go to the smaller id.
  std::size_t max_points = SIZE_MAX;
};

/// The lists that a query fills, 0.7 MB for a shell of 10,000 points. A program that keeps one
/// scratch per pair may keep one of these per thread; see QueryScratch::borrow().
class QueryLists {
 public:
  QueryLists();
  ~QueryLists();
  QueryLists(const QueryLists&) = delete;
  QueryLists& operator=(const QueryLists&) = delete;

  struct State;
  State& state() { return *state_; }

 private:
  std::unique_ptr<State> state_;
};

/// The mutable state of queries; use one per thread. A reused scratch makes a warm query free of
/// allocation, and lets a query for a pose near the last one start from the last result.
class QueryScratch {
 public:
  QueryScratch();
  ~QueryScratch();
  QueryScratch(QueryScratch&&) noexcept;
  QueryScratch& operator=(QueryScratch&&) noexcept;

  /// Contacts of the last query.
  std::span<const Contact> contacts() const;

  /// Makes queries fill these lists from now on, instead of the scratch's own. The scratch then
  /// keeps only what makes the next query near this pose fast. The lists must outlive these
  /// queries, and one thread at a time may use them. They hold the contacts until the next query
  /// that uses them.
  void borrow(QueryLists& lists);

  struct State;
  State& state() { return *state_; }

 private:
  std::unique_ptr<State> state_;
};

/// All contacts of a shell in a field, in ascending order of ids (thesis, Algorithm 3.1: walk the
/// point-sphere tree, skip the clusters that cannot reach the surface). Equal bit for bit to
/// contacts_flat(). An edge segment gives one contact; an edge that lies in the surface gives a row
/// of them. The result lives in `scratch` until its next use.
std::span<const Contact> find_contacts(const Field& field, const PointShell& shell,
                                       const Pose& field_from_shell, const ContactOptions& options,
                                       QueryScratch& scratch);

/// Result of a query under a budget. Contacts that it missed are no deeper than `depth_bound`.
struct BudgetedContacts {
  std::span<const Contact> contacts;
  bool is_exact;      ///< nothing was missed: the same as find_contacts()
  float depth_bound;  ///< meters; minus infinity if exact
};

/// Contacts found by visiting at most `budget` nodes. A node is eight spheres or eight points,
/// which cost about the same. The search is breadth first: half of the budget is for spheres, the
/// rest for the points of the clusters that may be deepest (level of detail: Barbic and James 2008,
/// section 5).
BudgetedContacts find_contacts_within_budget(const Field& field, const PointShell& shell,
                                             const Pose& field_from_shell,
                                             const ContactOptions& options, std::size_t budget,
                                             QueryScratch& scratch);

/// True if find_contacts() would find any; stops at the first.
bool collides(const Field& field, const PointShell& shell, const Pose& field_from_shell,
              float margin = 0.0f);

}  // namespace voxshell
