#include "voxshell/manifold.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>
#include <span>
#include <utility>

#include "query/edge_search.h"
#include "query/posed.h"
#include "query/scratch.h"
#include "query/walk.h"

namespace voxshell {
namespace {

/// The index of the contact with the largest score above `floor`, the first of equals; or the
/// number of contacts where there is none.
template <class Score>
std::uint32_t find_largest(std::span<const Contact> contacts, const Score& score,
                           float floor = 0.0f) {
  auto best = static_cast<std::uint32_t>(contacts.size());
  float best_score = floor;
  for (std::uint32_t i = 0; i < contacts.size(); ++i) {
    // Branchless: a processor cannot predict which contact raises it.
    const float s = score(contacts[i]);
    best = s > best_score ? i : best;
    best_score = s > best_score ? s : best_score;
  }
  return best;
}

}  // namespace

ManifoldPoints select_manifold(std::span<const Contact> contacts, std::size_t max_points) {
  assert(max_points >= 1 && max_points <= kManifoldSize);
  ManifoldPoints manifold;
  if (contacts.empty()) return manifold;
  const auto add = [&](std::uint32_t index) {
    if (index < contacts.size()) manifold.indices[manifold.count++] = index;
    return index < contacts.size() && manifold.count < max_points;
  };

  const std::uint32_t deepest = find_largest(
      contacts, [](const Contact& c) { return c.depth; }, -std::numeric_limits<float>::infinity());
  if (!add(deepest)) return manifold;
  const Vec3f a = contacts[deepest].point;

  const std::uint32_t farthest =
      find_largest(contacts, [&](const Contact& c) { return squared_length(c.point - a); });
  if (!add(farthest)) return manifold;
  const Vec3f b = contacts[farthest].point;

  const std::uint32_t widest = find_largest(
      contacts, [&](const Contact& c) { return squared_length(cross(b - a, c.point - a)); });
  if (!add(widest)) return manifold;
  const Vec3f c = contacts[widest].point;

  // A fourth point enlarges the area by the triangle that it makes with the side it lies beyond.
  const Vec3f up = cross(b - a, c - a);
  const auto added_area = [&](const Contact& contact) {
    const Vec3f p = contact.point;
    return std::max(
        {dot(cross(p - a, b - a), up), dot(cross(p - b, c - b), up), dot(cross(p - c, a - c), up)});
  };
  add(find_largest(contacts, added_area));
  return manifold;
}

void select_deepest_per_segment(std::span<const Contact> contacts, const PointShell& shell,
                                int level, std::vector<std::uint32_t>& deepest) {
  assert(level >= 1 && level <= PointSphereTree::kMaxLevel);
  deepest.clear();
  // Contacts ascend by id and segments are ranges of ids, so each segment's contacts are together.
  std::uint32_t current = 0;
  for (std::uint32_t i = 0; i < contacts.size(); ++i) {
    const std::uint32_t segment = shell.segment_of(contacts[i].id, level);
    if (deepest.empty() || segment != current) {
      deepest.push_back(i);
      current = segment;
    } else if (contacts[i].depth > contacts[deepest.back()].depth) {
      deepest.back() = i;
    }
  }
}

namespace {

/// Whether so few spheres are left that another level of the walk is worth more than searching
/// them. Slots are worth more: their points are listed, once for all that is looked for.
bool are_few(const simd::Seeds& left, const simd::TreeView& tree) {
  constexpr std::uint32_t kFew = simd::kMostSeeds / 8;
  const bool slots_follow = left.level == tree.level_count - 1;
  return left.nodes.count <= (slots_follow ? 3 * kFew / 2 : kFew);
}

/// Listing the points of what is left is the fastest search then.
bool are_slots(const simd::Seeds& seeds, const simd::TreeView& tree) {
  return seeds.level == tree.level_count;
}

simd::FoundPoint get(const simd::PointList& points, std::uint32_t i) {
  return {points.id[i], points.distance[i], {points.x[i], points.y[i], points.z[i]}};
}

void append(simd::PointList& points, const simd::FoundPoint& found) {
  points.id[points.count] = found.id;
  points.tag[points.count] = 0;
  points.distance[points.count] = found.distance;
  points.x[points.count] = found.point[0];
  points.y[points.count] = found.point[1];
  points.z[points.count] = found.point[2];
  ++points.count;
}

/// Those of the best that there are.
void append_found(std::span<const simd::FoundPoint> best, simd::PointList& points) {
  for (const simd::FoundPoint& found : best) {
    if (found.id != simd::kNone) append(points, found);
  }
}

simd::FoundPoint choose_deepest(const simd::PointList& points) {
  if (points.count == 0) return {simd::kNone, 0.0f, {}};
  std::uint32_t deepest = 0;
  float distance = points.distance[0];
  for (std::uint32_t i = 1; i < points.count; ++i) {
    if (points.distance[i] >= distance) continue;
    distance = points.distance[i];
    deepest = i;
  }
  return get(points, deepest);
}

/// Of points ascending by id.
void keep_deepest_per_segment(simd::PointList& points, const PointSphereTree& tree, int level) {
  const std::uint32_t count = std::exchange(points.count, 0u);
  std::uint32_t end = 0;  // of the last segment's ids
  for (std::uint32_t i = 0; i < count; ++i) {
    if (points.id[i] >= end) {
      end = tree.cluster_points(level, tree.segment(points.id[i], level)).end;
    } else if (points.distance[i] < points.distance[points.count - 1]) {
      --points.count;
    } else {
      continue;
    }
    append(points, get(points, i));
  }
}

/// Arrivals as kernels take them.
template <class V>
class PosedArrivals {
 public:
  template <class F>
  PosedArrivals(const F& field, const V& view, const PointShell& shell,
                std::span<const Arrival> arrivals)
      : count_(static_cast<std::uint32_t>(arrivals.size())) {
    for (std::size_t i = 0; i < arrivals.size(); ++i) {
      posed_[i] = make_posed(field, view, shell, arrivals[i].field_from_shell);
      margins_[i] = arrivals[i].margin;
    }
  }
  simd::Arrivals<V> view() const { return {posed_.data(), margins_.data(), count_}; }

