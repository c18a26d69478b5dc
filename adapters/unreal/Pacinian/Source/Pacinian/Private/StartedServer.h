#pragma once

#include "CoreMinimal.h"

namespace Haptic {

/** Starts a server as a child process, one for all levels. Returns false and the problem on failure. */
bool StartServer(const FString& ConnectionFile, FString& Problem);

/** Restarts the server if it has ended and no other is connected. */
void TickServer(bool bConnected);

/** Returns why the server does not run; empty if it does, or if none was started. */
FString ServerProblem();

/** Stops the server, and with it all sound. */
void StopServer();

}  // namespace Haptic
