#pragma once

#include "CoreMinimal.h"

namespace Haptic {

/** Joints of an open hand [cm], in OpenXR's order, and their radii [cm]. The palm is at a pose, faces down; fingers along X. */
void OpenHand(const FTransform& Palm, bool bLeft, TArray<FVector>& Joints, TArray<float>& Radii);

/** The same of a hand as Ultraleap tells it [cm]: see UHapticHandComponent::SetLeap. False if that is no hand. */
bool LeapHand(const TArray<FVector>& Bones, const TArray<float>& Widths, const FVector& Wrist, TArray<FVector>& Joints,
              TArray<float>& Radii);

}  // namespace Haptic
