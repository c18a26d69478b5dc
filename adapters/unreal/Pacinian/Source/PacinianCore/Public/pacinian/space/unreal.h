#pragma once

#include "pacinian/space/rigid.h"

/// Unreal's frame and the world's. Unreal: left-handed, x forward, y right, z up, centimetres. World: right-handed,
/// x right, y forward, z up, metres. x and y change places, which is a reflection: rotations and angular velocities
/// change their sign with it.
namespace pacinian::unreal {

constexpr double metres = 0.01;  ///< in a centimetre

/// A direction, or an extent along axes; the same both ways.
constexpr Vec3 swapped(Vec3 v) { return {v.y, v.x, v.z}; }

/// A place [cm] or velocity [cm/s], in the world [m], [m/s].
constexpr Vec3 to_world(Vec3 v) { return metres * swapped(v); }

/// A place [m] or velocity [m/s] in the world, in Unreal [cm], [cm/s].
constexpr Vec3 from_world(Vec3 v) { return (1.0 / metres) * swapped(v); }

/// An angular velocity, an axial vector: v = cross(angular, place) in either frame. [rad/s]; the same both ways.
constexpr Vec3 angular(Vec3 v) { return -1.0 * swapped(v); }

/// A rotation; the same both ways.
constexpr Quat rotation(Quat a) { return {-a.y, -a.x, -a.z, a.w}; }

/// A place and rotation [cm], in the world [m].
constexpr Rigid to_world(Rigid a) { return {to_world(a.position), rotation(a.rotation)}; }

/// A place and rotation in the world [m], in Unreal [cm].
constexpr Rigid from_world(Rigid a) { return {from_world(a.position), rotation(a.rotation)}; }

}  // namespace pacinian::unreal
