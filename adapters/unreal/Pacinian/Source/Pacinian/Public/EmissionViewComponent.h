#pragma once

#include "Components/ActorComponent.h"
#include "CoreMinimal.h"

#include "EmissionViewComponent.generated.h"

/** Draws what the server reports that it emits, which may differ from what the game requested; not in shipping builds. */
UCLASS(ClassGroup = (Haptics), meta = (BlueprintSpawnableComponent, DisplayName = "Emission View"))
class PACINIAN_API UEmissionViewComponent : public UActorComponent {
  GENERATED_BODY()

 public:
  UEmissionViewComponent();

  /** Draws the points under pressure: blue is weak, red is the strongest requested pressure. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics")
  bool bDrawSamples = true;

  /** Draws the normals of the surface at these points. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics")
  bool bDrawNormals = false;

  /** Draws the hands as the server renders them. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics")
  bool bDrawHands = true;

  /** Gets the points under pressure, in the level [cm], and their pressures [Pa]. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  void GetSamples(TArray<FVector>& Positions, TArray<float>& Pressures) const;

  virtual void TickComponent(float DeltaTime, ELevelTick TickType, FActorComponentTickFunction* Tick) override;
};
