#pragma once

#include "pacinian/space/rigid.h"

/// Converts between Unreal's frame and the world's. Unreal: left-handed, x forward, y right, z up, centimetres. World:
/// right-handed, x right, y forward, z up, metres. The conversion swaps x and y. Because this is a reflection,
/// rotations and angular velocities also change their sign.
namespace pacinian::unreal {

constexpr double metres = 0.01;  ///< in a centimetre

/// Converts a direction, or an extent along the axes, either way.
constexpr Vec3 swapped(Vec3 v) { return {v.y, v.x, v.z}; }

/// Converts a position [cm] or velocity [cm/s] to the world's [m], [m/s].
constexpr Vec3 to_world(Vec3 v) { return metres * swapped(v); }

/// Converts a position [m] or velocity [m/s] of the world to Unreal's [cm], [cm/s].
constexpr Vec3 from_world(Vec3 v) { return (1.0 / metres) * swapped(v); }

/// Converts an angular velocity [rad/s], either way. It is an axial vector: v = cross(angular, place) in both frames.
constexpr Vec3 angular(Vec3 v) { return -1.0 * swapped(v); }

/// Converts a rotation, either way.
constexpr Quat rotation(Quat a) { return {-a.y, -a.x, -a.z, a.w}; }

/// Converts a pose [cm] to the world's [m].
constexpr Rigid to_world(Rigid a) { return {to_world(a.position), rotation(a.rotation)}; }

/// Converts a pose of the world [m] to Unreal's [cm].
constexpr Rigid from_world(Rigid a) { return {from_world(a.position), rotation(a.rotation)}; }

}  // namespace pacinian::unreal
