#pragma once

#include "CoreMinimal.h"
#include "HapticEffectComponent.h"

#include "HapticPointComponent.generated.h"

/** A point that presses: a focus. */
UCLASS(ClassGroup = (Haptics), meta = (BlueprintSpawnableComponent, DisplayName = "Haptic Point"))
class PACINIAN_API UHapticPointComponent : public UHapticEffectComponent {
  GENERATED_BODY()

 public:
  /** Of the disc that it presses on [cm]; a focus of 40 kHz is about 0.85 cm wide. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", meta = (ClampMin = "0.01", ClampMax = "100", Units = "cm"))
  float Diameter = 0.85f;

 protected:
  virtual bool Describe(FHapticBody& Body, FString& Problem) const override;
};
