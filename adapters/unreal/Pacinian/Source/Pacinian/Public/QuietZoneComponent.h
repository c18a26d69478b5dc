#pragma once

#include "Components/SceneComponent.h"
#include "CoreMinimal.h"

#include "QuietZoneComponent.generated.h"

/** A ball that is to stay quiet, as about a head: attach it to the camera. At most 16 count. */
UCLASS(ClassGroup = (Haptics), meta = (BlueprintSpawnableComponent, DisplayName = "Quiet Zone"))
class PACINIAN_API UQuietZoneComponent : public USceneComponent {
  GENERATED_BODY()

 public:
  /** Of the ball [cm]. 0: a point. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", meta = (ClampMin = "0", ClampMax = "100", Units = "cm"))
  float Radius = 10.0f;

  /** The most sound pressure in it [Pa]; 20 Pa are 120 dB. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", meta = (ClampMin = "0"))
  float Pressure = 20.0f;

  virtual void BeginPlay() override;
  virtual void EndPlay(const EEndPlayReason::Type Reason) override;
};
