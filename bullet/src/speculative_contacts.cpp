#include "speculative_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <variant>

#include "conservative_advancement.h"
#include "contact_constants.h"
#include "edge_piece.h"
#include "flatness.h"
#include "foremost.h"
#include "impact.h"
#include "round_touch.h"
#include "second_shell.h"
#include "sliding_touch.h"

namespace voxshell::bullet {
namespace {

/// Where a place touches a field within the step.
struct Touch {
  Vec3f place;
  double gap;       ///< that is left there, not negative, meters
  Vec3 outwards;    ///< the field's normal
  double along;     ///< how far along its edge the place has moved, meters
  double fraction;  ///< of the step
};

/// A point of a body's surface that is followed, in its own body's frame.
struct SurfacePoint {
  const Field* own;
  Vec3 place;
  Vec3 normal;
  Pose path_from_own;  ///< at the start of the step
  bool is_on_curve;
  bool ends_at_edges;  ///< of the shell, and the other body has a sharp field

  /// Whether the field's surface bends nearer to a touch than that of the body does: along the
  /// tangent by which their normals differ, as a cylinder is straight along its axis alone, or all
  /// around what is flat, whose own edges are elements of the shell.
  template <class F>
  bool is_straighter(const Vec3& own_tangent, const F& field, const Vec3& on_field,
                     const Vec3& outwards, const Vec3& tangent, double radius) const {
    return std::visit(
        [&](const auto& of_own) {
          if (!is_on_curve) {
            const std::size_t bends = bends_from(of_own, place, normal, radius);
            return bends_before(field, on_field, outwards, radius, bends);
          }
          const Vec3 of_field = normalized(tangent - dot(tangent, outwards) * outwards);
          return bends_along_from(field, on_field, of_field, radius) <
                 bends_along_from(of_own, place, own_tangent, radius);
        },
        *own);
  }
};

/// A corner of a shape of Bullet's.
struct Corner {
  const Field* own;
  Vec3 place;          ///< own body's frame
  Pose path_from_own;  ///< as of a SurfacePoint
};

/// The place of a curved surface that faces a face of the other body, as long as it does.
struct FacingPlace {};

/// What is followed: a point of a surface, a piece of an edge, a place that faces, or one that
/// knows nothing of its surface.
using Element = std::variant<std::monostate, SurfacePoint, EdgePiece, Corner, FacingPlace>;

/// The normal with which something that is followed touches a field: it is one of both bodies.
template <class F>
class NormalOfTouch {
 public:
  /// @param path, field_from_path, offset  As of find_touch().
  NormalOfTouch(const PairStep& step, const F& field, const Path& path, const Pose& field_from_path,
                double offset, const Advance& reached, Touch& touch)
      : step_(step),
        field_(field),
        path_(path),
        field_from_path_(field_from_path),
        offset_(offset),
        reached_(reached),
        touch_(touch) {}

  /// Where an edge of the field is flush with one of the body, rounding decides on its normal:
  /// takes the one that both bodies show there.
  template <class Own>
  void agree(const Own& own, const Vec3& place, const Pose& path_from_own) {
    const Vec3 direction = toward_from(path_from_own);
    const Vec3 shown = normal_outside(own, place, direction, step_.touching_gap());
    if (dot(shown, direction) >= kForemostCosine) return;
    const Vec3 outwards = -in_field(path_from_own, shown);
    const Vec3 gap = (reached_.gap + offset_) * touch_.outwards;
    const Vec3 of_field = normal_outside(field_, on_field(), outwards, step_.touching_gap());
    if (dot(of_field, outwards) < kForemostCosine) return;
    touch_.outwards = of_field;
    touch_.gap = std::max(dot(gap, of_field) - offset_, 0.0);
  }

