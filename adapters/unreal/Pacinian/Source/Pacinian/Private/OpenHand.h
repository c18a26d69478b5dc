#pragma once

#include "CoreMinimal.h"

namespace Haptic {

/** Computes the joints and radii of an open hand [cm], in OpenXR's order. The palm faces down, the fingers point along X. */
void OpenHand(const FTransform& Palm, bool bLeft, TArray<FVector>& Joints, TArray<float>& Radii);

/** Computes the same for a hand from Ultraleap [cm]; see UHapticHandComponent::SetLeap. Returns false if a count is wrong. */
bool LeapHand(const TArray<FVector>& Bones, const TArray<float>& Widths, const FVector& Wrist, TArray<FVector>& Joints,
              TArray<float>& Radii);

}  // namespace Haptic
