#include "voxshell/pair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <tuple>
#include <type_traits>
#include <variant>

namespace voxshell {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

Error refuse(const char* message) { return Error{ErrorCode::kInvalidArgument, message}; }

/// A body's own numbers, of which the role of a pair is made. Meters.
struct Body {
  bool has_shell = false;
  std::size_t points = 0;
  double coverage = 0.0;     ///< how far the surface lies outside of the shell
  bool has_edges = false;    ///< its sharp edges, if there are any, are elements of the shell
  double tie = 0.0;          ///< by so much they may be deeper than they are seen
  double gap = 0.0;          ///< no place of the surface is farther from an element
  double field_error = 0.0;  ///< of the distance
  bool is_sharp = false;
  double curvature = 0.0;  ///< convex, 1/meters
  double thickness = kUnbounded;
  Vec3 sides{kUnbounded, kUnbounded, kUnbounded};  ///< of the bounds, ascending

  double size() const { return sides.z; }
};

Vec3 ascending(const Vec3& v) {
  std::array<double, 3> sides{v.x, v.y, v.z};
  std::sort(sides.begin(), sides.end());
  return {sides[0], sides[1], sides[2]};
}

template <class F>
void add_analytic(const F& field, Body& body) {
  const auto set = [&](const Vec3& sides, double curvature, bool is_sharp) {
    body.sides = ascending(sides);
    body.thickness = body.sides.x;
    body.curvature = curvature;
    body.is_sharp = is_sharp;
  };
  const auto across = [](double radius) { return 2.0 * radius; };
  if constexpr (std::is_same_v<F, BoxField>) {
    set(2.0 * field.half_extents, 0.0, true);
  } else if constexpr (std::is_same_v<F, SphereField>) {
    const double d = across(field.radius);
    set({d, d, d}, 1.0 / field.radius, false);
  } else if constexpr (std::is_same_v<F, CapsuleField>) {
    const double d = across(field.radius);
    set({d, d, field.length + d}, 1.0 / field.radius, false);
  } else if constexpr (std::is_same_v<F, CylinderField>) {
    const double d = across(field.radius);
    set({d, d, field.length}, 1.0 / field.radius, true);
  } else if constexpr (std::is_same_v<F, ConeField>) {
    const double d = across(field.radius);
    set({d, d, field.height}, 1.0 / field.radius, true);
  } else if constexpr (std::is_same_v<F, ConvexField>) {
    const double most = 2.0 * field.reach();
    set({most, most, most}, 0.0, true);
  } else {
    // A plane has no sizes, and describe() knows those of grids.
    static_assert(std::is_same_v<F, PlaneField> || std::is_same_v<F, GridField>);
  }
}

Body describe(const Participant& participant) {
  Body body;
  if (const auto* grid = std::get_if<GridField>(participant.field)) {
    body.sides = ascending(grid->surface_bounds().extents());
    body.thickness = participant.thickness > 0.0 ? participant.thickness : body.sides.x;
    body.field_error = grid->interpolation_error();
    body.is_sharp = true;
  } else {
    std::visit([&](const auto& field) { add_analytic(field, body); }, *participant.field);
  }
  if (participant.shell != nullptr) {
    body.has_shell = true;
    body.points = participant.shell->element_count();
    body.gap = std::sqrt(3.0) * participant.shell->spacing();
    body.coverage = body.gap;
  }
  if (participant.accuracy != nullptr) {
    const Accuracy& accuracy = *participant.accuracy;
    body.field_error = accuracy.distance.worst;
    body.coverage = accuracy.coverage.worst;
    body.gap = accuracy.gap;
    body.is_sharp = accuracy.is_sharp;
    body.curvature = accuracy.curvature;
  }
  if (const EdgeSegments* edges = body.has_shell ? participant.shell->edges() : nullptr) {
    body.has_edges = true;
    body.tie = static_cast<double>(edges->tie());
  }
  return body;
}

/// Whether a body may lie wholly inside another, as far as sides and thickness tell: it would touch
/// no element of that one's shell.
bool may_hide_inside(const Body& inner, const Body& outer) {
  return inner.size() < outer.size() && inner.thickness < outer.sides.x;
}

/// The depth to which the body may enter between elements of a shell that are this far apart.
double enter_between(const Body& body, double gap) {
  if (body.is_sharp) return std::min(gap, body.size());
  return std::min({0.5 * body.curvature * gap * gap, gap, body.size()});
}

double miss_of(const Body& shell, const Body& field) {
  if (!shell.has_shell) return kUnbounded;
  return shell.coverage + field.field_error + enter_between(field, shell.gap);
}

/// Whatever either of the shells finds is found. Only an edge that crosses an edge may enter
/// between the elements of both, unless the edges of one of them are elements.
double miss_of_both(const Body& a, const Body& b, double miss_of_a, double miss_of_b) {
  if (!a.has_shell || !b.has_shell) return kUnbounded;
  const double crossing = a.has_edges || b.has_edges
                              ? std::max(a.tie, b.tie)
                              : std::min(enter_between(a, b.gap), enter_between(b, a.gap));
  const double left = a.coverage + b.coverage + std::max(a.field_error, b.field_error) + crossing;
  return std::min({left, miss_of_a, miss_of_b});
}

/// Whether a model could lie between the points of a coarser shell, unseen.
bool slips_between(const Participant& body, const PointShell& shell) {
  const auto* grid = std::get_if<GridField>(body.field);
  if (grid == nullptr || body.shell->spacing() >= shell.spacing()) return false;
  const Vec3 sides = grid->surface_bounds().extents();
  return shell.spacing() > std::min({sides.x, sides.y, sides.z});
}

Role take_fewest(const Participant& a, const Participant& b) {
  if (b.shell->size() < a.shell->size()) {
    return slips_between(a, *b.shell) ? Role::kA : Role::kB;
  }
  return slips_between(b, *a.shell) ? Role::kB : Role::kA;
}

/// Orders bodies by what is theirs alone, so that a role does not depend on who is called a.
bool is_cheaper(const Body& body, double miss, const Body& than, double miss_of_that) {
  const auto rank = [](const Body& of, double missed) {
    return std::tuple(of.points, missed, of.sides.z, of.sides.y, of.sides.x, of.gap);
  };
  return rank(body, miss) < rank(than, miss_of_that);
}

/// Between the elements of a shell, the normal of a smooth body turns by this, radians.
double turn_between(const Body& shell, const Body& field) { return shell.gap * field.curvature; }

Role take_most_accurate(const Body& a, const Body& b, const PairRole& pair) {
  const double tolerated = kMissedByOne * pair.thickness;
  const auto will_do = [&](const Body& shell, const Body& field, double miss) {
    return miss <= tolerated && turn_between(shell, field) <= kTurnedByOne &&
           !may_hide_inside(field, shell);
  };
  const bool a_will_do = will_do(a, b, pair.miss_of_a);
  const bool b_will_do = will_do(b, a, pair.miss_of_b);
  if (a_will_do && b_will_do) {
    return is_cheaper(b, pair.miss_of_b, a, pair.miss_of_a) ? Role::kB : Role::kA;
  }
  if (a_will_do) return Role::kA;
  return b_will_do ? Role::kB : Role::kBoth;
}

}  // namespace

