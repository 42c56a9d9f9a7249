#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "query/posed.h"
#include "simd/query_kernels.h"
#include "voxshell/cache_lines.h"
#include "voxshell/contacts.h"

namespace voxshell {

/// The view of any field, or none.
template <class Variant>
struct ViewOf;
template <class... Fields>
struct ViewOf<std::variant<Fields...>> {
  using Any = std::variant<std::monostate, simd::ExactGridView,
                           std::remove_cvref_t<decltype(std::declval<const Fields&>().view())>...>;
};

/// Memory for lists that are used side by side. Each begins with a cache line, at another place in
/// a page than the others: by their lowest 12 bits processors take what is written to one list for
/// what they read from the next.
class ListMemory {
 public:
  void resize(std::size_t lists, std::size_t bytes_each) {
    constexpr std::size_t kPage = 4096;
    constexpr auto kLine = static_cast<std::size_t>(kCacheLine);
    const auto round_up = [&](std::size_t unit) { return (bytes_each + unit - 1) / unit * unit; };
    const std::size_t stride = bytes_each < kPage ? round_up(kLine) : round_up(kPage) + 11 * kLine;
    memory_.reset(static_cast<std::byte*>(::operator new(lists * stride, kCacheLine)));
    stride_ = stride;
  }
  template <class T>
  T* list(std::size_t index) const {
    // Compilers for processors that load aligned words alone warn of a direct cast.
    void* const begin = memory_.get() + index * stride_;
    return static_cast<T*>(begin);
  }

 private:
  struct Free {
    void operator()(std::byte* memory) const { ::operator delete(memory, kCacheLine); }
  };
  std::unique_ptr<std::byte, Free> memory_;
  std::size_t stride_ = 0;
};

/// Arrays that grow to the largest shell asked about and are never filled in advance. A search
/// leaves nothing in them that the next one needs, so many scratches may share them. Where memory
/// runs out while one grows, all stay as they were: a later search may use them.
struct QueryLists::State {
  template <class T>
  using Buffer = std::unique_ptr<T[]>;

  struct NodeBuffer {
    ListMemory lists;

    simd::NodeList empty_list() const {
      return {lists.list<std::uint32_t>(0), lists.list<std::uint32_t>(1), lists.list<float>(2), 0};
    }
  };

  /// Makes room for any query about a shell of this tree, and for `more` contacts. Whether lists
  /// have moved for it.
  bool reserve(const simd::TreeView& tree, std::size_t more);

  /// The state of searches among a shell's edges, apart from those among its points.
  State& of_edges() {
    if (!edges) edges = std::make_unique<State>();
    return *edges;
  }

  std::size_t point_capacity = 0;
  std::size_t node_capacity = 0;
  NodeBuffer nodes[2];
  ListMemory point_lists;  ///< of points, survivors and contacts
  std::size_t contact_count = 0;
  Buffer<simd::FoundPoint> found;  ///< one a segment
  std::size_t found_capacity = 0;
  Buffer<std::uint32_t> group_ends;
  std::size_t group_capacity = 0;
  Buffer<float> gradient_x, gradient_y, gradient_z;
  std::size_t gradient_capacity = 0;
  std::unique_ptr<State> edges;
};

/// The lists of a search, and what it leaves to the next.
struct QueryScratch::State {
  /// Makes room for any query about a shell of this tree, and for `more` contacts.
  void reserve(const simd::TreeView& tree, std::size_t more = 0);

  /// Of searches among a shell's edges. Theirs are the places on edges where this has points.
  State& of_edges() {
    if (!edges_) edges_ = std::make_unique<State>();
    edges_->borrowed_ = borrowed_ == nullptr ? nullptr : &borrowed_->of_edges();
    return *edges_;
  }

  /// Searches with these lists until the next call, or with its own where there are none.
  void borrow(QueryLists::State* lists) { borrowed_ = lists; }
  bool owns_lists() const { return borrowed_ == nullptr; }
  QueryLists::State& lists() { return borrowed_ == nullptr ? own_ : *borrowed_; }
  const QueryLists::State& lists() const { return borrowed_ == nullptr ? own_ : *borrowed_; }

  /// Room for one point a segment.
  simd::FoundPoint* reserve_found(std::size_t segments);

  /// Room for the end of each group of points, of which there are no more than points.
  std::uint32_t* reserve_group_ends();

  /// Room for one gradient a point.
  void reserve_gradients();

  simd::PointList empty_points() const { return make_point_list(lists().point_lists, 0); }
  simd::PointList empty_survivors() const {
    return make_point_list(lists().point_lists, kPointLists);
  }
  Contact* contact_data() const { return lists().point_lists.list<Contact>(2 * kPointLists); }

  /// Where the lists are not its own: makes a copy of the survivors that are left for the next
  /// search.
  void keep_survivors();

  static constexpr std::size_t kPointLists = 6;

  /// The elements that the last search for contacts was left with, and its question.
  struct Survivors {
    ViewOf<Field>::Any field;  ///< none: there are no survivors to go on from
    std::uint64_t tree = 0;
    Pose field_from_shell;
    float margin = 0.0f;
    static constexpr double kNotKept = -1.0;
    double growth = 0.0;  ///< serves all poses that move no point by more than this, meters
    Pose last_asked;
    simd::NodeList slots{};    ///< without growth
    simd::PointList points{};  ///< with growth

    void forget() { field = std::monostate{}; }
  } survivors;

  /// The question of the last search for contacts, which is all that the answer depends on. Bodies
  /// at rest ask the same again.
  struct Question {
    ViewOf<Field>::Any field;
    std::uint64_t tree = 0;
    std::uint64_t edges = 0;  ///< the tree of the shell's edges
    PosedBits posed{};
    float margin = 0.0f;
    std::size_t max_points = 0;

    bool operator==(const Question&) const = default;
  } asked;

  /// Whether it still had the contacts of the question that was asked last. They are in the lists,
  /// with room for any query about a shell of this tree and for `more` contacts.
  bool recall_contacts(const simd::TreeView& tree, std::size_t more);

  /// Keeps the contacts just found as the answer to what was asked. Where the lists are not its
  /// own, it makes a copy if the question `is_asked_again`: most are asked once.
  void keep_contacts(bool is_asked_again);

 private:
  static simd::PointList make_point_list(const ListMemory& memory, std::size_t first) {
    return {memory.list<std::uint32_t>(first),
            memory.list<std::uint32_t>(first + 1),
            memory.list<float>(first + 2),
            memory.list<float>(first + 3),
            memory.list<float>(first + 4),
            memory.list<float>(first + 5),
            0};
  }

  QueryLists::State own_;
  bool is_answer_kept_ = false;
  std::vector<Contact> answer_;  ///< where the lists are not its own
  QueryLists::State* borrowed_ = nullptr;
  ListMemory kept_;
  std::size_t kept_capacity_ = 0;
  std::unique_ptr<State> edges_;
};

}  // namespace voxshell
