#pragma once

#include "HapticLink.h"

class UHapticScene;

namespace Haptic {

/** Sends all hands. Also sends an empty list if there was a hand in this session and none is left. */
void SendHands(FHapticLink& Link, UHapticScene& Scene);

/** Sends all quiet zones if they have changed. */
void SendZones(FHapticLink& Link, UHapticScene& Scene);

/** Sends the quiet zones again after a second if the server refused them. Path: of what it refused. */
void RefuseZones(FHapticLink& Link, const FString& Path);

}  // namespace Haptic
