#include "CoreIncludes.h"
#include "HapticServerComponent.h"
#include "Modules/ModuleManager.h"
#include "StartedServer.h"
#include "UObject/UObjectGlobals.h"
#include "UObject/UObjectIterator.h"

DEFINE_LOG_CATEGORY(LogPacinian);

/** Ends all connections before the module is unloaded, because their threads run its code. */
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
