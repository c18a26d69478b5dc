#pragma once

#include "Core.h"

namespace Haptic {

/** Adds the lines of an object, as pairs of places in the level [cm]: in its true size. Frame: where it is in the world. */
void AddOutline(const pacinian::wire::Object& Object, const pacinian::Rigid& Frame, TArray<FVector>& Lines);

}  // namespace Haptic
