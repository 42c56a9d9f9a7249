#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "face_field.h"
#include "flat_elements.h"
#include "pair_step.h"
#include "posed_pair.h"
#include "shape_features.h"
#include "smooth_field.h"

namespace voxshell::bullet {

/// Contacts of a ball of Bullet's, or of those that end a capsule, with a model: where the model's
/// surface faces them. A ball may lie in a groove, and touches each wall of it.
class BallContacts {
 public:
  /// Appends those that are deeper than -`margin`, meters.
  ///
  /// @param features  Of find_features(); that of each contact is made what is to be followed: the
  /// ball where it is nearest to the model, and places of it elsewhere.
  /// @param step      Null in contact tests, whose scale has a margin of 0.
  /// @param scale     By which contacts are one; with a margin of 0, only the nearest is appended
  /// where there is one.
  /// @param exact     To which the ids of those are added that face the model's surface.
  void append(std::vector<Feature>& features, const PosedPair& pair, const PairStep* step,
              double margin, const TouchScale& scale, std::vector<Contact>& contacts,
              std::vector<std::uint32_t>& exact);

  /// Drops the contacts of the model's shell from which a ball's surface leads to one of the
  /// contacts of the last append(), and those of these that are of an edge of the shell. Ids of
  /// `exact` are sorted.
  void drop_covered(std::vector<Contact>& contacts, const PointShell& shell,
                    const std::vector<std::uint32_t>& exact);

 private:
  struct Ball {
    Vec3 center;    ///< meters, the model's frame
    double radius;  ///< meters
    Vec3 out;       ///< out of a capsule, unit length; zero of a whole ball
  };

  /// Whether the ball's surface is its shape's there.
  static bool is_outside(const Ball& ball, const Vec3& direction);
  std::optional<Facing> face(const Ball& ball, const Vec3& direction);
  bool is_known(std::size_t first, const Vec3& position) const;
  void find_all(const Ball& ball, std::size_t first, double margin);
  std::optional<Facing> meet(const Ball& ball, std::size_t first, Vec3& so_far,
                             Vec3& displacement) const;
  void find_on_the_way(const Ball& ball, std::size_t first, const PairStep& step);

  SmoothField field_;
  const GridField* grid_ = nullptr;  ///< the model's
  double same_within_ = 0.0;         ///< meters
  double followed_within_ = 0.0;     ///< meters
  std::vector<Ball> balls_;
  std::vector<Facing> touches_;
  std::vector<Vec3> edges_;  ///< places of contacts
};

}  // namespace voxshell::bullet
