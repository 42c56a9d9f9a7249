#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "posed_pair.h"

namespace voxshell::bullet {

/// A place of a convex shape that a model's field is asked about: a corner, a point of a rim, the
/// center of a ball. What the model's points are to the shape, these are to the model: without
/// them, shapes would lie between its points, unseen, and wholly inside it.
struct Feature {
  Vec3 place;     ///< model's frame
  double radius;  ///< of the ball about it, meters
};

/// A ball has as many features: it may touch several walls of one model.
inline constexpr std::size_t kBallIds = 14;

/// Where a model touches a feature, or holds it.
struct FeatureHold {
  double distance;  ///< of the feature from the model's surface, meters
  Vec3f outwards;   ///< the model's normal; zero where it has none
};

/// Contacts of features have ids from here on, in their order: no shell has so many points.
inline constexpr std::uint32_t kFirstFeature = UINT32_MAX - 0xffff;

/// Of the side that is the field, where it is a convex shape and the other a model; else none.
void find_features(const PosedPair& pair, std::vector<Feature>& features);

/// Where the model is nearest to a ball; none where that is farther than `margin`, meters. `middle`
/// is the shape's.
std::optional<FeatureHold> hold_ball(const Feature& ball, const Vec3& middle, double margin,
                                     const GridField& field);

/// Appends those that are inside the model or nearer to its surface than `margin`, meters: all but
/// balls.
void append_feature_contacts(const std::vector<Feature>& features, const PosedPair& pair,
                             double margin, std::vector<Contact>& contacts);

/// What a feature touches as a contact: `outwards` is the model's normal.
Contact contact_of(const Feature& feature, std::uint32_t id, const Vec3f& outwards, double depth);

}  // namespace voxshell::bullet
