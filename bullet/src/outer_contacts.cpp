#include "outer_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "contact_constants.h"
#include "flatness.h"
#include "of_this_thread.h"

namespace voxshell::bullet {
namespace {

/// A contact in the plane of its patch.
struct Placed {
  double u;
  double v;
  std::uint32_t index;
};

/// Twice the area of a triangle, positive where `c` is to the left of the line from `a` to `b`.
double area_of(const Placed& a, const Placed& b, const Placed& c) {
  return (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
}

double squared_distance(const Placed& a, const Placed& b) {
  return (a.u - b.u) * (a.u - b.u) + (a.v - b.v) * (a.v - b.v);
}

/// The places of one patch, and those that span it.
class PatchHull {
 public:
  std::vector<Placed>& places() { return places_; }

  /// Whether no place is deeper than a plane through the depths of those that were marked by more
  /// than `band`.
  bool is_flat(std::span<const Contact> contacts, std::span<const std::uint8_t> is_outer,
               float band) const {
    const auto depth_of = [&](const Placed& place) {
      return static_cast<double>(contacts[place.index].depth);
    };
    Placed mean{};
    double mean_depth = 0.0;
    double count = 0.0;
    for (const Placed& place : places_) {
      if (is_outer[place.index] == 0) continue;
      mean.u += place.u;
      mean.v += place.v;
      mean_depth += depth_of(place);
      count += 1.0;
    }
    mean = {mean.u / count, mean.v / count, 0};
    mean_depth /= count;
    double uu = 0.0;
    double uv = 0.0;
    double vv = 0.0;
    double ud = 0.0;
    double vd = 0.0;
    for (const Placed& place : places_) {
      if (is_outer[place.index] == 0) continue;
      const double u = place.u - mean.u;
      const double v = place.v - mean.v;
      const double d = depth_of(place) - mean_depth;
      uu += u * u;
      uv += u * v;
      vv += v * v;
      ud += u * d;
      vd += v * d;
    }
    // Places in a row tell nothing of the slope across it.
    const double least = 1e-6 * (uu + vv);
    uu += least;
    vv += least;
    const double determinant = uu * vv - uv * uv;
    const double slope_u = determinant > 0.0 ? (vv * ud - uv * vd) / determinant : 0.0;
    const double slope_v = determinant > 0.0 ? (uu * vd - uv * ud) / determinant : 0.0;
    return std::ranges::all_of(places_, [&](const Placed& place) {
      const double plane = mean_depth + slope_u * (place.u - mean.u) + slope_v * (place.v - mean.v);
      return is_outer[place.index] != 0 || depth_of(place) <= plane + static_cast<double>(band);
    });
  }

  /// Marks the places that span all of them to a fraction of their width, or to `least`, meters.
  void mark(double least, std::vector<std::uint8_t>& is_outer) {
    find_hull();
    const double tolerance = std::max(kPatchShrink * half_width(), least);
    const std::size_t count = hull_.size();
    for (std::size_t i = 0; i < count; ++i) hull_.push_back(hull_[i]);
    // From one corner to the one farthest from it, and back: never to the middle of a side, which
    // would be another place in each step.
    const std::size_t first = find_farthest(middle(), 0, count);
    const std::size_t other = find_farthest(hull_[first], first, first + count);
    mark_between(first, other, tolerance, is_outer);
    mark_between(other, first + count, tolerance, is_outer);
  }

 private:
  /// Andrew's monotone chain, counterclockwise.
  void find_hull() {
    std::ranges::sort(places_, [](const Placed& a, const Placed& b) {
      return a.u != b.u ? a.u < b.u : a.v != b.v ? a.v < b.v : a.index < b.index;
    });
    hull_.clear();
    const auto append = [&](const Placed& place, std::size_t fixed) {
      while (hull_.size() > fixed + 1 &&
             area_of(hull_[hull_.size() - 2], hull_.back(), place) <= 0.0) {
        hull_.pop_back();
      }
      hull_.push_back(place);
    };
    for (const Placed& place : places_) append(place, 0);
    const std::size_t lower = hull_.size() - 1;
    for (std::size_t i = places_.size(); i-- > 0;) append(places_[i], lower);
    if (hull_.size() > 1) hull_.pop_back();
  }

  /// Of long hulls half their width, of round ones their radius.
  double half_width() const {
    double area = 0.0;  // twice
    double perimeter = 0.0;
    for (std::size_t i = 0; i < hull_.size(); ++i) {
      const Placed& next = hull_[(i + 1) % hull_.size()];
      area += area_of(hull_.front(), hull_[i], next);
      perimeter += std::sqrt(squared_distance(hull_[i], next));
    }
    return perimeter > 0.0 ? area / perimeter : 0.0;
  }

  Placed middle() const {
    Placed sum{};
    for (const Placed& place : places_) {
      sum.u += place.u;
      sum.v += place.v;
    }
    const auto count = static_cast<double>(places_.size());
    return {sum.u / count, sum.v / count, 0};
  }

  std::size_t find_farthest(const Placed& from, std::size_t begin, std::size_t end) const {
    std::size_t farthest = begin;
    double most = -1.0;
    for (std::size_t i = begin; i < end; ++i) {
      const double squared = squared_distance(hull_[i], from);
      if (squared <= most) continue;
      most = squared;
      farthest = i;
    }
    return farthest;
  }

  /// Marks both ends and what is farther than the tolerance from the line between marked ones.
  void mark_between(std::size_t begin, std::size_t end, double tolerance,
                    std::vector<std::uint8_t>& is_outer) {
    lines_.assign(1, {begin, end});
    while (!lines_.empty()) {
      const auto [from, to] = lines_.back();
      lines_.pop_back();
      is_outer[hull_[from].index] = 1;
      is_outer[hull_[to].index] = 1;
      const double length = std::sqrt(squared_distance(hull_[from], hull_[to]));
      std::size_t farthest = from;
      double most = tolerance * length;
      for (std::size_t i = from + 1; i < to; ++i) {
        const double area = -area_of(hull_[from], hull_[to], hull_[i]);
        if (!(area > most)) continue;
        most = area;
        farthest = i;
      }
      if (farthest == from) continue;
      lines_.push_back({from, farthest});
      lines_.push_back({farthest, to});
    }
  }

  struct Line {
    std::size_t from;
    std::size_t to;
  };

  std::vector<Placed> places_;
  std::vector<Placed> hull_;  ///< twice in a row
  std::vector<Line> lines_;
};

/// Contacts whose normals are the same.
struct Patch {
  Vec3f normal;
  std::size_t count = 0;
};

/// The patches of a list of contacts.
class Patches {
 public:
  /// False if there are too many.
  bool find(std::span<const Contact> contacts) {
    count_ = 0;
    patch_of_.clear();
    for (const Contact& contact : contacts) {
      std::size_t patch = 0;
      while (patch < count_ && !is_same(patches_[patch].normal, contact.normal)) ++patch;
      if (patch == count_) {
        if (count_ == kMostPatches) return false;
        patches_[count_++] = {contact.normal, 0};
      }
      ++patches_[patch].count;
      patch_of_.push_back(static_cast<std::uint8_t>(patch));
    }
    for (std::size_t patch = 0; patch < count_; ++patch) patch_of_patch_[patch] = owner_of(patch);
    return true;
  }

  std::size_t count() const { return count_; }
  std::size_t of(std::size_t contact) const { return patch_of_patch_[patch_of_[contact]]; }
  const Vec3f& normal(std::size_t patch) const { return patches_[patch].normal; }

 private:
  static bool is_same(const Vec3f& a, const Vec3f& b) {
    return squared_length(cross(a, b)) <= kSamePatch * kSamePatch && dot(a, b) > 0.0f;
  }
  /// Some places on the rim of a patch have slanted normals: those of the edge that they are on.
  std::size_t owner_of(std::size_t patch) const {
    for (std::size_t other = 0; other < count_; ++other) {
      const bool is_rim = kRimOfPatch * patches_[patch].count <= patches_[other].count;
      if (is_rim && -dot(patches_[patch].normal, patches_[other].normal) <= kFacingCosine) {
        return other;
      }
    }
    return patch;
  }

  std::array<Patch, kMostPatches> patches_;
  std::array<std::size_t, kMostPatches> patch_of_patch_{};
  std::size_t count_ = 0;
  std::vector<std::uint8_t> patch_of_;  ///< of each contact
};

/// Kept from step to step, as settled ones take no memory.
struct Lists {
  Patches patches;
  PatchHull hull;
  std::vector<std::uint8_t> is_outer;
};

}  // namespace

bool leave_outer(double least, float band, std::vector<Contact>& contacts) {
  auto& [patches, hull, is_outer] = of_this_thread<Lists>();
  if (!patches.find(contacts)) return false;
  is_outer.assign(contacts.size(), 0);
  for (std::size_t patch = 0; patch < patches.count(); ++patch) {
    const auto tangents = tangents_of(static_cast<Vec3>(patches.normal(patch)));
    std::vector<Placed>& places = hull.places();
    places.clear();
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      if (patches.of(i) != patch) continue;
      const auto point = static_cast<Vec3>(contacts[i].point);
      places.push_back(
          {dot(tangents[0], point), dot(tangents[1], point), static_cast<std::uint32_t>(i)});
    }
    if (places.empty()) continue;
    hull.mark(least, is_outer);
    if (!hull.is_flat(contacts, is_outer, band)) return false;
  }
  std::size_t left = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    contacts[left] = contacts[i];
    contacts[left].normal = patches.normal(patches.of(i));
    left += is_outer[i];
  }
  contacts.resize(left);
  return true;
}

}  // namespace voxshell::bullet