 private:
  std::array<simd::PosedView<V>, kMostArrivals> posed_;
  std::array<float, kMostArrivals> margins_;
  std::uint32_t count_;
};

/// The deepest place of each segment of the edges' tree.
template <class V>
simd::PointList find_deepest_on_edges(const simd::PosedView<V>& posed, const simd::EdgeView& edges,
                                      const PointSphereTree& tree, int level, float margin,
                                      QueryScratch::State& state,
                                      const simd::Arrivals<V>& arrivals) {
  state.reserve(edges.tree);
  const simd::PointList pieces = list_pieces(posed, edges, margin, 0.0f, state, arrivals);
  std::uint32_t* ends = state.reserve_group_ends();
  std::uint32_t groups = 0;
  std::uint32_t end_of_segment = 0;  // of its ids
  for (std::uint32_t i = 0; i < pieces.count; ++i) {
    if (pieces.id[i] >= end_of_segment) {
      end_of_segment = tree.cluster_points(level, tree.segment(pieces.id[i], level)).end;
      ++groups;
    }
    ends[groups - 1] = i + 1;
  }
  simd::FoundPoint* best = state.reserve_found(groups);
  simd::query_kernels<V>(simd::active_isa())
      .find_deepest_edges(posed, edges, pieces, ends, groups, margin, best);
  simd::PointList found = state.empty_points();
  append_found({best, groups}, found);
  return found;
}

/// The places on a shell's edges that may be chosen beside its points; none where it has no edges.
template <class V>
class EdgePlaces {
 public:
  EdgePlaces(const simd::PosedView<V>& posed, const PointShell& shell, QueryScratch::State& state)
      : posed_(posed), shell_(shell), state_(state) {}

  void list(float margin) {
    if (shell_.edges() == nullptr) return;
    found_ = find_on_edges(posed_, shell_.edges()->view(), margin, state_.of_edges());
  }

  /// Without a list.
  simd::FoundPoint search_deeper_than(const simd::FoundPoint& point, float margin) const {
    if (shell_.edges() == nullptr) return point;
    const float limit = point.id == simd::kNone ? margin : point.distance;
    const simd::FoundPoint place =
        kernels().find_deepest_edge(posed_, shell_.edges()->view(), limit);
    return place.id == simd::kNone ? point : as_element(place);
  }

  /// Ties go to points, whose ids are smaller.
  simd::FoundPoint deeper_of(const simd::FoundPoint& point) const {
    if (found_.count == 0) return point;
    const simd::FoundPoint place = choose_deepest(found_);
    const bool is_deeper = point.id == simd::kNone || place.distance < point.distance;
    return is_deeper ? as_element(place) : point;
  }

  simd::FoundPoint wider_of(const simd::FoundPoint& point,
                            const simd::ManifoldSearch& search) const {
    if (found_.count == 0) return point;
    const simd::FoundPoint place = kernels().choose_widest(found_, search);
    if (place.id == simd::kNone) return point;
    const bool is_wider = point.id == simd::kNone || place.score > point.score;
    return is_wider ? as_element(place) : point;
  }

  /// Appends one of them to the contacts.
  void complete(simd::FoundPoint element) {
    element.id -= shell_.tree().point_count();
    state_.of_edges().reserve(shell_.edges()->view().tree);
    simd::PointList one = state_.of_edges().empty_points();
    append(one, element);
    complete_on_edges(posed_, shell_.edges()->view(), one, shell_.size(), state_);
  }

 private:
  static const simd::QueryKernels<V>& kernels() {
    return simd::query_kernels<V>(simd::active_isa());
  }

  simd::FoundPoint as_element(simd::FoundPoint place) const {
    place.id += shell_.tree().point_count();
    return place;
  }

