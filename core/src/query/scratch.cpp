#include "query/scratch.h"

#include <algorithm>
#include <utility>

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
  const std::size_t points = tree.point_count + more + kSpare;
  const std::size_t slots = (std::size_t{1} << tree.depth) + kSpare;
  const bool grows_points = points > point_capacity;
  const bool grows_nodes = slots > node_capacity;
  ListMemory grown_points;
  ListMemory grown_nodes[2];
  if (grows_points) {
    constexpr std::size_t kContactLists = sizeof(Contact) / sizeof(float);
    grown_points.resize(2 * QueryScratch::State::kPointLists + kContactLists,
                        points * sizeof(float));
  }
  if (grows_nodes) {
    for (ListMemory& lists : grown_nodes) lists.resize(3, slots * sizeof(float));
  }
  // Nothing fails from here on.
  if (grows_points) {
    point_lists = std::move(grown_points);
    point_capacity = points;
    contact_count = 0;
  }
  if (grows_nodes) {
    for (int i = 0; i < 2; ++i) nodes[i].lists = std::move(grown_nodes[i]);
    node_capacity = slots;
  }
  return grows_points || grows_nodes;
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
  is_answer_kept_ = false;
  if (!owns_lists()) {
    if (!is_asked_again) return;
    const Contact* const found = contact_data();
    answer_.assign(found, found + lists().contact_count);
  }
  is_answer_kept_ = true;
}

void QueryScratch::State::keep_survivors() {
  if (owns_lists()) return;
  const double growth = std::exchange(survivors.growth, Survivors::kNotKept);
  if (growth == 0.0) return;
  simd::PointList& points = survivors.points;
  const std::size_t count = points.count;
  if (count + kSpare > kept_capacity_) {
    kept_.resize(kPointLists, (2 * count + kSpare) * sizeof(float));
    kept_capacity_ = 2 * count + kSpare;
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
  survivors.growth = growth;
}

simd::FoundPoint* QueryScratch::State::reserve_found(std::size_t segments) {
  QueryLists::State& of = lists();
  if (segments > of.found_capacity) {
    of.found = std::make_unique_for_overwrite<simd::FoundPoint[]>(segments);
    of.found_capacity = segments;
  }
  return of.found.get();
}

std::uint32_t* QueryScratch::State::reserve_group_ends() {
  QueryLists::State& of = lists();
  if (of.point_capacity > of.group_capacity) {
    of.group_ends = std::make_unique_for_overwrite<std::uint32_t[]>(of.point_capacity);
    of.group_capacity = of.point_capacity;
  }
  return of.group_ends.get();
}

void QueryScratch::State::reserve_gradients() {
  QueryLists::State& of = lists();
  if (of.point_capacity <= of.gradient_capacity) return;
  of.gradient_x = std::make_unique_for_overwrite<float[]>(of.point_capacity);
  of.gradient_y = std::make_unique_for_overwrite<float[]>(of.point_capacity);
  of.gradient_z = std::make_unique_for_overwrite<float[]>(of.point_capacity);
  of.gradient_capacity = of.point_capacity;
}

}  // namespace voxshell
