#include "voxshell/bullet/seams.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include "conservative_advancement.h"
#include "contact_constants.h"
#include "motion.h"
#include "neighbor.h"
#include "of_this_thread.h"
#include "parting_planes.h"
#include "posed_pair.h"
#include "round_side.h"
#include "run_on_threads.h"
#include "seam_touch.h"
#include "seamless_bodies.h"
#include "shape_features.h"
#include "voxshell/bullet/convert.h"
#include "voxshell/bullet/parallel_dispatcher.h"
#include "wrap_object.h"

namespace voxshell::bullet {
namespace {

/// Bodies for each thread. Smaller: to start a thread takes longer than it saves.
constexpr std::size_t kBodiesOfThread = 8;

/// The place of a body's round surface that faces a direction, from a place of it on; none where it
/// is flat there, and of compounds.
std::optional<Vec3> facing_place(const btCollisionObject& body, const Vec3& place,
                                 const Vec3& direction) {
  const btCollisionShape& shape = *body.getCollisionShape();
  const CollisionMethod method = collision_method_of(shape);
  if (method != CollisionMethod::kModel && method != CollisionMethod::kField) return std::nullopt;
  const btCollisionObjectWrapper wrap = wrap_object(body);
  const Side side(wrap, nullptr);
  const Pose& world_from_own = side.world_from_geometry();
  const Pose own_from_world = world_from_own.inverse();
  const auto facing = find_facing(side, own_from_world.transform_point(place),
                                  own_from_world.rotate(direction), kFlatBend / radius_of(body));
  if (!facing) return std::nullopt;
  return world_from_own.transform_point(*facing);
}

Touch touch_of(const btManifoldPoint& point, bool is_first) {
  const Vec3 normal = from_bullet(point.m_normalWorldOnB);
  const auto gap = static_cast<double>(point.getDistance());
  const bool is_feature = static_cast<std::uint32_t>(point.m_index0) >= kFirstFeature;
  if (is_first) return {from_bullet(point.getPositionWorldOnA()), normal, gap, is_feature};
  return {from_bullet(point.getPositionWorldOnB()), -normal, gap, is_feature};
}

/// When the body of a speculative contact touches, seconds. It was found to touch with up to `step`
/// meters left, which with a slow approach are a long way.
double time_until(const Touch& touch, const Vec3& velocity, double approach, double step,
                  Neighbor& other) {
  const double earliest = std::max(touch.gap - step, 0.0) / approach;
  const double latest = touch.gap / approach;
  const Vec3 first = touch.on_body + earliest * velocity;
  const Vec3 way = (latest - earliest) * velocity;
  const auto reached = advance(length(way), 0.5 * step, 1.0, [&](double fraction) {
    const double gap = other.distance(first + fraction * way);
    return Clearance{gap, kSafeOfGap * gap};
  });
  return reached ? earliest + reached->fraction * (latest - earliest) : latest;
}

/// `velocity` is that of the touch's place as the other body sees it, m/s.
Arrival arrival_of(const Touch& touch, const Vec3& velocity, const Vec3& velocity_of_forces,
                   double radius, double time_step, Neighbor& other) {
  const Vec3 all = velocity + velocity_of_forces;
  const double approach = -dot(all, touch.normal);
  if (!(touch.gap > 0.0) || !(approach > 0.0)) return {!(touch.gap > 0.0), touch.on_other(), {}};
  const bool is_in_time = touch.gap <= approach * time_step;
  const Vec3 down = normalized(velocity_of_forces);
  const Vec3 fall = std::max(dot(all, down), 0.0) * down;
  // Speculative contacts have the place of the feature, or of the smaller body, as it is now
  // (speculative_contacts.cpp).
  if (touch.is_feature ? !other.is_model() : radius > other.radius()) {
    const double time = touch.gap / approach;
    return {is_in_time, touch.on_other() - time * fall, time * fall};
  }
  const double time = time_until(touch, all, approach, kSeamStep * radius, other);
  return {is_in_time, touch.on_body + time * (all - fall), time * fall};
}

/// The place of an arrival on the surface `beside`, if that is on the way down.
Vec3 supported_place(const Arrival& arrival, const Vec3& normal, double reach, Neighbor& beside) {
  const Vec3 down = normalized(arrival.fall);
  const Vec3 over = reach * (normal - dot(normal, down) * down);
  Vec3 place = arrival.place;
  double left = length(arrival.fall);
  for (int i = 0; i < kSeamDrops && left > 0.0; ++i) {
    const double drop = std::clamp(beside.distance(place + over), 0.0, left);
    place += drop * down;
    left -= drop;
  }
  return place;
}

bool leans(const Vec3& normal, const Vec3& upwards) {
  // Coarse fields have places without a gradient: nothing is known of a seam there.
  if (upwards == Vec3{}) return false;
  const double along = dot(normal, upwards);
  return along <= kSeamAligned && along >= -kSeamOpposed;
}

/// The surface of two bodies together. Both have fields.
class Union {
 public:
  Union(Neighbor& a, Neighbor& b) : a_(a), b_(b) {}

