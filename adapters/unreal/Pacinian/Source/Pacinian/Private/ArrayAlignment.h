#pragma once

#include "CoreIncludes.h"

namespace Haptic {

/** Returns the outermost transducers of the array of an object's world, in the array's frame [cm]; empty without a server. */
TArray<FVector> Corners(const UObject* Object);

/** Finds the pose of the array from known and touched points [cm], and the remaining distances. Returns false and
 * the problem on failure. */
bool Align(const TArray<FVector>& Known, const TArray<FVector>& Touched, FTransform& Found, double& Residual,
           double& Worst, FString& Problem);

}  // namespace Haptic
