#pragma once

#include "Components/SceneComponent.h"
#include "CoreMinimal.h"

#include "QuietZoneComponent.generated.h"

/** A sphere that stays quiet, for example around a head: attach it to the camera. At most 16 zones count. */
UCLASS(ClassGroup = (Haptics), meta = (BlueprintSpawnableComponent, DisplayName = "Quiet Zone"))
class PACINIAN_API UQuietZoneComponent : public USceneComponent {
  GENERATED_BODY()

 public:
  /** Radius of the sphere [cm]. 0: a point. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", meta = (ClampMin = "0", ClampMax = "100", Units = "cm"))
  float Radius = 10.0f;

  /** Highest sound pressure inside [Pa]; 20 Pa are 120 dB. Less than 0.1 Pa counts as 0.1 Pa. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", meta = (ClampMin = "0.1"))
  float Pressure = 20.0f;

  virtual void BeginPlay() override;
  virtual void EndPlay(const EEndPlayReason::Type Reason) override;
};
