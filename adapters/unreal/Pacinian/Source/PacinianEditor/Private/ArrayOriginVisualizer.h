#pragma once

#include "ComponentVisualizer.h"
#include "CoreMinimal.h"

/** Shows the pose of a selected array origin, and the points to touch. */
class FArrayOriginVisualizer : public FComponentVisualizer {
 public:
  virtual void DrawVisualization(const UActorComponent* Component, const FSceneView* View,
                                 FPrimitiveDrawInterface* Draw) override;
};