  /// False of what does not touch, as something beside it comes before.
  bool settle(const SurfacePoint& point) {
    if (!point.is_on_curve) agree(*point.own, point.place, point.path_from_own);
    const Vec3 out_of_field = -in_field(point.path_from_own, point.normal);
    const double cosine = dot(touch_.outwards, out_of_field);
    if (cosine >= -static_cast<double>(kAlignedCosine)) return true;
    // The tangent along which the two normals differ.
    const Vec3 tangent = normalized(touch_.outwards - cosine * out_of_field);
    if (!point.is_straighter(in_own(point.path_from_own, tangent), field_, on_field(),
                             touch_.outwards, tangent, step_.ball.radius)) {
      return !point.ends_at_edges ||
             shows(*point.own, point.place, toward_from(point.path_from_own));
    }
    const auto depth = depth_along(field_, static_cast<Vec3>(touch_.place), out_of_field, offset_,
                                   kColumnGaps * step_.touching_gap());
    if (!depth) return false;
    touch_.outwards = out_of_field;
    touch_.gap = std::max(-*depth, 0.0);
    return true;
  }
  bool settle(const EdgePiece& edge) {
    if (touch_.along != 0.0) return true;
    agree(*edge.own, edge.place, edge.path_from_own);
    if (step_.restitution > 0.0) return true;
    const auto around = around_edge(edge.along, toward_from(edge.path_from_own));
    return !around || shows(*edge.own, edge.place, *around);
  }
  bool settle(const Corner& corner) {
    agree(*corner.own, corner.place, corner.path_from_own);
    return true;
  }
  bool settle(const FacingPlace& /*place*/) {
    const double distance = kFlatScales[0] * step_.ball.radius;
    return bend_of(field_, on_field(), touch_.outwards, distance) <= kEdgeBend;
  }
  bool settle(std::monostate /*unknown*/) { return true; }

 private:
  /// Directions of the own body, where it has turned to by then.
  Vec3 in_field(const Pose& path_from_own, const Vec3& direction) const {
    return field_from_path_.rotate(
        path_.turned_at(reached_.fraction, path_from_own.rotate(direction)));
  }
  Vec3 in_own(const Pose& path_from_own, const Vec3& direction) const {
    return path_from_own.inverse().rotate(
        path_.turned_back(reached_.fraction, field_from_path_.inverse().rotate(direction)));
  }
  /// Toward the other body.
  Vec3 toward_from(const Pose& path_from_own) const {
    return in_own(path_from_own, -touch_.outwards);
  }
  Vec3 on_field() const {
    return static_cast<Vec3>(touch_.place) - (reached_.gap + offset_) * touch_.outwards;
  }
  template <class Own>
  bool shows(const Own& own, const Vec3& place, const Vec3& direction) const {
    const double distance = kOutsideOfMargin * step_.rest_margin;
    return dot(normal_outside(own, place, direction, distance), direction) >= kForemostCosine;
  }

