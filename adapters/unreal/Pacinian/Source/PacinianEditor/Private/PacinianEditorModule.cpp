#include "ArrayOriginComponent.h"
#include "ArrayOriginVisualizer.h"
#include "Editor/UnrealEdEngine.h"
#include "HapticEffectVisualizer.h"
#include "HapticPointComponent.h"
#include "HapticServerComponent.h"
#include "HapticServerDetails.h"
#include "HapticSurfaceComponent.h"
#include "HapticVolumeComponent.h"
#include "Misc/MessageDialog.h"
#include "Modules/ModuleManager.h"
#include "PropertyEditorModule.h"
#include "ToolMenus.h"
#include "UObject/UObjectIterator.h"
#include "UnrealEdGlobals.h"

#define LOCTEXT_NAMESPACE "Pacinian"

DEFINE_LOG_CATEGORY_STATIC(LogPacinianEditor, Log, All);

/** Registers the details panel, the visualizers and the entries of the Tools menu. */
class FPacinianEditorModule : public IModuleInterface {
 public:
  virtual void StartupModule() override {
    FModuleManager::LoadModuleChecked<FPropertyEditorModule>(Properties)
        .RegisterCustomClassLayout(UHapticServerComponent::StaticClass()->GetFName(),
                                   FOnGetDetailCustomizationInstance::CreateStatic(&FHapticServerDetails::Make));
    if (GUnrealEd) {
      GUnrealEd->RegisterComponentVisualizer(UArrayOriginComponent::StaticClass()->GetFName(),
                                             MakeShared<FArrayOriginVisualizer>());
      for (const FName& Effect : Effects()) GUnrealEd->RegisterComponentVisualizer(Effect, MakeShared<FHapticEffectVisualizer>());
    } else {
      UE_LOG(LogPacinianEditor, Warning, TEXT("Effects and the array are not drawn, because the editor's engine is missing"));
    }
    UToolMenus::RegisterStartupCallback(
        FSimpleMulticastDelegate::FDelegate::CreateRaw(this, &FPacinianEditorModule::AddMenu));
  }

  virtual void ShutdownModule() override {
    UToolMenus::UnRegisterStartupCallback(this);
    UToolMenus::UnregisterOwner(this);
    if (!UObjectInitialized()) return;
    if (GUnrealEd) {
      GUnrealEd->UnregisterComponentVisualizer(UArrayOriginComponent::StaticClass()->GetFName());
      for (const FName& Effect : Effects()) GUnrealEd->UnregisterComponentVisualizer(Effect);
    }
    if (auto* Found = FModuleManager::GetModulePtr<FPropertyEditorModule>(Properties))
      Found->UnregisterCustomClassLayout(UHapticServerComponent::StaticClass()->GetFName());
  }

 private:
  static constexpr const TCHAR* Properties = TEXT("PropertyEditor");

  static TArray<FName> Effects() {
    return {UHapticPointComponent::StaticClass()->GetFName(), UHapticSurfaceComponent::StaticClass()->GetFName(),
            UHapticVolumeComponent::StaticClass()->GetFName()};
  }

  void AddMenu() {
    const FToolMenuOwnerScoped Owner(this);
    FToolMenuSection& Section = UToolMenus::Get()->ExtendMenu(TEXT("LevelEditor.MainMenu.Tools"))
                                    ->AddSection(TEXT("Pacinian"), LOCTEXT("Menu", "Haptics"));
    Section.AddMenuEntry(TEXT("PacinianStart"), LOCTEXT("Start", "Start Haptic Server"),
                         LOCTEXT("StartTip", "Starts the server in the plugin's folder, or the one in the project's settings, unless one runs."), FSlateIcon(),
                         FUIAction(FExecuteAction::CreateStatic(&FPacinianEditorModule::Start)));
    Section.AddMenuEntry(TEXT("PacinianEnd"), LOCTEXT("End", "End Haptic Server"),
                         LOCTEXT("EndTip", "Stops the server that was started here, and with it all sound."), FSlateIcon(),
                         FUIAction(FExecuteAction::CreateStatic(&UHapticServerComponent::StopServer)));
    Section.AddMenuEntry(TEXT("PacinianStop"), LOCTEXT("Stop", "Emergency Stop"),
                         LOCTEXT("StopTip", "Silences the array at once, until the output is reset."), FSlateIcon(),
                         FUIAction(FExecuteAction::CreateStatic(&FPacinianEditorModule::EmergencyStop)));
  }

  static void Start() {
    FString Problem;
    if (GetDefault<UHapticServerComponent>()->StartServer(Problem)) return;
    Problem = Problem + TEXT(". Say where it is in Project Settings, Plugins, Pacinian.");
    FMessageDialog::Open(EAppMsgType::Ok, FText::FromString(Problem));
  }

  /// Stops the servers of all open levels; without any, the server at the default connection. Skips templates: default
  /// objects of classes, with their components.
  static void EmergencyStop() {
    bool bFound = false;
    for (TObjectIterator<UHapticServerComponent> It; It; ++It) {
      if (It->IsTemplate()) continue;
      It->EmergencyStop();
      bFound = true;
    }
    if (!bFound) GetMutableDefault<UHapticServerComponent>()->EmergencyStop();
  }
};

IMPLEMENT_MODULE(FPacinianEditorModule, PacinianEditor)

#undef LOCTEXT_NAMESPACE
