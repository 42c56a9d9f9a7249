#include "outer_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "contact_constants.h"
#include "flatness.h"

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

/// Lists kept from step to step, as settled ones take no memory.
class PatchHull {
 public:
  std::vector<Placed>& places() { return places_; }

  /// Marks the places that span all of them to a tolerance.
  void mark(double tolerance, std::vector<std::uint8_t>& is_outer) {
    find_hull();
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

}  // namespace

bool leave_outer(double tolerance, float band, std::vector<Contact>& contacts) {
  thread_local PatchHull hull;
  thread_local std::vector<std::uint8_t> patch_of;
  thread_local std::vector<std::uint8_t> is_outer;
  std::array<Vec3f, kMostPatches> normals;
  std::size_t count = 0;
  patch_of.clear();
  for (const Contact& contact : contacts) {
    const auto is_parallel = [&](const Vec3f& normal) {
      return squared_length(cross(normal, contact.normal)) <= kSamePatch * kSamePatch &&
             dot(normal, contact.normal) > 0.0f;
    };
    const auto end = normals.begin() + static_cast<std::ptrdiff_t>(count);
    const auto patch = std::find_if(normals.begin(), end, is_parallel);
    if (patch == end) {
      if (count == kMostPatches) return false;
      normals[count++] = contact.normal;
    }
    patch_of.push_back(static_cast<std::uint8_t>(patch - normals.begin()));
  }
  is_outer.assign(contacts.size(), 0);
  for (std::size_t patch = 0; patch < count; ++patch) {
    const auto tangents = tangents_of(static_cast<Vec3>(normals[patch]));
    std::vector<Placed>& places = hull.places();
    places.clear();
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      if (patch_of[i] != patch) continue;
      const auto point = static_cast<Vec3>(contacts[i].point);
      places.push_back(
          {dot(tangents[0], point), dot(tangents[1], point), static_cast<std::uint32_t>(i)});
    }
    hull.mark(tolerance, is_outer);
    float least = std::numeric_limits<float>::infinity();
    float deepest = -least;
    for (const Placed& place : places) {
      const float depth = contacts[place.index].depth;
      if (is_outer[place.index] != 0) least = std::min(least, depth);
      deepest = std::max(deepest, depth);
    }
    if (deepest > least + band) return false;
  }
  std::size_t left = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    contacts[left] = contacts[i];
    left += is_outer[i];
  }
  contacts.resize(left);
  return true;
}

}  // namespace voxshell::bullet
