#pragma once

// Stubs of what the editor module uses, which is compiled but not run.

#include "assets.h"

struct FPlatformProcess {
  static void* GetDllHandle(const TCHAR*) { return nullptr; }
  static void FreeDllHandle(void*) {}
};

class FSceneView;
enum ESceneDepthPriorityGroup { SDPG_World, SDPG_Foreground };
class FPrimitiveDrawInterface {
 public:
  void DrawLine(const FVector&, const FVector&, const FLinearColor&, uint8) {}
  void DrawPoint(const FVector&, const FLinearColor&, float, uint8) {}
};
class FComponentVisualizer {
 public:
  virtual ~FComponentVisualizer() = default;
  virtual void DrawVisualization(const UActorComponent*, const FSceneView*, FPrimitiveDrawInterface*) {}
};
struct UUnrealEdEngine {
  void RegisterComponentVisualizer(FName, TSharedPtr<FComponentVisualizer>) {}
  void UnregisterComponentVisualizer(FName) {}
};
inline UUnrealEdEngine* GUnrealEd = nullptr;

struct STextBlock {
  STextBlock& Text(const FText&) { return *this; }
  template <class T>
  STextBlock& Text(T*, FText (T::*)() const) {
    return *this;
  }
  STextBlock& AutoWrapText(bool) { return *this; }
};
#define SNew(type) type()
struct FDetailWidgetRow {
  FDetailWidgetRow& NameContent() { return *this; }
  FDetailWidgetRow& ValueContent() { return *this; }
  FDetailWidgetRow& operator[](const STextBlock&) { return *this; }
};
namespace ECategoryPriority {
enum Type { Important };
}
class IDetailCategoryBuilder {
 public:
  FDetailWidgetRow& AddCustomRow(const FText&) { return Row; }

 private:
  FDetailWidgetRow Row;
};
class IDetailLayoutBuilder {
 public:
  void GetObjectsBeingCustomized(TArray<TWeakObjectPtr<UObject>>&) {}
  IDetailCategoryBuilder& EditCategory(FName, const FText&, ECategoryPriority::Type) { return Category; }

 private:
  IDetailCategoryBuilder Category;
};
class IDetailCustomization {
 public:
  virtual ~IDetailCustomization() = default;
  virtual void CustomizeDetails(IDetailLayoutBuilder&) = 0;
};
struct FOnGetDetailCustomizationInstance {
  static FOnGetDetailCustomizationInstance CreateStatic(TSharedRef<IDetailCustomization> (*)()) { return {}; }
};
struct FPropertyEditorModule : IModuleInterface {
  void RegisterCustomClassLayout(FName, FOnGetDetailCustomizationInstance) {}
  void UnregisterCustomClassLayout(FName) {}
};
struct FModuleManager {
  template <class T>
  static T& LoadModuleChecked(FName) {
    static T Made;
    return Made;
  }
  template <class T>
  static T* GetModulePtr(FName) {
    return nullptr;
  }
};

struct FSlateIcon {};
struct FExecuteAction {
  template <class T>
  static FExecuteAction CreateRaw(T*, void (T::*)()) {
    return {};
  }
  static FExecuteAction CreateStatic(void (*)()) { return {}; }
};
struct FUIAction {
  explicit FUIAction(FExecuteAction) {}
};
struct FToolMenuSection {
  void AddMenuEntry(FName, const FText&, const FText&, const FSlateIcon&, const FUIAction&) {}
};
struct UToolMenu {
  FToolMenuSection& AddSection(FName, const FText&) { return Section; }
  FToolMenuSection Section;
};
struct FToolMenuOwnerScoped {
  explicit FToolMenuOwnerScoped(void*) {}
};
struct UToolMenus {
  static UToolMenus* Get() {
    static UToolMenus Made;
    return &Made;
  }
  UToolMenu* ExtendMenu(FName) { return &Menu; }
  static void RegisterStartupCallback(const FSimpleMulticastDelegate::FDelegate&) {}
  static void UnRegisterStartupCallback(void*) {}
  static void UnregisterOwner(void*) {}
  UToolMenu Menu;
};
namespace EAppMsgType {
enum Type { Ok };
}
struct FMessageDialog {
  static void Open(EAppMsgType::Type, const FText&) {}
};
