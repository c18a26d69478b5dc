#include "HapticServerDetails.h"

#include "DetailCategoryBuilder.h"
#include "DetailLayoutBuilder.h"
#include "DetailWidgetRow.h"
#include "HapticServerComponent.h"
#include "Widgets/Text/STextBlock.h"

#define LOCTEXT_NAMESPACE "Pacinian"

void FHapticServerDetails::CustomizeDetails(IDetailLayoutBuilder& Layout) {
  TArray<TWeakObjectPtr<UObject>> Shown;
  Layout.GetObjectsBeingCustomized(Shown);
  Server = Shown.Num() == 1 ? Cast<UHapticServerComponent>(Shown[0].Get()) : nullptr;
  if (!Server.IsValid()) return;
  IDetailCategoryBuilder& Rows = Layout.EditCategory(TEXT("Haptics Status"), LOCTEXT("Title", "Haptics Status"),
                                                     ECategoryPriority::Important);
  using FTold = FText (FHapticServerDetails::*)() const;
  const auto Add = [&](const FText& Name, FTold Told) {
    Rows.AddCustomRow(Name)
        .NameContent()[SNew(STextBlock).Text(Name)]
        .ValueContent()[SNew(STextBlock).Text(this, Told).AutoWrapText(true)];
  };
  Add(LOCTEXT("Status", "Connection"), &FHapticServerDetails::Status);
  Add(LOCTEXT("Output", "Output"), &FHapticServerDetails::Output);
  Add(LOCTEXT("Silence", "Silent because"), &FHapticServerDetails::Silence);
  Add(LOCTEXT("Latency", "Round trip"), &FHapticServerDetails::Latency);
  Add(LOCTEXT("Problem", "Problem"), &FHapticServerDetails::Problem);
}

FText FHapticServerDetails::Status() const {
  return Server.IsValid() ? UEnum::GetDisplayValueAsText(Server->GetStatus()) : FText();
}

FText FHapticServerDetails::Output() const {
  if (!Server.IsValid()) return FText();
  const FText Told = UEnum::GetDisplayValueAsText(Server->GetOutput());
  return Server->IsArmed() ? FText::Format(LOCTEXT("Armed", "{0}, armed"), Told) : Told;
}

FText FHapticServerDetails::Silence() const {
  return Server.IsValid() ? FText::FromString(Server->GetSilence()) : FText();
}

FText FHapticServerDetails::Latency() const {
  if (!Server.IsValid() || !Server->IsConnected()) return FText();
  return FText::Format(LOCTEXT("Milliseconds", "{0} ms"), FText::AsNumber(1e3f * Server->GetLatency()));
}

FText FHapticServerDetails::Problem() const {
  return Server.IsValid() ? FText::FromString(Server->GetProblem()) : FText();
}

#undef LOCTEXT_NAMESPACE
