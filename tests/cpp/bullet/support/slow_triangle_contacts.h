#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

#include <BulletCollision/CollisionShapes/btConcaveShape.h>

#include "triangle_contacts.h"
#include "voxshell/bullet/convert.h"

namespace voxshell::bullet::test_support {

/// TriangleContacts written down plainly: one place after another, by recursion, with all samples
/// in a list. The same bits.
class SlowTriangleContacts : private btTriangleCallback {
 public:
  std::vector<Contact> find(const btConcaveShape& mesh, const Model& model,
                            const Pose& model_from_mesh, int level, float margin) {
    model_ = &model;
    model_from_mesh_ = model_from_mesh;
    margin_ = margin;
    const Vec3 size = model.bounds().extents();
    const double longest = std::max({size.x, size.y, size.z});
    cell_size_ = longest / std::min(1 << (level - 1), 16);
    mesh.processAllTriangles(this, btVector3(-100, -100, -100), btVector3(100, 100, 100));

    const Pose mesh_from_model = model_from_mesh.inverse();
    std::vector<Contact> contacts;
    for (auto& [cell, samples] : samples_) {
      std::stable_sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) {
        return std::tie(a.distance, a.triangle) < std::tie(b.distance, b.triangle);
      });
      Place best = refine(samples[0]);
      if (samples.size() > 1 && !(samples[1].bound > best.distance)) {
        const Place other = refine(samples[1]);
        if (other.distance < best.distance) best = other;
      }
      if (!(best.distance < margin)) continue;
      const Vec3f normal = normal_at(best);
      contacts.push_back(
          {cell, -best.distance,
           static_cast<Vec3f>(mesh_from_model.transform_point(static_cast<Vec3>(best.point))),
           static_cast<Vec3f>(mesh_from_model.rotate(static_cast<Vec3>(normal)))});
    }
    return contacts;
  }

  std::size_t sample_count = 0;

 private:
  struct Sample {
    float distance;
    float bound;
    std::size_t triangle;
    Triangle3f around;
  };
  struct Place {
    Vec3f point;
    float distance;
    std::size_t triangle;
  };

  static Vec3f middle(const Triangle3f& t) { return (1.0f / 3.0f) * (t.a + t.b + t.c); }
  static std::array<Triangle3f, 4> quarters(const Triangle3f& t) {
    const Vec3f ab = 0.5f * (t.a + t.b);
    const Vec3f bc = 0.5f * (t.b + t.c);
    const Vec3f ca = 0.5f * (t.c + t.a);
    return {{{ab, bc, ca}, {t.a, ab, ca}, {ab, t.b, bc}, {ca, bc, t.c}}};
  }

  void processTriangle(btVector3* corners, int, int) override {
    const Bounds& bounds = model_->bounds();
    const double reach = static_cast<double>(margin_) + model_->grid().interpolation_error();
    std::array<Vec3, 3> p;
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = model_from_mesh_.transform_point(from_bullet(corners[k]));
    }
    for (int axis = 0; axis < 3; ++axis) {
      const auto [least, most] = std::minmax({p[0][axis], p[1][axis], p[2][axis]});
      if (least > bounds.upper[axis] + reach || most < bounds.lower[axis] - reach) return;
    }
    triangles_.push_back(
        {static_cast<Vec3f>(p[0]), static_cast<Vec3f>(p[1]), static_cast<Vec3f>(p[2])});
    sample(triangles_.back(), 64);
  }

  void sample(const Triangle3f& t, int splits) {
    const GridField& field = model_->grid();
    const Vec3f center = middle(t);
    const float radius =
        std::sqrt(std::max({squared_length(t.a - center), squared_length(t.b - center),
                            squared_length(t.c - center)}));
    const float bound = field.lower_bound(center, radius);
    if (!(bound <= margin_)) return;
    const std::array<float, 3> edges{squared_length(t.b - t.a), squared_length(t.c - t.b),
                                     squared_length(t.a - t.c)};
    const auto longest = std::max_element(edges.begin(), edges.end());
    const float spacing = std::max(TriangleContacts::sample_spacing(*model_), 0.5f * bound);
    if (*longest <= spacing * spacing || splits == 0) return keep(t, center, bound);
    if (*longest < 4.0f * *std::min_element(edges.begin(), edges.end())) {
      for (const Triangle3f& part : quarters(t)) sample(part, splits - 1);
      return;
    }
    const std::array<Vec3f, 3> corners{t.a, t.b, t.c};
    const auto first = static_cast<std::size_t>(longest - edges.begin());
    const Vec3f& from = corners[first];
    const Vec3f& to = corners[(first + 1) % 3];
    const Vec3f& opposite = corners[(first + 2) % 3];
    const Vec3f halfway = 0.5f * (from + to);
    sample({from, halfway, opposite}, splits - 1);
    sample({halfway, to, opposite}, splits - 1);
  }

  void keep(const Triangle3f& t, const Vec3f& center, float bound) {
    ++sample_count;
    const std::uint32_t cell = cell_of(center);
    float& least = least_.try_emplace(cell, margin_).first->second;
    if (bound > least) return;
    const float distance = model_->grid().distance(center);
    least = std::min(least, distance);
    samples_[cell].push_back({distance, bound, triangles_.size() - 1, t});
  }

  Place refine(const Sample& sample) const {
    Triangle3f t = sample.around;
    Place best{middle(t), sample.distance, sample.triangle};
    const auto look_at = [&](const Vec3f& p) {
      const float distance = model_->grid().distance(p);
      if (distance < best.distance) best = {p, distance, sample.triangle};
      return distance;
    };
    for (int i = 0; i < 5; ++i) {
      const std::array<Triangle3f, 4> parts = quarters(t);
      float lowest = 0.0f;
      for (std::size_t k = 0; k < parts.size(); ++k) {
        const float distance = look_at(middle(parts[k]));
        if (k > 0 && !(distance < lowest)) continue;
        lowest = distance;
        t = parts[k];
      }
    }
    for (const Vec3f& corner : {t.a, t.b, t.c}) look_at(corner);
    return best;
  }

  /// The triangle's where the place is well within it and the field agrees, else the field's.
  Vec3f normal_at(const Place& place) const {
    const Triangle3f& t = triangles_[place.triangle];
    const Vec3f gradient = normalized(model_->grid().gradient(place.point));
    const Vec3f area = cross(t.b - t.a, t.c - t.a);
    const float twice_area = length(area);
    if (!(twice_area > 0.0f)) return gradient;
    const Vec3f normal = area / twice_area;
    for (const auto& [from, to] : {std::pair{t.a, t.b}, std::pair{t.b, t.c}, std::pair{t.c, t.a}}) {
      if (!(dot(cross(to - from, place.point - from), normal) > 1e-4f * twice_area))
        return gradient;
    }
    const float agreement = dot(normal, gradient);
    if (std::abs(agreement) < 0.5f) return gradient;
    return agreement > 0.0f ? normal : -normal;
  }

  std::uint32_t cell_of(const Vec3f& p) const {
    const Bounds& bounds = model_->bounds();
    const Vec3 size = bounds.extents();
    std::uint32_t cell = 0;
    for (int axis = 2; axis >= 0; --axis) {
      const auto count =
          static_cast<std::uint32_t>(std::max(1.0, std::ceil(size[axis] / cell_size_ - 1e-9)));
      const double place = (static_cast<double>(p[axis]) - bounds.lower[axis]) / cell_size_;
      cell = cell * count +
             static_cast<std::uint32_t>(std::clamp(place, 0.0, static_cast<double>(count - 1)));
    }
    return cell;
  }

  const Model* model_ = nullptr;
  Pose model_from_mesh_;
  float margin_ = 0.0f;
  double cell_size_ = 0.0;
  std::vector<Triangle3f> triangles_;
  std::map<std::uint32_t, float> least_;
  std::map<std::uint32_t, std::vector<Sample>> samples_;
};

}  // namespace voxshell::bullet::test_support
