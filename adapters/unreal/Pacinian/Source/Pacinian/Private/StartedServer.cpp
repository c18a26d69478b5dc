#include "StartedServer.h"

#include <memory>

#include "CoreIncludes.h"
#include "HAL/FileManager.h"
#include "HapticServerComponent.h"
#include "Interfaces/IPluginManager.h"
#include "Misc/Paths.h"
#include "PacinianSettings.h"

THIRD_PARTY_INCLUDES_START
#include "pacinian/server_process.h"
THIRD_PARTY_INCLUDES_END

namespace Haptic {

namespace {

std::unique_ptr<pacinian::ServerProcess> Started;

/// Returns the standalone server in the plugin's folder, which is packaged with the game; otherwise the program in the
/// settings.
FString Program() {
#if PLATFORM_WINDOWS
  const TCHAR* Inside = TEXT("Server/pacinian/pacinian.exe");
#else
  const TCHAR* Inside = TEXT("Server/pacinian/pacinian");
#endif
  const TSharedPtr<IPlugin> Plugin = IPluginManager::Get().FindPlugin(TEXT("Pacinian"));
  const FString Bundled = Plugin ? FPaths::ConvertRelativePathToFull(FPaths::Combine(Plugin->GetBaseDir(), Inside)) : FString();
  return FPaths::FileExists(Bundled) ? Bundled : GetDefault<UPacinianSettings>()->ServerCommand;
}

}  // namespace

bool StartServer(const FString& ConnectionFile, FString& Problem) {
  pacinian::ServerProcess::Options Options;
  Options.program = Text(Program());
  for (const FString& Word : GetDefault<UPacinianSettings>()->ServerArguments) Options.arguments.push_back(Text(Word));
  Options.connection_path = Text(ConnectionFile);
  const FString Logs = FPaths::ConvertRelativePathToFull(FPaths::ProjectLogDir());  // a game for users may not have made it
  if (IFileManager::Get().MakeDirectory(*Logs, /*Tree=*/true))
    Options.log = Text(FPaths::Combine(Logs, TEXT("PacinianServer.log")));
  else
    UE_LOG(LogPacinian, Warning, TEXT("The server has no log, because its folder %s cannot be made"), *Logs);
  if (!Started || !Started->runs()) Started = std::make_unique<pacinian::ServerProcess>(MoveTemp(Options));
  const bool bStarted = Started->start();
  Problem = ServerProblem();
  if (!bStarted) UE_LOG(LogPacinian, Warning, TEXT("%s"), *Problem);
  return bStarted;
}

void TickServer(bool bConnected) {
  if (Started) Started->tick(bConnected);
}

FString ServerProblem() { return Started ? Text(Started->problem()) : FString(); }

void StopServer() { Started.reset(); }

}  // namespace Haptic

bool UHapticServerComponent::StartServer(FString& Problem) const { return Haptic::StartServer(ConnectionFile, Problem); }

void UHapticServerComponent::StopServer() { Haptic::StopServer(); }
