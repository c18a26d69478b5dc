#pragma once

#include "CoreIncludes.h"

namespace Haptic {

/** Adds the outline of an object in its true size, as pairs of positions in the level [cm]. Frame: the object's frame in the world. */
void AddOutline(const pacinian::wire::Object& Object, const pacinian::Rigid& Frame, TArray<FVector>& Lines);

}  // namespace Haptic
