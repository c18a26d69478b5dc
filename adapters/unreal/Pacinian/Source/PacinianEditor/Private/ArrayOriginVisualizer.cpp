#include "ArrayOriginVisualizer.h"

#include "ArrayOriginComponent.h"
#include "SceneManagement.h"

void FArrayOriginVisualizer::DrawVisualization(const UActorComponent* Component, const FSceneView*,
                                               FPrimitiveDrawInterface* Draw) {
  const auto* Origin = Cast<UArrayOriginComponent>(Component);
  if (!Origin) return;
  const FTransform Pose = Origin->GetComponentTransform();
  const FVector Middle = Pose.GetLocation();
  constexpr double Axis = 20.0;  // [cm]
  Draw->DrawLine(Middle, Middle + Axis * Pose.GetUnitAxis(EAxis::X), FLinearColor::Red, SDPG_Foreground);
  Draw->DrawLine(Middle, Middle + Axis * Pose.GetUnitAxis(EAxis::Y), FLinearColor::Green, SDPG_Foreground);
  Draw->DrawLine(Middle, Middle + Axis * Pose.GetUnitAxis(EAxis::Z), FLinearColor::Blue, SDPG_Foreground);
  for (const FVector& Point : Origin->KnownPoints)
    Draw->DrawPoint(Pose.TransformPositionNoScale(Point), FLinearColor::Yellow, 10.0f, SDPG_Foreground);
}
