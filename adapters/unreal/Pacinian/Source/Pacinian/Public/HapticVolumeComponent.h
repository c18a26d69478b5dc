#pragma once

#include "CoreMinimal.h"
#include "HapticEffectComponent.h"

#include "HapticVolumeComponent.generated.h"

class UStaticMesh;

/** What a haptic volume is. */
UENUM(BlueprintType)
enum class EHapticVolume : uint8 {
  /** Spheres, boxes and capsules: the simple collision of a component. */
  Colliders,
  /** A closed static mesh. */
  Mesh,
};

/** Where a haptic volume is felt. */
UENUM(BlueprintType)
enum class EHapticFelt : uint8 {
  /** On its outside, and a bit below. */
  Shell,
  /** Everywhere inside, too. */
  Interior,
};

/** A volume that presses evenly. */
UCLASS(ClassGroup = (Haptics), meta = (BlueprintSpawnableComponent, DisplayName = "Haptic Volume"))
class PACINIAN_API UHapticVolumeComponent : public UHapticEffectComponent {
  GENERATED_BODY()

 public:
  /** Colliders are those of the component that this one is attached to, or else of the actor's first that has some, and of
   * all that are attached below that one. A change of them is noticed. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics")
  EHapticVolume Shape = EHapticVolume::Colliders;

  /** None: that of the static mesh component that this one is attached to, or else of the actor's first. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", meta = (EditCondition = "Shape == EHapticVolume::Mesh", EditConditionHides))
  TObjectPtr<UStaticMesh> Mesh;

  /** How far inside a hand still feels it [cm]. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", meta = (ClampMin = "0.01", Units = "cm"))
  float Thickness = 2.0f;

  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics")
  EHapticFelt Felt = EHapticFelt::Shell;

 protected:
  virtual bool Describe(FHapticBody& Body, FString& Problem) const override;
  virtual const USceneComponent* GetShapeOwner() const override;
  virtual uint64 GetShapeFingerprint() const override;
};