  const simd::PosedView<V>& posed_;
  const PointShell& shell_;
  QueryScratch::State& state_;
  simd::PointList found_{};
};

}  // namespace

std::span<const Contact> find_manifold(const Field& field, const PointShell& shell,
                                       const Pose& field_from_shell, float margin,
                                       QueryScratch& scratch, std::size_t max_points) {
  assert(max_points >= 1 && max_points <= kManifoldSize);
  QueryScratch::State& state = scratch.state();
  const simd::TreeView tree = view_tree(shell);
  state.reserve(tree, shell.element_count() - shell.size());
  with_posed(field, shell, field_from_shell, [&]<class V>(const simd::PosedView<V>& posed) {
    const auto& kernels = simd::query_kernels<V>(simd::active_isa());
    const auto go_on = [&](const simd::Seeds& left) {
      return max_points > 1 && are_few(left, tree);
    };
    const simd::Seeds seeds =
        walk_down(posed, tree, margin, 0.0f, SphereBounds::kWanted, state, go_on);
    simd::PointList points = state.empty_points();
    simd::FoundPoint found{simd::kNone, 0.0f, {}};
    if (are_slots(seeds, tree)) {
      kernels.evaluate(posed, tree, seeds.nodes, margin, points);
      found = choose_deepest(points);
    } else {
      kernels.find_deepest(posed, tree, seeds, 0, margin, {}, &found);
    }
    EdgePlaces<V> on_edges(posed, shell, state);
    if (max_points == 1) {
      found = on_edges.search_deeper_than(found, margin);
    } else {
      on_edges.list(margin);
      found = on_edges.deeper_of(found);
    }
    simd::ManifoldSearch search{};
    std::array<simd::FoundPoint, kManifoldSize> chosen;
    std::size_t count = 0;
    while (found.id != simd::kNone) {
      chosen[count++] = found;
      if (count == max_points) break;
      std::copy_n(found.point, 3, search.chosen[search.count++]);
      found = are_slots(seeds, tree) ? kernels.choose_widest(points, search)
                                     : kernels.find_widest(posed, tree, seeds, search, margin);
      found = on_edges.wider_of(found, search);
    }
    state.lists().contact_count = 0;
    points.count = 0;
    const auto finish = [&] {
      kernels.complete(posed, tree, points, state.contact_data() + state.lists().contact_count);
      state.lists().contact_count += std::exchange(points.count, 0u);
    };
    for (std::size_t i = 0; i < count; ++i) {
      if (shell.is_point(chosen[i].id)) {
        append(points, chosen[i]);
      } else {
        finish();
        on_edges.complete(chosen[i]);
      }
    }
    finish();
  });
  return scratch.contacts();
}

std::span<const Contact> find_deepest_per_segment(const Field& field, const PointShell& shell,
                                                  const Pose& field_from_shell, int level,
                                                  float margin, QueryScratch& scratch,
                                                  std::span<const Arrival> arrivals) {
  assert(level >= 1 && level <= PointSphereTree::kMaxLevel);
  assert(arrivals.size() <= kMostArrivals);
  QueryScratch::State& state = scratch.state();
  const simd::TreeView tree = view_tree(shell);
  state.reserve(tree, shell.element_count() - shell.size());
  const int depth = 2 * (level - 1);
  with_view(field, [&]<class V>(const auto& typed, const V& view_of_field) {
    const auto posed = make_posed(typed, view_of_field, shell, field_from_shell);
    const PosedArrivals<V> posed_arrivals(typed, view_of_field, shell, arrivals);
    const simd::Arrivals<V> arriving = posed_arrivals.view();
    const auto& kernels = simd::query_kernels<V>(simd::active_isa());
    // Segments finer than slots have a bucket each.
    simd::Seeds seeds =
        walk_down(posed, tree, margin, 0.0f, SphereBounds::kWanted, state, [&](simd::Seeds& left) {
          keep_arriving(arriving, tree, 0.0f, left);
          return depth > tree.depth || are_few(left, tree);
        });
    if (are_slots(seeds, tree)) keep_arriving(arriving, tree, 0.0f, seeds);
    simd::PointList points = state.empty_points();
    // Whether a point arrives takes longer than listing it, so only the deepest are asked.
    if (are_slots(seeds, tree) && (arriving.count == 0 || depth > tree.depth)) {
      kernels.evaluate(posed, tree, seeds.nodes, margin, points);
      if (arriving.count > 0) kernels.keep_arriving_points(arriving, 0.0f, points);
      keep_deepest_per_segment(points, shell.tree(), level);
    } else {
      const std::size_t segments = std::size_t{1} << depth;
      simd::FoundPoint* best = state.reserve_found(segments);
      std::fill_n(best, segments, simd::FoundPoint{simd::kNone, 0.0f, {}});
      kernels.find_deepest(posed, tree, seeds, depth, margin, arriving, best);
      append_found({best, segments}, points);
    }
    kernels.complete(posed, tree, points, state.contact_data());
    state.lists().contact_count = points.count;
    if (const EdgeSegments* edges = shell.edges(); edges != nullptr) {
      const simd::EdgeView view = edges->view();
      const simd::PointList found = find_deepest_on_edges(posed, view, edges->tree(), level, margin,
                                                          state.of_edges(), arriving);
      complete_on_edges(posed, view, found, shell.size(), state);
    }
  });
  return scratch.contacts();
}

}  // namespace voxshell
