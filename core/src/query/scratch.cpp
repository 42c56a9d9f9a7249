#include "query/scratch.h"

#include <algorithm>

namespace voxshell {

QueryLists::QueryLists() : state_(std::make_unique<State>()) {}
QueryLists::~QueryLists() = default;

QueryScratch::QueryScratch() : state_(std::make_unique<State>()) {}
QueryScratch::~QueryScratch() = default;
QueryScratch::QueryScratch(QueryScratch&&) noexcept = default;
QueryScratch& QueryScratch::operator=(QueryScratch&&) noexcept = default;

std::span<const Contact> QueryScratch::contacts() const {
  return {state_->contact_data(), state_->lists().contact_count};
}

void QueryScratch::borrow(QueryLists& lists) { state_->borrow(&lists.state()); }

namespace {

constexpr std::size_t kSpare = 8;  // kernels write eight at a time

}  // namespace

bool QueryLists::State::reserve(const simd::TreeView& tree, std::size_t more) {
  bool has_moved = false;
  const std::size_t points = tree.point_count + more + kSpare;
  if (points > point_capacity) {
    point_capacity = points;
    constexpr std::size_t kContactLists = sizeof(Contact) / sizeof(float);
    point_lists.resize(2 * QueryScratch::State::kPointLists + kContactLists,
                       points * sizeof(float));
    contact_count = 0;
    has_moved = true;
  }
  const std::size_t slots = (std::size_t{1} << tree.depth) + kSpare;
  if (slots > node_capacity) {
    node_capacity = slots;
    for (NodeBuffer& buffer : nodes) buffer.lists.resize(3, slots * sizeof(float));
    has_moved = true;
  }
  return has_moved;
}

void QueryScratch::State::reserve(const simd::TreeView& tree, std::size_t more) {
  if (owns_lists()) is_answer_kept_ = false;
  if (lists().reserve(tree, more) && owns_lists()) survivors.forget();
}

bool QueryScratch::State::recall_contacts(const simd::TreeView& tree, std::size_t more) {
  if (!is_answer_kept_) return false;
  if (owns_lists()) return true;
  lists().reserve(tree, more);
  std::ranges::copy(answer_, contact_data());
  lists().contact_count = answer_.size();
  return true;
}

void QueryScratch::State::keep_contacts(bool is_asked_again) {
  is_answer_kept_ = owns_lists() || is_asked_again;
  if (owns_lists() || !is_asked_again) return;
  const Contact* const found = contact_data();
  answer_.assign(found, found + lists().contact_count);
}

void QueryScratch::State::keep_survivors() {
  if (owns_lists()) return;
  if (survivors.growth == 0.0) {
    survivors.growth = Survivors::kNotKept;
    return;
  }
  simd::PointList& points = survivors.points;
  const std::size_t count = points.count;
  if (count + kSpare > kept_capacity_) {
    kept_capacity_ = 2 * count + kSpare;
    kept_.resize(kPointLists, kept_capacity_ * sizeof(float));
  }
  simd::PointList kept = make_point_list(kept_, 0);
  // With the copies that fill up the last eight.
  const auto copy = [&](const auto* from, auto* to) { std::copy_n(from, count + kSpare, to); };
  copy(points.id, kept.id);
  copy(points.tag, kept.tag);
  copy(points.distance, kept.distance);
  copy(points.x, kept.x);
  copy(points.y, kept.y);
  copy(points.z, kept.z);
  kept.count = points.count;
  points = kept;
}

simd::FoundPoint* QueryScratch::State::reserve_found(std::size_t segments) {
  QueryLists::State& of = lists();
  if (segments > of.found_capacity) {
    of.found_capacity = segments;
    of.found = std::make_unique_for_overwrite<simd::FoundPoint[]>(segments);
  }
  return of.found.get();
}

std::uint32_t* QueryScratch::State::reserve_group_ends() {
  QueryLists::State& of = lists();
  if (of.point_capacity > of.group_capacity) {
    of.group_capacity = of.point_capacity;
    of.group_ends = std::make_unique_for_overwrite<std::uint32_t[]>(of.group_capacity);
  }
  return of.group_ends.get();
}

void QueryScratch::State::reserve_gradients() {
  QueryLists::State& of = lists();
  if (of.point_capacity <= of.gradient_capacity) return;
  of.gradient_capacity = of.point_capacity;
  of.gradient_x = std::make_unique_for_overwrite<float[]>(of.gradient_capacity);
  of.gradient_y = std::make_unique_for_overwrite<float[]>(of.gradient_capacity);
  of.gradient_z = std::make_unique_for_overwrite<float[]>(of.gradient_capacity);
}

}  // namespace voxshell
