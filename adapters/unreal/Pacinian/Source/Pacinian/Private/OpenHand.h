#pragma once

#include "CoreMinimal.h"

namespace Haptic {

/** Joints of an open hand [cm], in OpenXR's order, and their radii [cm]. The palm is at a pose, faces down; fingers along X. */
void OpenHand(const FTransform& Palm, bool bLeft, TArray<FVector>& Joints, TArray<float>& Radii);

}  // namespace Haptic
