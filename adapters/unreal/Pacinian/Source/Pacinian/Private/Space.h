#pragma once

#include "CoreIncludes.h"

/** Converts between the level (left-handed, centimetres) and the array's frame (right-handed, metres). */
struct FHapticSpace {
  FHapticSpace() = default;
  explicit FHapticSpace(const FTransform& Origin) : World(Metres(Origin)), Array(pacinian::inverse(World)) {}

  /** Returns a component's pose, without its scale. */
  pacinian::Rigid Into(const FTransform& Given) const { return Array * Metres(Given); }

  pacinian::Vec3 Into(const FVector& Given) const {
    return pacinian::apply(Array, pacinian::unreal::to_world(Haptic::Vec(Given)));
  }

  FVector Out(const pacinian::Vec3& Given) const {
    return Haptic::Vec(pacinian::unreal::from_world(pacinian::apply(World, Given)));
  }

  FVector OutDirection(const pacinian::Vec3& Given) const {
    return Haptic::Vec(pacinian::unreal::swapped(pacinian::turn(World.rotation, Given)));
  }

  static pacinian::Rigid Metres(const FTransform& Given) {
    const FQuat Turn = Given.GetRotation();
    return {pacinian::unreal::to_world(Haptic::Vec(Given.GetLocation())),
            pacinian::normalised(pacinian::unreal::rotation({Turn.X, Turn.Y, Turn.Z, Turn.W}))};
  }

  static FTransform Centimetres(const pacinian::Rigid& Given) {
    const pacinian::Rigid Made = pacinian::unreal::from_world(Given);
    return FTransform(FQuat(Made.rotation.x, Made.rotation.y, Made.rotation.z, Made.rotation.w),
                      Haptic::Vec(Made.position));
  }

 private:
  pacinian::Rigid World, Array;
};