double compute_miss(const Participant& shell, const Participant& field) {
  return miss_of(describe(shell), describe(field));
}

PairBounds bound_pair(const Participant& a, const Participant& b, Role role) {
  const auto describe_proved = [](const Participant& participant) {
    Body body = describe(participant);
    if (const auto* grid = std::get_if<GridField>(participant.field)) {
      body.field_error = grid->surface_error();
    }
    return body;
  };
  const Body body_a = describe_proved(a);
  const Body body_b = describe_proved(b);
  const auto by_spacing = [](const Participant& shell, const Body& field) {
    return shell.shell == nullptr ? kUnbounded
                                  : std::sqrt(3.0) * shell.shell->spacing() + field.field_error;
  };
  const auto is_by_tolerance = [](const Participant& participant) {
    const auto* grid = std::get_if<GridField>(participant.field);
    return participant.accuracy != nullptr && (grid == nullptr || grid->data().surface_error > 0.0);
  };
  const bool asks_a = role != Role::kB;
  const bool asks_b = role != Role::kA;
  const double miss_of_a = asks_a ? miss_of(body_a, body_b) : kUnbounded;
  const double miss_of_b = asks_b ? miss_of(body_b, body_a) : kUnbounded;
  PairBounds bounds;
  bounds.overlap =
      std::max(asks_a ? by_spacing(a, body_b) : 0.0, asks_b ? by_spacing(b, body_a) : 0.0);
  if ((!asks_a || is_by_tolerance(a)) && (!asks_b || is_by_tolerance(b))) {
    const double miss = role == Role::kBoth ? miss_of_both(body_a, body_b, miss_of_a, miss_of_b)
                                            : std::min(miss_of_a, miss_of_b);
    bounds.overlap = std::min(bounds.overlap, miss);
  }
  bounds.clearance = std::max(asks_a ? body_b.field_error : 0.0, asks_b ? body_a.field_error : 0.0);
  return bounds;
}

