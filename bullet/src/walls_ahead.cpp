#include "walls_ahead.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "contact_constants.h"
#include "impact.h"

namespace voxshell::bullet {
namespace {

/// A wall that a place meets on a straight way.
struct Wall {
  Vec3 outwards;  ///< unit length
  double gap;     ///< of the place at the start of the way from the wall's plane, meters
};

/// The first wall on the way of a place that leans by more than 45 degrees against what the place
/// touches.
///
/// @param outwards  The normal of what it touches.
/// @param hop       Walls are looked for in places as far apart, meters, at least.
std::optional<Wall> find_wall(const GridField& grid, const Vec3& place, const Vec3& displacement,
                              const Vec3& outwards, double hop) {
  const double way = length(displacement);
  const auto distance_at = [&](double fraction) {
    return static_cast<double>(grid.distance(static_cast<Vec3f>(place + fraction * displacement)));
  };
  const auto look = [&](double fraction) -> std::optional<Vec3> {
    if (distance_at(fraction) > 0.0) return std::nullopt;
    const auto place_then = static_cast<Vec3f>(place + fraction * displacement);
    const auto normal = static_cast<Vec3>(normalized(grid.gradient(place_then)));
    if (dot(normal, outwards) > kTurnedCosine || !(dot(normal, displacement) < 0.0)) {
      return std::nullopt;
    }
    return normal;
  };
  for (double before = 0.0; before < 1.0;) {
    double after = std::min(before + std::max(kSafeOfGap * distance_at(before), hop) / way, 1.0);
    const double behind = after;
    const auto there = look(after);
    if (!there) {
      before = after;
      continue;
    }
    for (int i = 0; i < kMeetSteps; ++i) {
      const double between = 0.5 * (before + after);
      (look(between) ? after : before) = between;
    }
    // Where it begins to be nearer than others, the grid blends their normals.
    const Vec3 normal = look(std::min(after + kBehindMeeting * hop / way, behind)).value_or(*there);
    return Wall{normal, -after * dot(displacement, normal)};
  }
  return std::nullopt;
}

}  // namespace

void append_walls_ahead(const PairStep& step, std::vector<Feature>& features,
                        std::vector<Contact>& contacts) {
  const PosedPair& pair = *step.pair;
  const GridField& grid = pair.shell_side().model()->grid();
  const Vec3 middle = pair.field_from_shell().inverse().transform_point(pair.field_side().middle());
  const std::size_t feature_count = features.size();
  const std::size_t contact_count = contacts.size();
  features.resize(2 * feature_count, {Vec3{}, 0.0});
  for (std::size_t i = 0; i < contact_count; ++i) {
    const Contact contact = contacts[i];
    if (contact.id < kFirstFeature || !is_contact(step, impact_of(step, contact))) continue;
    const std::size_t number = contact.id - kFirstFeature;
    const Vec3& place = features[number].place;
    const Vec3 outwards = -static_cast<Vec3>(contact.normal);
    const double lift = kLiftOfMiddle * dot(middle - place, outwards);
    if (!(lift > 0.0)) continue;
    Vec3 displacement = -step.time_step * step.motion.velocity_at(place);
    displacement = displacement - dot(displacement, outwards) * outwards;
    const double hop =
        std::max(kBallHop * pair.shell_side().thinnest(), length(displacement) / kMostBallHops);
    if (!(length(displacement) > lift)) continue;
    const auto wall = find_wall(grid, place + lift * outwards, displacement, outwards, hop);
    if (!wall) continue;
    // As far from the wall as the corner.
    const Vec3 up = outwards - dot(outwards, wall->outwards) * wall->outwards;
    const double gap = wall->gap - lift * dot(outwards, wall->outwards);
    features[feature_count + number] = {place + lift * up, 0.0};
    const auto id = kFirstFeature + static_cast<std::uint32_t>(feature_count + number);
    contacts.push_back(
        contact_of(features[feature_count + number], id, static_cast<Vec3f>(wall->outwards), -gap));
  }
  std::ranges::sort(contacts, {}, &Contact::id);
}

}  // namespace voxshell::bullet
