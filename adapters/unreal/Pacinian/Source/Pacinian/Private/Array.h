#pragma once

#include "Core.h"

namespace Haptic {

/** The outermost transducers of the array of an object's world, in its own frame [cm]; empty without a server. */
TArray<FVector> Corners(const UObject* Object);

/** From the array's frame to where its known points were touched [cm], and the distances left. False, with the problem. */
bool Align(const TArray<FVector>& Known, const TArray<FVector>& Touched, FTransform& Found, double& Residual,
           double& Worst, FString& Problem);

}  // namespace Haptic