  const PairStep& step_;
  const F& field_;
  const Path& path_;
  const Pose& field_from_path_;
  double offset_;
  const Advance& reached_;
  Touch& touch_;
};

/// @param path             Of what is followed, in the frame of the shell.
/// @param field_from_path  Its pose in the field, at the start of the step.
/// @param steps            For how long it is followed.
/// @param offset           How much nearer the surface is than the field's zero: for balls, and for
/// Bullet's margins. Meters.
/// @param element          What is followed.
template <class F>
std::optional<Touch> find_touch(const PairStep& step, const F& field, const Path& path,
                                const Pose& field_from_path, double steps, double offset,
                                const Element& element) {
  const auto* edge = std::get_if<EdgePiece>(&element);
  Crossing crossing;
  const auto place_at = [&](double fraction) {
    const Vec3 place = field_from_path.transform_point(path.at(fraction));
    if (edge == nullptr) return static_cast<Vec3f>(place);
    const double way = step.restitution > 0.0 ? fraction * path.length()
                                              : std::max(path.length(), step.touching_gap());
    EdgePiece turned = *edge;
    turned.along_in_field =
        field_from_path.rotate(path.turned_at(fraction, edge->path_from_own.rotate(edge->along)));
    crossing = find_crossing(turned, field, place, way);
    return static_cast<Vec3f>(place + crossing.along * turned.along_in_field);
  };
  const auto reached = advance(path.length(), step.touching_gap(), steps, [&](double fraction) {
    return clearance_of(field, place_at(fraction), offset);
  });
  if (!reached) return std::nullopt;
  Touch touch{place_at(reached->fraction), std::max(reached->gap, 0.0), {}, 0.0, reached->fraction};
  touch.along = crossing.along;
  touch.outwards = normalized(
      crossing.along != 0.0 ? crossing.outwards : static_cast<Vec3>(field.gradient(touch.place)));
  NormalOfTouch<F> normal(step, field, path, field_from_path, offset, *reached, touch);
  const bool touches = std::visit([&](const auto& known) { return normal.settle(known); }, element);
  if (!touches) return std::nullopt;
  return touch;
}

/// Where nothing rebounds, edges that lie flat are places, too: beside flush faces, a crossing has
/// a normal that leans, and would brake what slides. Points of curved surfaces are no faces,
/// however small the facets' bend.
Element element_of(const PairStep& step, const Side& side, const Contact& contact, std::uint32_t id,
                   const Vec3& place, const Pose& path_from_own, const Pose& field_from_own) {
  const PointShell& shell = *side.participant().shell;
  const Field& own = side.model()->field();
  const PosedPair& pair = *step.pair;
  const Side& other = &side == &pair.shell_side() ? pair.field_side() : pair.shell_side();
  const bool ends_at_edges = side.has_sharp_field() && other.has_sharp_field() &&
                             is_gentle(step, impact_of(step, contact));
  if (shell.is_point(id)) {
    if (!lies_on_curve(*side.model(), id)) {
      const auto normal = static_cast<Vec3>(shell.normals()[id]);
      return SurfacePoint{&own, place, normal, path_from_own, false, ends_at_edges};
    }
    const SmoothSurface& surface = side.model()->smooth_surface();
    // What has slid is no longer where its sample is.
    const SmoothSurface::Place on = surface.nearest(place, surface.triangle_of(id));
    return SurfacePoint{&own, place, surface.normal(on), path_from_own, true, false};
  }
  if (id >= shell.element_count()) return {};
  if (step.restitution > 0.0) {
    return edge_piece_of(side, id, place, path_from_own, field_from_own, kNearestWithinSine);
  }
  if (!ends_at_edges) return {};
  return edge_piece_of(side, id, place, path_from_own, field_from_own, kLeaningSine);
}

/// Features of the sides of cylinders and capsules are of a surface that is straight.
Element element_of(const PosedPair& pair, const Feature& feature, const Pose& field_from_shell) {
  const Field& field = pair.field();
  const bool is_straight =
      std::holds_alternative<CylinderField>(field) || std::holds_alternative<CapsuleField>(field);
  if (feature.radius > 0.0) return {};
  const Vec3 place = field_from_shell.transform_point(feature.place);
  if (!is_straight) {
    // Planes that bound a hull have no normals between them.
    if (std::holds_alternative<ConvexField>(field)) return {};
    return Corner{&field, place, field_from_shell.inverse()};
  }
  const Vec3 normal = std::visit(
      [&](const auto& typed) {
        return normalized(static_cast<Vec3>(typed.gradient(static_cast<Vec3f>(place))));
      },
      field);
  return SurfacePoint{&field, place, normal, field_from_shell.inverse(), true, false};
}

/// How much of its gap a contact closes in a step, where it acts, meters.
double closing_at(const PairStep& step, const RelativeMotion& motion, const Contact& contact) {
  const Vec3 velocity =
      motion.velocity_at(static_cast<Vec3>(contact.point)) + motion.velocity_of_fall;
  return -dot(velocity, static_cast<Vec3>(contact.normal)) * step.time_step;
}

/// The depth of a contact that touches later, whose normal and place are given: the velocity that
/// its place begins the step with, which is what solvers change, takes it there; none where it does
/// not. Another place, of the other body or of the same edge, may turn by more in the step.
std::optional<float> depth_of(const PairStep& step, const RelativeMotion& motion,
                              const Touch& touch, const Contact& contact) {
  const double closing = closing_at(step, motion, contact);
  if (!(closing > 0.0)) return std::nullopt;
  return static_cast<float>(-(touch.fraction * closing + touch.gap) - step.thickness);
}

/// Of a feature, or a point of the second shell, in the field of the shell's model.
std::optional<Contact> find_in_shell_body(const PairStep& step, const RelativeMotion& motion,
                                          const Feature& feature, std::uint32_t id, double steps,
                                          const Element& element) {
  const PosedPair& pair = *step.pair;
  const GridField& field = pair.shell_side().model()->grid();
  const Path path(motion.reversed(), feature.place, step.time_step);
  const auto touch =
      find_touch(step, field, path, Pose{}, steps, feature.radius + step.thickness, element);
  if (!touch) return std::nullopt;
  const auto outwards = static_cast<Vec3f>(touch->outwards);
  Feature slid = feature;
  if (const auto* edge = std::get_if<EdgePiece>(&element)) {
    slid.place = slid.place + touch->along * edge->along_in_field;
  }
  Contact touching = contact_of(slid, id, outwards, -step.thickness);
  // The shell's place, as in put_on_field().
  const bool is_larger = id < kFirstFeature && step.larger == &pair.field_side();
  if (is_larger) touching.point = touch->place - static_cast<float>(touch->gap) * outwards;
  const auto depth = depth_of(step, motion, *touch, touching);
  if (!depth) return std::nullopt;
  touching.depth = *depth;
  if (!is_larger) touching = contact_of(slid, id, outwards, static_cast<double>(*depth));
  if (id < kFirstFeature) {
    RoundTouch(step, motion, touch->fraction, touch->gap).move(path, touching);
  }
  return touching;
}

/// Whether the center of a ball, where it touches, is as near to one wall as to another: the field
/// has no normal of either there.
bool is_between_walls(const GridField& field, const Feature& ball, const Contact& touch) {
  const Vec3f center = touch.point - static_cast<float>(ball.radius) * touch.normal;
  return length(static_cast<Vec3>(field.gradient(center))) < kOneWall;
}

/// Makes a plane's gap as wide as what the bodies close.
void widen(const PairStep& step, double closing, Contact& plane) {
  const Vec3 on_field = step.field_from_shell.transform_point(
      static_cast<Vec3>(plane.point) + plane.depth * static_cast<Vec3>(plane.normal));
  plane.depth = static_cast<float>(-closing - step.thickness);
  if (is_shell_larger(step)) put_on_field(step, on_field, plane);
}

/// When the bodies reach a plane, as a fraction of the step.
double time_of(const PairStep& step, const RelativeMotion& motion, const Contact& plane) {
  const double closing = closing_at(step, motion, plane);
  const double gap = -static_cast<double>(plane.depth) - step.thickness;
  return closing > 0.0 ? gap / closing : kNever;
}

/// Follows the place that a contact is at, which turns with its body or goes on facing the other.
std::optional<Contact> follow_place(const PairStep& step, const RelativeMotion& motion,
                                    std::span<const Feature> features, const Contact& contact,
                                    double steps, bool turns) {
  const PosedPair& pair = *step.pair;
  if (contact.id >= kFirstFeature) {
    const Feature& feature = features[contact.id - kFirstFeature];
    const Element element = element_of(pair, feature, step.field_from_shell);
    const auto touch = find_in_shell_body(step, motion, feature, contact.id, steps, element);
    const bool is_ball = feature.radius > 0.0;
    if (touch && is_ball && is_between_walls(pair.shell_side().model()->grid(), feature, *touch)) {
      return contact;
    }
    return touch;
  }
  if (contact.id >= kFirstOfSecond) {
    const Vec3 place = place_of_second(contact);
    const std::uint32_t id = contact.id - kFirstOfSecond;
    const Pose shell_from_field = step.field_from_shell.inverse();
    const Element element = !turns ? Element(FacingPlace{})
                                   : element_of(step, pair.field_side(), contact, id,
                                                step.field_from_shell.transform_point(place),
                                                shell_from_field, shell_from_field);
    return find_in_shell_body(step, motion, {place, 0.0}, contact.id, steps, element);
  }
  const auto point = static_cast<Vec3>(contact.point);
  const Path path(motion, point, step.time_step);
  const Element element = !turns ? Element(FacingPlace{})
                                 : element_of(step, pair.shell_side(), contact, contact.id, point,
                                              Pose{}, step.field_from_shell);
  const auto touch = std::visit(
      [&](const auto& field) {
        return find_touch(step, field, path, step.field_from_shell, steps, step.thickness, element);
      },
      pair.field());
  if (!touch) return std::nullopt;
  Contact touching = contact;
  touching.normal = static_cast<Vec3f>(step.field_from_shell.inverse().rotate(touch->outwards));
  if (const auto* edge = std::get_if<EdgePiece>(&element)) {
    touching.point = static_cast<Vec3f>(point + touch->along * edge->along);
  }
  const double apart = touch->gap + step.thickness;
  const Vec3 on_field = static_cast<Vec3>(touch->place) - apart * touch->outwards;
  if (is_shell_larger(step)) put_on_field(step, on_field, touching);
  const auto depth = depth_of(step, motion, *touch, touching);
  if (!depth) return std::nullopt;
  touching.depth = *depth;
  if (is_shell_larger(step)) put_on_field(step, on_field, touching);
  RoundTouch(step, motion, touch->fraction, touch->gap).move(path, touching);
  return touching;
}

}  // namespace

std::optional<Contact> find_speculative(const PairStep& step, const RelativeMotion& motion,
                                        std::span<const Feature> features, const Contact& contact,
                                        double steps) {
  const auto found = follow_place(step, motion, features, contact, steps, /*turns=*/true);
  // What faces another plane by then passes the edge, or the bar, that a place beside it touches.
  if (found && dot(found->normal, contact.normal) >= kDoubleCosine) return found;
  if (!is_facing(step, contact)) return found;
  const auto sliding = find_sliding(step, motion, contact, steps);
  const auto time_of_plane = [&](const Contact& plane) { return time_of(step, motion, plane); };
  if (sliding && (!found || time_of_plane(sliding->contact) < time_of_plane(*found))) {
    return sliding->contact;
  }
  if (found) return found;
  // The place turns away, and another one faces the other body.
  const bool is_of_shell = contact.id < kFirstOfSecond;
  return follow_place(step, is_of_shell ? motion.unspun() : motion.reversed().unspun().reversed(),
                      features, contact, steps, /*turns=*/false);
}

void allow_motion(const PairStep& step, const RelativeMotion& motion,
                  std::span<const Feature> features, const Contact& found, double allowed,
                  Contact& plane) {
  if (step.pair->has_triangles()) return;
  const double closing = closing_at(step, motion, plane);
  if (closing <= impact_of(step, plane).gap) return;
  PairStep thinner = step;
  thinner.thickness -= allowed;
  if (find_speculative(thinner, motion, features, found, 1.0)) return;
  widen(step, closing, plane);
}

void allow_motion_after(const PairStep& step, const AfterTouch& after,
                        std::span<const Feature> features, const Contact& found, Contact& plane) {
  if (step.pair->has_triangles()) return;
  // The solver has bodies move like that from the start of the step on.
  const double closing = closing_at(step, after.motion, plane);
  if (closing <= impact_of(step, plane).gap) return;
  PairStep rest = step;
  rest.time_step = (1.0 - after.fraction) * step.time_step;
  rest.field_from_shell = step.field_from_shell_after(after.fraction);
  // Where the field's body is then, as the shell's sees it.
  const Pose then_from_now = rest.field_from_shell.inverse() * step.field_from_shell;
  Contact place = found;
  std::array<Feature, 1> feature{};
  if (found.id >= kFirstFeature) {
    feature[0] = features[found.id - kFirstFeature];
    feature[0].place = then_from_now.transform_point(feature[0].place);
    place.id = kFirstFeature;
  } else if (found.id >= kFirstOfSecond) {
    const Vec3 moved =
        then_from_now.transform_point(place_of_second(found)) - place_of_second(found);
    place.point = found.point + static_cast<Vec3f>(moved);
  }
  if (find_speculative(rest, after.motion, feature, place, 1.0)) return;
  widen(step, closing, plane);
}

void move_to_start(const PairStep& step, double fraction, std::vector<Contact>& contacts) {
  const Pose field_from_shell_then = step.field_from_shell_after(fraction);
  for (Contact& contact : contacts) {
    const auto normal = static_cast<Vec3>(contact.normal);
    const double gap = -static_cast<double>(contact.depth) - step.thickness;
    const Vec3 on_field = field_from_shell_then.transform_point(
        static_cast<Vec3>(contact.point) + static_cast<double>(contact.depth) * normal);
    put_on_field(step, on_field, contact);
    const double closing = closing_of(step, impact_of(step, contact));
    contact.depth = static_cast<float>(-std::max(gap, 0.0) - fraction * closing - step.thickness);
    put_on_field(step, on_field, contact);
  }
  std::erase_if(contacts,
                [&](const Contact& contact) { return impact_of(step, contact).gap < 0.0; });
}

}  // namespace voxshell::bullet
