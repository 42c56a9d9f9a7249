#include "facing_normals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <variant>

#include "contact_constants.h"
#include "contact_list.h"

namespace voxshell::bullet {
namespace {

/// The distances of the first `count` places.
template <class F>
EightFloats measure(const F& field, const std::array<Vec3f, 8>& places, std::size_t count) {
  EightFloats distances{};
  if constexpr (std::is_same_v<F, GridField>) {
    EightPoints points;
    for (std::size_t i = 0; i < places.size(); ++i) points.set(i, places[i < count ? i : 0]);
    return field.distances(points);
  } else {
    for (std::size_t i = 0; i < count; ++i) distances[i] = field.distance(places[i]);
  }
  return distances;
}

/// What face_elements() does in a field of one type, eight contacts at a time.
template <class F>
class Facing {
 public:
  Facing(const F& field, const PointShell& shell, const Pose& field_from_shell, double reach,
         double thickness)
      : field_(field),
        shell_(shell),
        field_from_shell_(field_from_shell),
        shell_from_field_(field_from_shell.inverse()),
        reach_(reach),
        thickness_(thickness) {}

  void add(Contact& contact) {
    if (dot(shell_.normal_of(contact.id), contact.normal) <= kFacingCosine) return;
    places_[count_] = inside(contact, reach_);
    contacts_[count_++] = &contact;
    if (count_ == contacts_.size()) finish();
  }

  void finish() {
    if (count_ == 0) return;
    const EightFloats distances = measure(field_, places_, count_);
    for (std::size_t i = 0; i < count_; ++i) face(*contacts_[i], places_[i], distances[i]);
    count_ = 0;
  }

 private:
  Vec3f inside(const Contact& contact, double inwards) const {
    const auto facing = static_cast<Vec3>(shell_.normal_of(contact.id));
    return static_cast<Vec3f>(
        field_from_shell_.transform_point(static_cast<Vec3>(contact.point) - inwards * facing));
  }

  /// @param place     What is inside by the reach.
  /// @param measured  Its distance.
  void face(Contact& contact, Vec3f place, float measured) const {
    double inwards = reach_;
    auto distance = static_cast<double>(measured);
    for (int doubled = 0; !(distance > thickness_); ++doubled) {
      if (doubled == kFacingDoublings) return;
      inwards *= 2.0;
      place = inside(contact, inwards);
      distance = static_cast<double>(field_.distance(place));
    }
    const auto facing = static_cast<Vec3>(shell_.normal_of(contact.id));
    const Vec3 slope = shell_from_field_.rotate(static_cast<Vec3>(field_.gradient(place)));
    const double rise = -dot(facing, slope);
    if (!(rise > 0.0)) return;
    // The field is taken to be linear from there on.
    contact.depth = static_cast<float>(rise * inwards - distance);
    contact.normal = static_cast<Vec3f>(normalized(slope));
  }

  const F& field_;
  const PointShell& shell_;
  const Pose& field_from_shell_;
  Pose shell_from_field_;
  double reach_;
  double thickness_;
  std::array<Contact*, 8> contacts_{};
  std::array<Vec3f, 8> places_{};
  std::size_t count_ = 0;
};

}  // namespace

void face_elements(std::span<Contact> contacts, const Field& field, const PointShell& shell,
                   const Pose& field_from_shell, double reach, double thickness) {
  if (!(reach > 0.0) || shell.edges() == nullptr) return;
  std::visit(
      [&](const auto& typed) {
        Facing facing(typed, shell, field_from_shell, reach, thickness);
        for (Contact& contact : contacts) {
          const double gap = -static_cast<double>(contact.depth) - thickness;
          if (gap <= kFacingOutside * reach && gap >= -kFacingInside * reach) facing.add(contact);
        }
        facing.finish();
      },
      field);
}

void drop_from_behind(std::vector<Contact>& contacts, const PointShell& shell, float reach,
                      float deep, Opposition& opposition) {
  float buried = opposition.buried;
  bool is_opposed = opposition.is_opposed;
  keep_if(contacts, [&](const Contact& contact) {
    const float cosine = dot(shell.normal_of(contact.id), contact.normal);
    const float most = contact.depth > deep ? -kAside : kAside;
    const bool is_near = contact.depth > -reach;
    const bool is_dropped = is_near & (cosine > most);
    buried = is_dropped ? std::max(buried, contact.depth) : buried;
    is_opposed |= is_near & (cosine <= -kAside);
    return !is_dropped;
  });
  opposition = {buried, is_opposed};
}

}  // namespace voxshell::bullet
