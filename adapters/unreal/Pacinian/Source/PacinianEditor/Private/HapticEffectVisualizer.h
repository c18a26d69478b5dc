#pragma once

#include "ComponentVisualizer.h"
#include "CoreMinimal.h"

/** Shows a selected effect as it will be felt, in its true size. */
class FHapticEffectVisualizer : public FComponentVisualizer {
 public:
  virtual void DrawVisualization(const UActorComponent* Component, const FSceneView* View,
                                 FPrimitiveDrawInterface* Draw) override;
};
