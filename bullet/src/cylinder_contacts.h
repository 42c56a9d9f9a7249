#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "flat_elements.h"
#include "pair_step.h"
#include "posed_pair.h"
#include "shape_features.h"
#include "smooth_field.h"

namespace voxshell::bullet {

/// Contacts of the round side of a cylinder or capsule of Bullet's, its rims included, with a model
/// that has curved parts: where the two surfaces face each other, in place of the model's samples.
/// Decision 36.
class CylinderContacts {
 public:
  /// Replaces contacts of samples, and of the rims of cylinders, by those of the places that they
  /// lead to. These have ids as features have, which they keep from step to step. Nothing changes
  /// for other shapes and other models.
  ///
  /// @param features  Of find_features(); those of the new contacts are appended.
  /// @param reach     Contacts are deeper than minus that, meters.
  /// @param contacts  Ascending by id.
  /// @param exact     Ids, ascending, of those that are no samples.
  void slide(std::vector<Feature>& features, const PairStep& step, double reach,
             const TouchScale& scale, std::vector<Contact>& contacts,
             std::vector<std::uint32_t>& exact);

 private:
  /// Where the model faces the side, of those places that are as far along the axis.
  struct Section {
    double along;   ///< the axis, from its middle, meters
    Vec3 out;       ///< from the axis to the side, unit length
    Vec3 position;  ///< on the side
    Vec3 outwards;  ///< the model's normal, unit length
    double distance;
  };
  struct Touch {
    Section at;
    std::uint32_t number;  ///< of its id
    bool holds;            ///< it may touch within the step: others that lead to it need not
  };

  bool set_shape(const PosedPair& pair);
  void look_over();
  void look_over(double along, double aside);
  bool find_touch(const Section& start);
  Touch& add(const Section& section);
  Vec3 arm_of(const Contact& contact, const std::vector<Feature>& features) const;
  bool may_be_of_side(const Contact& contact, const std::vector<Feature>& features) const;
  bool leads(const Contact& contact, const std::vector<Feature>& features,
             std::span<const std::uint32_t> exact);
  Vec3 approach(double along, const Vec3& out) const;
  bool is_faced(double along, const Vec3& out) const;
  std::optional<Section> face(double along, const Vec3& out);
  Section go_down(const Section& start);
  std::optional<Section> find_level(Section above, Section beyond);
  Section level(const Section& section) const;
  /// How the distance grows along the axis.
  double slope_of(const Section& section) const { return dot(section.outwards, axis_); }
  static bool are_of_line(const Section& a, const Section& b);
  const Touch* find_known(const Section& section) const;
  bool is_behind(const Vec3& place, const Vec3& outwards, double along) const;
  bool is_over_line(double along, const Vec3& out, double distance) const;
  bool is_covered(const Section& section) const;
  void drop_touches_of_balls(std::span<const Contact> contacts);
  void number_touches(std::size_t first);

  const PairStep* step_ = nullptr;
  const Model* model_ = nullptr;
  SmoothField field_;
  Pose model_from_shape_;
  Vec3 middle_;                   ///< meters, the model's frame as all of these
  Vec3 axis_;                     ///< unit length
  double half_length_ = 0.0;      ///< meters
  double radius_ = 0.0;           ///< meters
  bool has_rims_ = false;         ///< not the balls of a capsule
  double reach_ = 0.0;            ///< meters
  double spacing_ = 0.0;          ///< of the model's samples, meters
  double tolerance_ = 0.0;        ///< of depths, meters
  double same_within_ = 0.0;      ///< meters
  double followed_within_ = 0.0;  ///< meters
  double least_curvature_ = 0.0;  ///< 1/meters
  std::vector<Touch> touches_;
  std::vector<Touch> before_;         ///< those of the step before
  std::vector<std::uint32_t> taken_;  ///< numbers
};

}  // namespace voxshell::bullet
