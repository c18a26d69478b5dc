#pragma once

#include "CoreMinimal.h"
#include "HAL/PlatformProcess.h"

/** The server that this editor started, if it did. */
class FServerProcess {
 public:
  ~FServerProcess() { Stop(); }

  /** Starts it as the settings say. False, with the problem. */
  bool Start(FString& Problem);

  /** Ends it, and with it all sound. */
  void Stop();

  bool IsRunning();

 private:
  FProcHandle Handle;
};
