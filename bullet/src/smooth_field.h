#pragma once

#include <cstdint>
#include <optional>

#include "round_side.h"
#include "voxshell/model.h"

namespace voxshell::bullet {

/// A body as round bodies feel it that slide over it: its field, and beside the round parts of a
/// model that of the smooth surface that its mesh stands for, which has no facets. The geometry's
/// frame.
class SmoothField {
 public:
  /// Of nothing, to be assigned.
  SmoothField() = default;
  /// The side outlives this, and so does the field.
  explicit SmoothField(const Side& side);
  /// The field alone, without a smooth surface.
  explicit SmoothField(const Field& field) : field_(&field) {}

  /// Whether some of it is a smooth surface.
  bool is_smooth() const { return round_.has_value(); }

  /// By how much the field and the smooth surface may be off each other, meters.
  double off_field() const { return walk_within_; }

  /// Radians by which normals may miss each other where a round surface faces it.
  double faces_within() const;

  /// Of the smooth surface, a triangle near the first place that will be asked about, which makes
  /// the search for that short.
  void start_from(std::uint32_t triangle);

  /// The same near the last place that another one of the same geometry was asked about.
  void start_near(const SmoothField& other) { before_ = other.before_; }

  struct Value {
    double distance;  ///< meters
    Vec3 outwards;    ///< unit length; zero where coarse fields have none
  };
  /// At places near the surface. Fast where the place before was near.
  Value at(const Vec3& place);

  /// The place of the smooth surface that is nearest to one; none where it is flat, or where the
  /// field has none. Fast where the place before was near.
  std::optional<RoundSide::Place> nearest(const Vec3& place);

 private:
  Value value_at(const Vec3& place, const RoundSide::Place& nearest, const Value& of_field) const;
  std::optional<Value> walk_from(const RoundSide& round, const RoundSide::Place& start,
                                 const Vec3& place, const Value& of_field);

  const Field* field_ = nullptr;
  std::optional<RoundSide> round_;  ///< of models, whose fields alone have facets
  double tolerance_ = 0.0;          ///< of the model, meters
  double walk_within_ = 0.0;        ///< of the field's distance, that of the smooth surface, meters
  double deepest_ = 0.0;            ///< so far inside it is smooth, meters
  std::optional<RoundSide::Place> before_;
};

}  // namespace voxshell::bullet
