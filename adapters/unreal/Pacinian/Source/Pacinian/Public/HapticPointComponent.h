#pragma once

#include "CoreMinimal.h"
#include "HapticEffectComponent.h"

#include "HapticPointComponent.generated.h"

/** A focus that presses on a point. */
UCLASS(ClassGroup = (Haptics), meta = (BlueprintSpawnableComponent, DisplayName = "Haptic Point"))
class PACINIAN_API UHapticPointComponent : public UHapticEffectComponent {
  GENERATED_BODY()

 public:
  /** Diameter of the disc under pressure [cm]; a focus at 40 kHz is about 0.85 cm wide. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", meta = (ClampMin = "0.01", ClampMax = "100", Units = "cm"))
  float Diameter = 0.85f;

 protected:
  virtual bool Describe(FHapticBody& Body, FString& Problem) const override;
};
