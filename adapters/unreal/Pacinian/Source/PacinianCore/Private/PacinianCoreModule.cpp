#include "CoreMinimal.h"
#include "HAL/PlatformProcess.h"
#include "Interfaces/IPluginManager.h"
#include "Misc/Paths.h"
#include "Modules/ModuleManager.h"

/** Makes an engine module of the core, which does not depend on the engine. The core then uses the engine's
 * allocator, like the modules that exchange strings and arrays with it. */
class FPacinianCoreModule : public IModuleInterface {
 public:
  virtual void StartupModule() override {
#if PLATFORM_WINDOWS && defined(PACINIAN_LIBZMQ)  // elsewhere the loader finds it
    const TSharedPtr<IPlugin> Plugin = IPluginManager::Get().FindPlugin(TEXT("Pacinian"));
    if (Plugin)
      Library = FPlatformProcess::GetDllHandle(
          *FPaths::Combine(Plugin->GetBaseDir(), TEXT("Binaries/ThirdParty/ZeroMQ/Win64/libzmq.dll")));
#endif
  }

  virtual void ShutdownModule() override {
    if (Library) FPlatformProcess::FreeDllHandle(Library);
    Library = nullptr;
  }

 private:
  void* Library = nullptr;
};

IMPLEMENT_MODULE(FPacinianCoreModule, PacinianCore)
