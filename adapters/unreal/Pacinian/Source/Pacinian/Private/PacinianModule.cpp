#include "Core.h"
#include "HapticServerComponent.h"
#include "Modules/ModuleManager.h"
#include "StartedServer.h"
#include "UObject/UObjectGlobals.h"
#include "UObject/UObjectIterator.h"

DEFINE_LOG_CATEGORY(LogPacinian);

/** Ends all connections before its code is unloaded: none of their threads may be left. */
class FPacinianModule : public IModuleInterface {
 public:
  virtual void ShutdownModule() override {
    if (!UObjectInitialized()) return;
    for (TObjectIterator<UHapticServerComponent> It; It; ++It) It->Disconnect();
    GetMutableDefault<UHapticServerComponent>()->Disconnect();
    Haptic::StopServer();
  }
};

IMPLEMENT_MODULE(FPacinianModule, Pacinian)
