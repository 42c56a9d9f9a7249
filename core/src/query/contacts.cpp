#include "voxshell/contacts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "query/deepest.h"
#include "query/edge_search.h"
#include "query/posed.h"
#include "query/scratch.h"
#include "query/walk.h"

namespace voxshell {
namespace {

/// No point of a sphere moves by more than this between two poses, meters.
double bound_motion(const Pose& from, const Pose& to, const Sphere& sphere) {
  const auto center = static_cast<Vec3>(sphere.center);
  const Vec3 turn_x = to.rotation.row_x - from.rotation.row_x;
  const Vec3 turn_y = to.rotation.row_y - from.rotation.row_y;
  const Vec3 turn_z = to.rotation.row_z - from.rotation.row_z;
  // The Frobenius norm is at least the spectral one.
  const double turn =
      std::sqrt(squared_length(turn_x) + squared_length(turn_y) + squared_length(turn_z));
  return length(to.transform_point(center) - from.transform_point(center)) +
         turn * static_cast<double>(sphere.radius);
}

/// How far the next poses may be expected to stray, given the last motion. Looking that far ahead
/// leaves more survivors, which pays while the motion is small against a slot; below the least
/// there would hardly be fewer, and bodies that tremble would be searched for anew every few steps.
double choose_growth(double motion, double spacing) {
  constexpr double kSteps = 4.0;
  constexpr double kLeast = 0.01;  // spacings
  constexpr double kMost = 0.25;   // spacings
  const double ahead = kSteps * motion;
  return ahead <= kMost * spacing ? std::max(ahead, kLeast * spacing) : 0.0;
}

/// The points below the margin.
template <class V>
simd::PointList find_points(const simd::PosedView<V>& posed, const simd::TreeView& tree,
                            const PointShell& shell, const Pose& field_from_shell, float margin,
                            const V& field, QueryScratch::State& state) {
  const auto& kernels = simd::query_kernels<V>(simd::active_isa());
  simd::PointList points = state.empty_points();
  auto& survivors = state.survivors;
  const auto evaluate = [&] {
    if (survivors.growth > 0.0) {
      kernels.evaluate_sifted(posed, survivors.points, margin, points);
    } else {
      kernels.evaluate(posed, tree, survivors.slots, margin, points);
    }
    survivors.last_asked = field_from_shell;
    return points;
  };
  const Sphere& root = shell.tree().spheres(1)[0];
  double growth = 0.0;
  const V* known = std::get_if<V>(&survivors.field);
  if (known != nullptr && *known == field && survivors.tree == tree.serial &&
      survivors.margin == margin) {
    const double last_motion = bound_motion(survivors.last_asked, field_from_shell, root);
    // Those that were not grown have been asked for at one pose only.
    const double motion = survivors.growth <= 0.0
                              ? last_motion
                              : bound_motion(survivors.field_from_shell, field_from_shell, root);
    if (motion <= survivors.growth) return evaluate();
    growth = choose_growth(last_motion, shell.spacing());
  }
  // Rounded up, so that it bounds the float64 that poses are compared by.
  const float grown = growth == 0.0 ? 0.0f : static_cast<float>(growth * 1.000001);
  survivors.slots =
      walk_down(posed, tree, margin, grown, SphereBounds::kUnwanted, state, [](const simd::Seeds&) {
        return true;
      }).nodes;
  if (growth > 0.0) {
    survivors.points = state.empty_survivors();
    kernels.sift(posed, tree, survivors.slots, margin, grown, survivors.points);
  }
  survivors.field = field;
  survivors.tree = tree.serial;
  survivors.field_from_shell = field_from_shell;
  survivors.margin = margin;
  survivors.growth = growth;
  const simd::PointList found = evaluate();
  state.keep_survivors();
  return found;
}

/// The places on edges that are below the margin. The pieces that may have some are kept for the
/// next query, as points are.
template <class V>
simd::PointList find_edges(const simd::PosedView<V>& posed, const EdgeSegments& segments,
                           const Pose& field_from_shell, float margin, const V& field,
                           QueryScratch::State& state) {
  const simd::EdgeView edges = segments.view();
  state.reserve(edges.tree);
  auto& survivors = state.survivors;
  const auto refine = [&] {
    simd::PointList found = state.empty_points();
    simd::query_kernels<V>(simd::active_isa())
        .refine_edges(posed, edges, survivors.points, margin, found);
    survivors.last_asked = field_from_shell;
    return found;
  };
  Sphere root = segments.tree().spheres(1)[0];
  root.radius += edges.reach;
  double growth = 0.0;
  const V* known = std::get_if<V>(&survivors.field);
  if (known != nullptr && *known == field && survivors.tree == edges.tree.serial &&
      survivors.margin == margin) {
    const double motion = bound_motion(survivors.field_from_shell, field_from_shell, root);
    if (motion <= survivors.growth) return refine();
    const double last_motion = bound_motion(survivors.last_asked, field_from_shell, root);
    growth = choose_growth(last_motion, 2.0 * static_cast<double>(edges.reach));
  }
  const float grown = growth == 0.0 ? 0.0f : static_cast<float>(growth * 1.000001);
  survivors.points = list_pieces(posed, edges, margin, grown, state);
  survivors.field = field;
  survivors.tree = edges.tree.serial;
  survivors.field_from_shell = field_from_shell;
  survivors.margin = margin;
  survivors.growth = growth;
  const simd::PointList found = refine();
  state.keep_survivors();
  return found;
}

/// Questions to bodies that move together differ by the margin alone, which follows their speed.
bool is_of_same_place(const QueryScratch::State::Question& a,
                      const QueryScratch::State::Question& b) {
  QueryScratch::State::Question other = b;
  other.margin = a.margin;
  return a == other;
}

/// The margin that an answer is worth finding for, of which the one that is asked for is a part: of
/// a margin that grows, the next steps ask for more.
float choose_margin(float margin, float last_margin) {
  constexpr float kAhead = 1.5f;
  return margin > last_margin ? kAhead * margin : last_margin;
}

/// Whether the answer for one margin holds that for another, and not too much beside it.
bool may_serve(float found, float margin) {
  constexpr float kMost = 2.0f;
  return margin > 0.0f && margin <= found && found <= kMost * margin;
}

std::size_t drop_beyond(float margin, Contact* contacts, std::size_t count) {
  return static_cast<std::size_t>(
      std::remove_if(contacts, contacts + count,
                     [&](const Contact& contact) { return !(-contact.depth < margin); }) -
      contacts);
}

}  // namespace

std::span<const Contact> find_contacts(const Field& field, const PointShell& shell,
                                       const Pose& field_from_shell, const ContactOptions& options,
                                       QueryScratch& scratch) {
  QueryScratch::State& state = scratch.state();
  const simd::TreeView tree = view_tree(shell);
  const EdgeSegments* edges = shell.edges();
  const std::uint64_t edge_serial = edges == nullptr ? 0 : edges->view().tree.serial;
  with_view(field, [&]<class V>(const auto& typed, const V& view) {
    const auto posed = make_posed(typed, view, shell, field_from_shell);
    QueryScratch::State::Question question{view,           tree.serial,    edge_serial,
                                           bits_of(posed), options.margin, options.max_points};
    const bool is_asked_again = is_of_same_place(question, state.asked);
    const std::size_t pieces = shell.element_count() - shell.size();
    const float last_margin = state.asked.margin;
    const auto leave_wanted = [&] {
      if (question.margin == options.margin) return;
      state.lists().contact_count =
          drop_beyond(options.margin, state.contact_data(), state.lists().contact_count);
    };
    // Of what lists of its own hold, and of the deepest, nothing may be dropped.
    const bool may_drop = !state.owns_lists() && shell.element_count() <= options.max_points;
    const auto serves = [&](float margin) {
      return margin == options.margin || (may_drop && may_serve(margin, options.margin));
    };
    if (is_asked_again && serves(last_margin) && state.recall_contacts(tree, pieces)) {
      question.margin = last_margin;
      leave_wanted();
      return;
    }
    if (is_asked_again) {
      const float margin = choose_margin(options.margin, last_margin);
      if (serves(margin)) question.margin = margin;
    }
    state.reserve(tree, pieces);
    const auto& kernels = simd::query_kernels<V>(simd::active_isa());
    const simd::PointList points =
        find_points(posed, tree, shell, field_from_shell, question.margin, view, state);
    kernels.complete(posed, tree, points, state.contact_data());
    state.lists().contact_count = points.count;
    if (edges != nullptr) {
      const simd::PointList found =
          find_edges(posed, *edges, field_from_shell, question.margin, view, state.of_edges());
      complete_on_edges(posed, edges->view(), found, shell.size(), state);
    }
    state.lists().contact_count =
        keep_deepest(state.contact_data(), state.lists().contact_count, options.max_points);
    state.asked = question;
    state.keep_contacts(is_asked_again);
    leave_wanted();
  });
  return scratch.contacts();
}

}  // namespace voxshell
