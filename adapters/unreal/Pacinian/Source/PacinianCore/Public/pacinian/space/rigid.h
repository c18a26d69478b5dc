#pragma once

#include "pacinian/space/vec3.h"

namespace pacinian {

/// A unit quaternion x, y, z, w: a rotation.
struct Quat {
  double x = 0.0, y = 0.0, z = 0.0, w = 1.0;
};

/// Returns the rotation b followed by a.
constexpr Quat operator*(Quat a, Quat b) {
  return {a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
          a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
          a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
          a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}

/// Returns the inverse rotation.
constexpr Quat inverse(Quat a) { return {-a.x, -a.y, -a.z, a.w}; }

/// Returns the rotated vector.
constexpr Vec3 turn(Quat a, Vec3 v) {
  const Vec3 axis{a.x, a.y, a.z};
  const Vec3 t = 2.0 * cross(axis, v);
  return v + a.w * t + cross(axis, t);
}

/// Returns the same rotation with length one; the identity for zeros and for values that are not finite.
inline Quat normalised(Quat a) {
  const double length = std::sqrt(a.x * a.x + a.y * a.y + a.z * a.z + a.w * a.w);
  if (!(length > 1e-12 && length < 1e12)) return {};
  return {a.x / length, a.y / length, a.z / length, a.w / length};
}

/// A pose: a rotation about the origin, then a translation.
struct Rigid {
  Vec3 position;
  Quat rotation;
};

/// Returns the transform b followed by a.
constexpr Rigid operator*(Rigid a, Rigid b) {
  return {a.position + turn(a.rotation, b.position), a.rotation * b.rotation};
}

/// Returns the inverse transform.
constexpr Rigid inverse(Rigid a) {
  const Quat back = inverse(a.rotation);
  return {turn(back, -1.0 * a.position), back};
}

/// Transforms a position from the frame with pose `a`. For velocities, including angular ones, use `turn`.
constexpr Vec3 apply(Rigid a, Vec3 place) { return a.position + turn(a.rotation, place); }

}  // namespace pacinian
