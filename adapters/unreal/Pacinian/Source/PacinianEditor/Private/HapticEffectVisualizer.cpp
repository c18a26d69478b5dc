#include "HapticEffectVisualizer.h"

#include "HapticEffectComponent.h"
#include "SceneManagement.h"

void FHapticEffectVisualizer::DrawVisualization(const UActorComponent* Component, const FSceneView*,
                                                FPrimitiveDrawInterface* Draw) {
  const auto* Effect = Cast<UHapticEffectComponent>(Component);
  TArray<FVector> Lines;
  FString Problem;
  if (!Effect || !Effect->GetOutline(Lines, Problem)) return;
  for (int32 i = 0; i + 1 < Lines.Num(); i += 2) Draw->DrawLine(Lines[i], Lines[i + 1], FLinearColor::Blue, SDPG_Foreground);
}
