#include "OpenHand.h"

#include "CoreIncludes.h"

THIRD_PARTY_INCLUDES_START
#include "pacinian/space/hands.h"
THIRD_PARTY_INCLUDES_END

namespace Haptic {

void OpenHand(const FTransform& Palm, bool bLeft, TArray<FVector>& Joints, TArray<float>& Radii) {
  using Side = pacinian::wire::HandFrameSide;
  const FTransform Placed(Palm.GetRotation(), Palm.GetLocation());
  const pacinian::Hand Hand = pacinian::open_hand(bLeft ? Side::left : Side::right, pacinian::Rigid());
  Joints.Reset();
  Radii.Reset();
  for (const pacinian::Vec3& At : Hand.joints) Joints.Add(Placed.TransformPosition(Vec(pacinian::unreal::from_world(At))));
  for (const double Radius : Hand.radii) Radii.Add(static_cast<float>(Radius / pacinian::unreal::metres));
}

bool LeapHand(const TArray<FVector>& Bones, const TArray<float>& Widths, const FVector& Wrist, TArray<FVector>& Joints,
              TArray<float>& Radii) {
  constexpr double WristRadius = pacinian::adult_wrist_radius / pacinian::unreal::metres;  // [cm]
  if (Bones.Num() != 40 || Widths.Num() != 20) return false;
  std::array<std::array<pacinian::LeapBone, 4>, 5> Digits;
  for (int32 i = 0; i < 20; ++i)
    Digits[static_cast<std::size_t>(i / 4)][static_cast<std::size_t>(i % 4)] = {Vec(Bones[2 * i]), Vec(Bones[2 * i + 1]), Widths[i]};
  const pacinian::Hand Hand = pacinian::leap_hand(Digits, Vec(Wrist), WristRadius);
  Joints.Reset();
  Radii.Reset();
  for (const pacinian::Vec3& At : Hand.joints) Joints.Add(Vec(At));
  for (const double Radius : Hand.radii) Radii.Add(static_cast<float>(Radius));
  return true;
}

}  // namespace Haptic