  double distance(const Vec3& place) const {
    const double of_a = a_.distance(place);
    return &a_ == &b_ ? of_a : std::min(of_a, b_.distance(place));
  }
  Vec3 outwards(const Vec3& place) const {
    const bool is_b_nearer = &a_ != &b_ && b_.distance(place) < a_.distance(place);
    return (is_b_nearer ? b_ : a_).nearest(place)->outwards(place);
  }

 private:
  Neighbor& a_;
  Neighbor& b_;
};

/// Whether a body lies on that side of its place, not behind a plane that it ends at.
bool lies_toward(const Vec3& direction, const Vec3& place, double reach, Neighbor& body) {
  if (!body.has_field()) return true;
  return body.distance(place + reach * direction) < body.distance(place - reach * direction);
}

/// A wall of the surface that a touch leans over.
struct Wall {
  Vec3 upwards;  ///< its normal
  Vec3 aside;    ///< along it, where the touch leans to
  Vec3 place;    ///< of the touch, or beside it where no other wall is near
};

/// The seam at a wall, if the touch is there, and the two bodies are flush.
std::optional<Seam> find_seam_of(const Wall& wall, const Touch& touch, const Vec3& place,
                                 double radius, const Union& both, Neighbor& body) {
  const double reach = kSeamReach * radius;
  const double step = kSeamStep * radius;
  const auto& [upwards, aside, beside] = wall;
  if (!leans(touch.normal, upwards)) return std::nullopt;
  const Vec3 over = beside + reach * aside;
  const double above = both.distance(over);
  if (above > step || above < -reach) return std::nullopt;
  // Over a face, not beside its edge.
  if (both.distance(over - (above + step) * upwards) > kSeamBeside * step) return std::nullopt;
  const Vec3 behind = beside - reach * aside + (step - above) * upwards;
  if (both.distance(behind) < 0.0) return std::nullopt;
  if (touch.gap <= step) {
    // Beside a corner, what stands out may end at that very place.
    if (dot(both.outwards(behind), upwards) < kSeamFlush) return std::nullopt;
    if (!lies_toward(upwards, touch.on_body, reach, body)) return std::nullopt;
  }
  const double gap = above + dot(touch.on_body - place, upwards);
  // Bodies that the neighbor keeps apart arrive behind it.
  if (gap < std::min(touch.gap, 0.0) - reach) return std::nullopt;
  return Seam{upwards, gap, dot(touch.normal, upwards) >= kTurnedCosine};
}

/// One of the two walls of a channel. Farther up the other one, it alone is near; and what leans
/// over it leans away from that other one, too. None where there is no channel, or the touch does
/// not lean over the neighbor.
std::optional<Wall> wall_of_channel(const Vec3& normal, const Vec3& upwards, const Vec3& of_other,
                                    const Vec3& place, double reach, const Union& both,
                                    Neighbor& other, Neighbor& beside) {
  const Vec3 up_the_other = leaning_over(of_other, upwards);
  const Vec3 leaning = leaning_over(normal, upwards);
  const Vec3 aside = leaning - dot(leaning, up_the_other) * up_the_other;
  if (length(aside) < kSeamWall) return std::nullopt;
  const Wall wall{upwards, normalized(aside), place + reach * up_the_other};
  // The wall is the neighbor's there, and the touched body's behind.
  const Vec3 above = wall.place + 0.5 * reach * upwards;
  const auto is_of = [&](Neighbor& body, const Vec3& at) {
    return body.distance(at) <= both.distance(at);
  };
  if (!is_of(beside, above + reach * wall.aside)) return std::nullopt;
  if (!is_of(other, above - reach * wall.aside)) return std::nullopt;
  return wall;
}

/// The seam of `other`, which the touch is with, and `beside`, if the touch of the body is there
/// and leans out of their plane.
std::optional<Seam> find_seam(const Touch& touch, const Arrival& arrival, double radius,
                              Neighbor& body, Neighbor& other, Neighbor& beside) {
  if (!other.has_field() || !beside.has_field()) return std::nullopt;
  const double reach = kSeamReach * radius;
  const Vec3 place = supported_place(arrival, touch.normal, reach, beside);
  if (beside.distance(place) > reach) return std::nullopt;
  const Union both(other, beside);
  Vec3 upwards = both.outwards(place + reach * touch.normal);
  if (!leans(touch.normal, upwards)) return std::nullopt;
  Vec3 aside;
  for (int i = 0; i < kSeamTurns; ++i) {
    aside = leaning_over(touch.normal, upwards);
    upwards = both.outwards(place + reach * (aside + upwards));
    if (!leans(touch.normal, upwards)) return std::nullopt;
  }
  const Vec3 of_other_wall =
      both.outwards(place + reach * (leaning_over(touch.normal, upwards) + upwards));
  const auto seam = find_seam_of({upwards, aside, place}, touch, place, radius, both, body);
  const bool is_channel = &beside != &other && length(cross(of_other_wall, upwards)) > kSeamWall;
  if (seam || !is_channel) return seam;
  for (const auto& [first, second] :
       {std::pair(upwards, of_other_wall), {of_other_wall, upwards}}) {
    const auto wall =
        wall_of_channel(touch.normal, first, second, place, reach, both, other, beside);
    if (!wall) continue;
    const auto of_wall = find_seam_of(*wall, touch, place, radius, both, body);
    if (of_wall) return of_wall;
  }
  return std::nullopt;
}

/// What is to become of a contact.
struct Correction {
  btPersistentManifold* manifold;
  int point;
  bool of_first;  ///< seen from the manifold's first body
  Seam seam;
};

void collect(btDispatcher& dispatcher, std::vector<Touching>& touching) {
  touching.clear();
  for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
    btPersistentManifold* const manifold = dispatcher.getManifoldByIndexInternal(i);
    const btCollisionObject* const first = manifold->getBody0();
    const btCollisionObject* const second = manifold->getBody1();
    if (manifold->getNumContacts() == 0 || !first->hasContactResponse() ||
        !second->hasContactResponse()) {
      continue;
    }
    if (!first->isStaticOrKinematicObject()) touching.push_back({first, second, manifold});
    if (!second->isStaticOrKinematicObject()) touching.push_back({second, first, manifold});
  }
  std::ranges::stable_sort(touching, {},
                           [](const Touching& each) { return each.body->getWorldArrayIndex(); });
}

/// Turns the contact into the seam's normal. Its place on the body that slides stays, or is that of
/// a round surface which faces the plane: another one turns away, and would brake what rolls.
void turn(btManifoldPoint& point, const Correction& correction) {
  auto [normal, gap, supports] = correction.seam;
  Vec3 on_body = touch_of(point, correction.of_first).on_body;
  const btPersistentManifold& manifold = *correction.manifold;
  const btCollisionObject& body =
      *(correction.of_first ? manifold.getBody0() : manifold.getBody1());
  const auto facing = facing_place(body, on_body, -normal);
  const double below = facing ? dot(on_body - *facing, normal) : 0.0;
  // Below the plane it is a place of something else.
  const double step =
      kSeamStep * std::min(radius_of(*manifold.getBody0()), radius_of(*manifold.getBody1()));
  if (facing && gap - below >= std::min(gap, 0.0) - step) {
    gap -= below;
    on_body = *facing;
    (correction.of_first ? point.m_positionWorldOnA : point.m_positionWorldOnB) =
        to_bullet(on_body);
  }
  // What does not touch the other body is not in it, nor is what touches deeper than it was found.
  gap = std::max(gap, std::min(static_cast<double>(point.getDistance()), 0.0));
  const btVector3 on_other = to_bullet(on_body - gap * normal);
  (correction.of_first ? point.m_positionWorldOnB : point.m_positionWorldOnA) = on_other;
  point.m_normalWorldOnB = to_bullet(correction.of_first ? normal : -normal);
  point.setDistance(static_cast<btScalar>(gap));
  btPlaneSpace1(point.m_normalWorldOnB, point.m_lateralFrictionDir1, point.m_lateralFrictionDir2);
}

void apply(std::vector<Correction>& corrections) {
  // From the last point of each manifold on: removing one moves the last to its place. Of two
  // corrections of one contact, that of the body that was added to the world first counts.
  const auto contact_of = [](const Correction& each) {
    return std::pair(each.manifold, each.point);
  };
  std::ranges::stable_sort(corrections, std::ranges::greater{}, contact_of);
  const auto is_of_one_contact = [&](const Correction& a, const Correction& b) {
    return contact_of(a) == contact_of(b);
  };
  corrections.erase(std::unique(corrections.begin(), corrections.end(), is_of_one_contact),
                    corrections.end());
  for (const Correction& correction : corrections) {
    btManifoldPoint& point = correction.manifold->getContactPoint(correction.point);
    if (correction.seam.supports) {
      turn(point, correction);
    } else {
      correction.manifold->removeContactPoint(correction.point);
    }
  }
}

/// Examines the contacts of one body after another.
class Examiner {
 public:
  /// Finds those of one body that are at seams: one of `seams` for each, in order. Returns whether
  /// there are any.
  bool find(std::span<const Touching> of_body, double time_step,
            std::span<std::optional<Seam>> seams);

