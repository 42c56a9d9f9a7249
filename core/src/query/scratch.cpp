#include "query/scratch.h"

namespace voxshell {

QueryScratch::QueryScratch() : state_(std::make_unique<State>()) {}
QueryScratch::~QueryScratch() = default;
QueryScratch::QueryScratch(QueryScratch&&) noexcept = default;
QueryScratch& QueryScratch::operator=(QueryScratch&&) noexcept = default;

std::span<const Contact> QueryScratch::contacts() const {
  return {state_->contact_data(), state_->contact_count};
}

void QueryScratch::State::reserve(const simd::TreeView& tree, std::size_t more) {
  survivors.are_contacts_kept = false;
  constexpr std::size_t kSpare = 8;  // kernels write eight at a time
  const std::size_t points = tree.point_count + more + kSpare;
  if (points > point_capacity) {
    point_capacity = points;
    constexpr std::size_t kContactLists = sizeof(Contact) / sizeof(float);
    point_lists.resize(2 * kPointLists + kContactLists, points * sizeof(float));
    contact_count = 0;
    survivors.forget();
  }
  const std::size_t slots = (std::size_t{1} << tree.depth) + kSpare;
  if (slots > node_capacity) {
    node_capacity = slots;
    for (NodeBuffer& buffer : nodes) buffer.lists.resize(3, slots * sizeof(float));
    survivors.forget();
  }
}

simd::FoundPoint* QueryScratch::State::reserve_found(std::size_t segments) {
  if (segments > found_capacity) {
    found_capacity = segments;
    found = std::make_unique_for_overwrite<simd::FoundPoint[]>(segments);
  }
  return found.get();
}

void QueryScratch::State::reserve_gradients() {
  if (point_capacity <= gradient_capacity) return;
  gradient_capacity = point_capacity;
  gradient_x = std::make_unique_for_overwrite<float[]>(gradient_capacity);
  gradient_y = std::make_unique_for_overwrite<float[]>(gradient_capacity);
  gradient_z = std::make_unique_for_overwrite<float[]>(gradient_capacity);
}

}  // namespace voxshell
