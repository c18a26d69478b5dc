#pragma once

#include "CoreMinimal.h"

namespace Haptic {

/** The server that this program has started, if it has: one for all levels. */
bool StartServer(const FString& ConnectionFile, FString& Problem);

/** Starts it again if it has ended and no other is connected. */
void TickServer(bool bConnected);

/** Why it does not run; empty if it does, or none was started. */
FString ServerProblem();

/** Ends it, and with it all sound. */
void StopServer();

}  // namespace Haptic
