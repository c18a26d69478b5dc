#pragma once

#include "ComponentVisualizer.h"
#include "CoreMinimal.h"

/** Shows where an array origin that is selected stands, and which points of it are to be touched. */
class FArrayOriginVisualizer : public FComponentVisualizer {
 public:
  virtual void DrawVisualization(const UActorComponent* Component, const FSceneView* View,
                                 FPrimitiveDrawInterface* Draw) override;
};
