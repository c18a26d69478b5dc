#include "ServerProcess.h"

#include "PacinianSettings.h"

bool FServerProcess::Start(FString& Problem) {
  if (IsRunning()) return true;
  const UPacinianSettings* Settings = GetDefault<UPacinianSettings>();
  constexpr bool bDetached = false, bHidden = false, bReallyHidden = false;
  Handle = FPlatformProcess::CreateProc(*Settings->ServerCommand, *Settings->ServerArguments, bDetached, bHidden,
                                        bReallyHidden, nullptr, 0, nullptr, nullptr);
  if (Handle.IsValid()) return true;
  Problem = FString::Printf(TEXT("%s was not found. Install it (python -m pip install . in a checkout of Pacinian), or "
                                 "say where it is in Project Settings, Plugins, Pacinian."),
                            *Settings->ServerCommand);
  return false;
}

void FServerProcess::Stop() {
  if (!Handle.IsValid()) return;
  FPlatformProcess::TerminateProc(Handle, true);
  FPlatformProcess::CloseProc(Handle);
}

bool FServerProcess::IsRunning() { return Handle.IsValid() && FPlatformProcess::IsProcRunning(Handle); }
