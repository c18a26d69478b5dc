#pragma once

#include "Link.h"

class UHapticScene;
class UHapticServerComponent;

namespace Haptic {

/** How that component wants to connect. */
pacinian::Options Wanted(const UHapticServerComponent& Server);

/** Keeps what there is to choose from, for the editor's lists. */
void Remember(FHapticLink& Link);

/** All hands. Where there was one in this session, also that there is none any more. */
void TellHands(FHapticLink& Link, UHapticScene& Scene);

/** All quiet zones, if they are others than before. */
void TellZones(FHapticLink& Link, UHapticScene& Scene);

}  // namespace Haptic