Result<PairRole> decide_role(const Participant& a, const Participant& b, ShellChoice choice) {
  const bool wants_a = choice == ShellChoice::kA || choice == ShellChoice::kBoth;
  const bool wants_b = choice == ShellChoice::kB || choice == ShellChoice::kBoth;
  if (wants_a && a.shell == nullptr) {
    return refuse("body a has no point shell: it is an analytic shape");
  }
  if (wants_b && b.shell == nullptr) {
    return refuse("body b has no point shell: it is an analytic shape");
  }
  if (a.shell == nullptr && b.shell == nullptr) {
    return refuse("neither body has a point shell: one of the two must be a model");
  }
  const Body body_a = describe(a);
  const Body body_b = describe(b);
  PairRole pair;
  pair.miss_of_a = miss_of(body_a, body_b);
  pair.miss_of_b = miss_of(body_b, body_a);
  pair.miss_of_both = miss_of_both(body_a, body_b, pair.miss_of_a, pair.miss_of_b);
  pair.wall = std::min(body_a.thickness, body_b.thickness);
  if (body_a.size() == body_b.size()) {
    pair.thickness = pair.wall;
    pair.side = std::min(body_a.sides.x, body_b.sides.x);
  } else {
    const Body& smaller = body_b.size() < body_a.size() ? body_b : body_a;
    pair.thickness = smaller.thickness;
    pair.side = smaller.sides.x;
  }
  if (a.shell == nullptr || choice == ShellChoice::kB) {
    pair.role = Role::kB;
  } else if (b.shell == nullptr || choice == ShellChoice::kA) {
    pair.role = Role::kA;
  } else if (choice == ShellChoice::kBoth) {
    pair.role = Role::kBoth;
  } else if (choice == ShellChoice::kFewest) {
    pair.role = take_fewest(a, b);
  } else {
    pair.role = take_most_accurate(body_a, body_b, pair);
  }
  if (pair.role != Role::kBoth) {
    pair.first = pair.role == Role::kA ? PairBody::kA : PairBody::kB;
  } else {
    const auto rank = [](const Body& shell, const Body& field, double miss) {
      return std::tuple(turn_between(shell, field), miss);
    };
    pair.first = rank(body_b, body_a, pair.miss_of_b) < rank(body_a, body_b, pair.miss_of_a)
                     ? PairBody::kB
                     : PairBody::kA;
  }
  pair.miss = pair.role == Role::kA   ? pair.miss_of_a
              : pair.role == Role::kB ? pair.miss_of_b
                                      : pair.miss_of_both;
  return pair;
}

std::optional<Contact> find_inner_contact(const Participant& body, const Field& field,
                                          const Pose& field_from_body, float margin) {
  constexpr float kDirected = 0.1f;  // of a gradient's length
  if (body.inner_point == nullptr || body.shell == nullptr) return std::nullopt;
  const Vec3f& point = *body.inner_point;
  const auto place = static_cast<Vec3f>(field_from_body.transform_point(static_cast<Vec3>(point)));
  return std::visit(
      [&](const auto& typed) -> std::optional<Contact> {
        const float distance = typed.distance(place);
        if (!(distance < std::min(margin, 0.0f))) return std::nullopt;
        const Vec3f gradient = typed.gradient(place);
        Vec3f normal{};
        if (squared_length(gradient) > kDirected * kDirected) {
          const auto outwards = normalized(static_cast<Vec3>(gradient));
          normal = static_cast<Vec3f>(field_from_body.inverse().rotate(outwards));
        }
        return Contact{static_cast<std::uint32_t>(body.shell->element_count()), -distance, point,
                       normal};
      },
      field);
}

bool is_enclosed(const Participant& inner, const Participant& outer, const Pose& outer_from_inner) {
  if (inner.shell == nullptr || outer.shell == nullptr) return false;
  const auto point = static_cast<Vec3>(inner.shell->points()[0]);
  const auto place = static_cast<Vec3f>(outer_from_inner.transform_point(point));
  return std::visit([&](const auto& typed) { return typed.distance(place) < 0.0f; }, *outer.field);
}

}  // namespace voxshell
