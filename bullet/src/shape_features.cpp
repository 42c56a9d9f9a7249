#include "shape_features.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <variant>

#include "conservative_advancement.h"
#include "contact_constants.h"
#include "eight_directions.h"

namespace voxshell::bullet {
namespace {

/// The points of a circle about the z axis that are its corners, and the one that is deepest in
/// the model's field as its center sees it.
void add_rim(double radius, double height, const Pose& model_from_shape, const GridField& field,
             std::vector<Feature>& features) {
  const auto add = [&](double x, double y) {
    features.push_back({model_from_shape.transform_point({radius * x, radius * y, height}), 0.0});
  };
  for (const auto& [x, y] : kEightDirections) add(x, y);
  const Vec3 center = model_from_shape.transform_point({0, 0, height});
  const Matrix3 shape_from_model = model_from_shape.rotation.transposed();
  const Vec3 out = shape_from_model * static_cast<Vec3>(field.gradient(static_cast<Vec3f>(center)));
  const double across = std::sqrt(out.x * out.x + out.y * out.y);
  if (across > kFlatRim) {
    add(-out.x / across, -out.y / across);
  } else {
    add(1.0, 0.0);
  }
}

/// The surface that is nearest to a ball, by steps along the ball's to its deepest place (Frank and
/// Wolfe 1956).
FeatureHold hold_nearest(const Feature& feature, double distance, const GridField& field) {
  FeatureHold hold{distance, normalized(field.gradient(static_cast<Vec3f>(feature.place)))};
  const auto below = [&](const Vec3f& normal) {
    return static_cast<Vec3f>(feature.place - feature.radius * static_cast<Vec3>(normal));
  };
  hold.distance = static_cast<double>(field.distance(below(hold.outwards)));
  for (int i = 0; i < kBallSteps; ++i) {
    const Vec3f next = normalized(field.gradient(below(hold.outwards)));
    const auto at_next = static_cast<double>(field.distance(below(next)));
    if (!(at_next < hold.distance)) break;
    hold = {at_next, next};
  }
  return hold;
}

/// The surface that the line from a feature inside the model to the shape's middle comes out of;
/// what `otherwise` says where it does not.
FeatureHold hold_on_the_way_in(const Feature& feature, const Vec3& middle, const GridField& field,
                               const FeatureHold& otherwise) {
  const Vec3 way_in = middle - feature.place;
  const double left = kLeftOfVoxel * field.voxel_size();
  const auto place_at = [&](double fraction) {
    return static_cast<Vec3f>(feature.place + fraction * way_in);
  };
  const auto reached = advance(length(way_in), left, kToOtherEnd, [&](double fraction) {
    const double depth = -static_cast<double>(field.distance(place_at(fraction)));
    return Clearance{depth, kSafeOfGap * depth};
  });
  if (!reached || reached->gap > left) return otherwise;
  const Vec3f outwards = normalized(field.gradient(place_at(reached->fraction)));
  const double depth = reached->fraction * dot(way_in, static_cast<Vec3>(outwards));
  return depth > 0.0 ? FeatureHold{-depth - feature.radius, outwards} : otherwise;
}

/// Nothing pushes a feature away from its shape's middle: it has passed the middle of a wall, or
/// its edge is nearer than the face that it came through. Where a corner touches an edge that is
/// flush with it, others of its shape's places tell which of the two faces it touches.
FeatureHold turn_inwards(const FeatureHold& hold, const Feature& feature, const Vec3& middle,
                         const GridField& field) {
  const double inwards = dot(static_cast<Vec3>(hold.outwards), middle - feature.place);
  if (feature.place == middle || inwards > 0.0) return hold;
  const bool is_corner = feature.radius == 0.0;
  if (is_corner && std::abs(hold.distance) < kLeftOfVoxel * field.voxel_size()) {
    return {hold.distance, {}};
  }
  return hold.distance >= 0.0 ? hold : hold_on_the_way_in(feature, middle, field, hold);
}

}  // namespace

std::optional<FeatureHold> hold_ball(const Feature& ball, const Vec3& middle, double margin,
                                     const GridField& field) {
  const double distance =
      static_cast<double>(field.distance(static_cast<Vec3f>(ball.place))) - ball.radius;
  const FeatureHold hold = turn_inwards(hold_nearest(ball, distance, field), ball, middle, field);
  if (!(hold.distance < margin) || hold.outwards == Vec3f{}) return std::nullopt;
  return hold;
}

void find_features(const PosedPair& pair, std::vector<Feature>& features) {
  features.clear();
  const Model* model = pair.shell_side().model();
  if (model == nullptr || pair.field_side().model() != nullptr) return;
  const Pose model_from_shape = pair.field_from_shell().inverse();
  const auto add = [&](const Vec3& place, double radius) {
    features.push_back({model_from_shape.transform_point(place), radius});
  };
  const auto add_ball = [&](const Vec3& center, double radius) {
    for (std::size_t i = 0; i < kBallIds; ++i) add(center, radius);
  };
  const auto add_circle = [&](double radius, double height) {
    add_rim(radius, height, model_from_shape, model->grid(), features);
  };
  std::visit(
      [&](const auto& field) {
        using T = std::decay_t<decltype(field)>;
        if constexpr (std::is_same_v<T, BoxField>) {
          const Vec3& h = field.half_extents;
          for (const double z : {-h.z, h.z}) {
            for (const double y : {-h.y, h.y}) {
              for (const double x : {-h.x, h.x}) add({x, y, z}, 0.0);
            }
          }
        } else if constexpr (std::is_same_v<T, SphereField>) {
          add_ball({}, field.radius);
        } else if constexpr (std::is_same_v<T, CapsuleField>) {
          for (const double side : {-0.5, 0.5}) add_ball({0, 0, side * field.length}, field.radius);
        } else if constexpr (std::is_same_v<T, CylinderField>) {
          for (const double side : {-0.5, 0.5}) add_circle(field.radius, side * field.length);
        } else if constexpr (std::is_same_v<T, ConeField>) {
          add_circle(field.radius, -0.5 * field.height);
          add({0, 0, 0.5 * field.height}, 0.0);
        } else if constexpr (std::is_same_v<T, ConvexField>) {
          for (const Vec3& corner : pair.field_side().hull()->corners()) add(corner, 0.0);
        }
      },
      pair.field());
}

void append_feature_contacts(const std::vector<Feature>& features, const PosedPair& pair,
                             double margin, std::vector<Contact>& contacts) {
  constexpr std::size_t kLanes = 8;
  const GridField& field = pair.shell_side().model()->grid();
  const Vec3 middle = pair.field_from_shell().inverse().transform_point(pair.field_side().middle());
  const std::size_t count = features.size();
  for (std::size_t first = 0; first < count; first += kLanes) {
    EightPoints places;
    for (std::size_t i = 0; i < kLanes; ++i) {
      places.set(i, static_cast<Vec3f>(features[std::min(first + i, count - 1)].place));
    }
    const EightFloats distances = field.distances(places);
    for (std::size_t i = first; i < std::min(first + kLanes, count); ++i) {
      const Feature& feature = features[i];
      const double distance = static_cast<double>(distances[i - first]);
      if (!(distance < margin)) continue;
      const FeatureHold nearest{distance,
                                normalized(field.gradient(static_cast<Vec3f>(feature.place)))};
      const FeatureHold hold = turn_inwards(nearest, feature, middle, field);
      if (!(hold.distance < margin) || hold.outwards == Vec3f{}) continue;
      contacts.push_back(contact_of(feature, kFirstFeature + static_cast<std::uint32_t>(i),
                                    hold.outwards, -hold.distance));
    }
  }
}

Contact contact_of(const Feature& feature, std::uint32_t id, const Vec3f& outwards, double depth) {
  const Vec3 on_model = feature.place + (depth - feature.radius) * static_cast<Vec3>(outwards);
  return {id, static_cast<float>(depth), static_cast<Vec3f>(on_model), -outwards};
}

}  // namespace voxshell::bullet
