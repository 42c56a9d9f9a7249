#pragma once

#include <cmath>

namespace voxshell {

/// Three coordinates. Meters for points, no unit for directions.
template <class T>
struct Vector3 {
  T x{};
  T y{};
  T z{};

  friend constexpr bool operator==(const Vector3&, const Vector3&) = default;

  template <class U>
  explicit constexpr operator Vector3<U>() const {
    return {static_cast<U>(x), static_cast<U>(y), static_cast<U>(z)};
  }

  constexpr T operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  constexpr T& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }

  constexpr Vector3& operator+=(const Vector3& v) { return *this = *this + v; }

  friend constexpr Vector3 operator+(const Vector3& a, const Vector3& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend constexpr Vector3 operator-(const Vector3& a, const Vector3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend constexpr Vector3 operator-(const Vector3& a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr Vector3 operator*(const Vector3& a, T s) { return {a.x * s, a.y * s, a.z * s}; }
  friend constexpr Vector3 operator*(T s, const Vector3& a) { return a * s; }
  friend constexpr Vector3 operator/(const Vector3& a, T s) { return {a.x / s, a.y / s, a.z / s}; }
};

using Vec3 = Vector3<double>;
using Vec3f = Vector3<float>;

template <class T>
constexpr T dot(const Vector3<T>& a, const Vector3<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class T>
constexpr Vector3<T> cross(const Vector3<T>& a, const Vector3<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class T>
constexpr T squared_length(const Vector3<T>& a) {
  return dot(a, a);
}

template <class T>
T length(const Vector3<T>& a) {
  return std::sqrt(squared_length(a));
}

/// Unit vector along `a`; the zero vector where `a` is zero.
template <class T>
Vector3<T> normalized(const Vector3<T>& a) {
  const T l = length(a);
  return l > T(0) ? a / l : Vector3<T>{};
}

template <class T>
bool is_finite(const Vector3<T>& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

}  // namespace voxshell
