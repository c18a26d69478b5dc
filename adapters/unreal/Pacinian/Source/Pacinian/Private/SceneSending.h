#pragma once

#include "HapticLink.h"

class UHapticScene;

namespace Haptic {

/** Sends all hands. Also sends an empty list if there was a hand in this session and none is left. */
void SendHands(FHapticLink& Link, UHapticScene& Scene);

/** Sends all quiet zones if they have changed. */
void SendZones(FHapticLink& Link, UHapticScene& Scene);

/**
 * Sends the quiet zones again after a second if there are too many until others remove theirs, or if they came late. Zones
 * that are refused for another reason are sent again only after a change. Code, Path: of the refusal.
 */
void RefuseZones(FHapticLink& Link, const FString& Code, const FString& Path);

}  // namespace Haptic