 private:
  void find_planes(std::span<const Touching> of_body);
  std::optional<Seam> seam_of(Touch touch, Neighbor& body, const btCollisionObject& other,
                              double time_step);

  std::vector<Neighbor> neighbors_;
  std::vector<Plane> planes_;
};

bool Examiner::find(std::span<const Touching> of_body, double time_step,
                    std::span<std::optional<Seam>> seams) {
  const btCollisionObject& body = *of_body.front().body;
  neighbors_.clear();
  for (const Touching& each : of_body) {
    const bool is_known = std::ranges::any_of(
        neighbors_, [&](const Neighbor& known) { return &known.body() == each.other; });
    if (!is_known) neighbors_.emplace_back(*each.other, time_step);
  }
  Neighbor sliding(body, time_step);
  find_planes(of_body);
  bool has_seams = false;
  auto seam = seams.begin();
  for (const Touching& each : of_body) {
    const bool is_first = each.manifold->getBody0() == &body;
    for (int i = 0; i < each.manifold->getNumContacts(); ++i, ++seam) {
      const Touch touch = touch_of(each.manifold->getContactPoint(i), is_first);
      *seam = seam_of(touch, sliding, *each.other, time_step);
      has_seams = has_seams || seam->has_value();
    }
  }
  return has_seams;
}

/// The planes of what the body touches, those of most contacts first.
void Examiner::find_planes(std::span<const Touching> of_body) {
  planes_.clear();
  for (const Touching& each : of_body) {
    const bool is_first = each.manifold->getBody0() == each.body;
    const double step = kSeamStep * std::min(radius_of(*each.body), radius_of(*each.other));
    for (int i = 0; i < each.manifold->getNumContacts(); ++i) {
      add_plane(touch_of(each.manifold->getContactPoint(i), is_first), step, planes_);
    }
  }
  std::ranges::stable_sort(planes_, std::ranges::greater{}, &Plane::count);
}

/// The seam that a touch of the body with one of its neighbors_ is at.
std::optional<Seam> Examiner::seam_of(Touch touch, Neighbor& body, const btCollisionObject& other,
                                      double time_step) {
  const double radius = body.radius();
  const auto touched =
      std::ranges::find(neighbors_, &other, [](const Neighbor& n) { return &n.body(); });
  const Vec3 velocity =
      body.motion().velocity_at(touch.on_body) - touched->motion().velocity_at(touch.on_body);
  const Vec3 velocity_of_forces =
      body.motion().velocity_of_forces - touched->motion().velocity_of_forces;
  const Arrival arrival =
      arrival_of(touch, velocity, velocity_of_forces, radius, time_step, *touched);
  // Where four bodies meet, a contact may be at several seams. A contact with a corner may also
  // lean over the face of the very body that the corner is of.
  std::optional<Seam> found;
  const int rounds = neighbors_.size() > 1 ? kSeamRounds : 0;  // seams are of two bodies
  for (int round = 0; round < rounds; ++round) {
    for (Neighbor& beside : neighbors_) {
      const double least = std::min({radius, touched->radius(), beside.radius()});
      const double reach = 2.0 * kSeamReach * least + length(arrival.fall);
      if (!beside.may_be_near(arrival.place, reach) || beside.distance(arrival.place) > reach) {
        continue;
      }
      const auto seam = find_seam(touch, arrival, least, body, *touched, beside);
      if (!seam) continue;
      if (!seam->supports) return seam;
      // What leans a little over the touched face itself is a curved one's own normal.
      if (&beside == &*touched) continue;
      found = seam;
      touch = {touch.on_body, seam->normal, seam->gap, touch.is_feature};
    }
    if (!found) break;
  }
  if (found) return found;
  return find_parting(touch, arrival, planes_, std::min(radius, touched->radius()), body, *touched);
}

/// The touches of one body, and where those of its contacts are among all.
struct BodyTouches {
  std::span<const Touching> touching;
  std::size_t first;
  std::size_t count;
  SeamlessBody* kept;
};

}  // namespace

