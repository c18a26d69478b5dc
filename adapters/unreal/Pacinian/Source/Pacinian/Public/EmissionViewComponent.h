#pragma once

#include "Components/ActorComponent.h"
#include "CoreMinimal.h"

#include "EmissionViewComponent.generated.h"

/** Draws what the server says that it emits, not what the game asked for; not in shipping builds. */
UCLASS(ClassGroup = (Haptics), meta = (BlueprintSpawnableComponent, DisplayName = "Emission View"))
class PACINIAN_API UEmissionViewComponent : public UActorComponent {
  GENERATED_BODY()

 public:
  UEmissionViewComponent();

  /** The points that are pressed on: blue is weak, red as strong as the strongest asked for. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics")
  bool bDrawSamples = true;

  /** Which way their surface faces. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics")
  bool bDrawNormals = false;

  /** The hands as they are rendered. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics")
  bool bDrawHands = true;

  /** The points that are pressed on now, in the level [cm], and how hard [Pa]. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  void GetSamples(TArray<FVector>& Positions, TArray<float>& Pressures) const;

  virtual void TickComponent(float DeltaTime, ELevelTick TickType, FActorComponentTickFunction* Tick) override;
};