struct Seams::Scratch {
  std::vector<Touching> touching;
  std::vector<BodyTouches> bodies;
  std::vector<std::optional<Seam>> seams;  ///< of each contact of each body
  std::vector<Correction> corrections;
  SeamlessBodies seamless;

  void list_bodies();
  void list_corrections();
};

void Seams::Scratch::list_bodies() {
  bodies.clear();
  std::size_t contacts = 0;
  for (auto first = touching.begin(); first != touching.end();) {
    const auto last = std::find_if(first, touching.end(),
                                   [&](const Touching& each) { return each.body != first->body; });
    std::size_t count = 0;
    for (const Touching& each : std::span(first, last)) {
      count += static_cast<std::size_t>(each.manifold->getNumContacts());
    }
    bodies.push_back({{first, last}, contacts, count, &seamless.of(*first->body)});
    contacts += count;
    first = last;
  }
  seams.assign(contacts, std::nullopt);
}

void Seams::Scratch::list_corrections() {
  corrections.clear();
  auto seam = seams.begin();
  for (const Touching& each : touching) {
    const bool is_first = each.manifold->getBody0() == each.body;
    for (int i = 0; i < each.manifold->getNumContacts(); ++i, ++seam) {
      if (*seam) corrections.push_back({each.manifold, i, is_first, **seam});
    }
  }
}

Seams::Seams() : scratch_(std::make_unique<Scratch>()) {}

Seams::~Seams() = default;

void Seams::correct(btDispatcher& dispatcher, double time_step) {
  Scratch& scratch = *scratch_;
  collect(dispatcher, scratch.touching);
  scratch.seamless.begin();
  scratch.list_bodies();
  const auto examine = [&](const BodyTouches& of_body) {
    if (of_body.kept->hold(of_body.touching, time_step)) return;
    const auto seams = std::span(scratch.seams).subspan(of_body.first, of_body.count);
    of_body.kept->keep(of_this_thread<Examiner>().find(of_body.touching, time_step, seams));
  };
  const auto* const parallel = dynamic_cast<const ParallelDispatcher*>(&dispatcher);
  run_on_threads(scratch.bodies.size(), parallel != nullptr ? parallel->threads() : 1,
                 kBodiesOfThread, "seams", [&](std::size_t i) { examine(scratch.bodies[i]); });
  scratch.seamless.end();
  scratch.list_corrections();
  apply(scratch.corrections);
}

}  // namespace voxshell::bullet
