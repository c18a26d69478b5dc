#pragma once

#include "CoreMinimal.h"
#include "HapticEffectComponent.h"

#include "HapticVolumeComponent.generated.h"

class UStaticMesh;

/** The shape of a haptic volume. */
UENUM(BlueprintType)
enum class EHapticVolume : uint8 {
  /** Spheres, boxes and capsules: the simple collision of a component. */
  Colliders,
  /** A closed static mesh. */
  Mesh,
};

/** The part of a volume that is felt. */
UENUM(BlueprintType)
enum class EHapticFelt : uint8 {
  /** The outside, and a shallow depth below. */
  Shell,
  /** The whole interior, too. */
  Interior,
};

/** A volume with an even pressure. */
UCLASS(ClassGroup = (Haptics), meta = (BlueprintSpawnableComponent, DisplayName = "Haptic Volume"))
class PACINIAN_API UHapticVolumeComponent : public UHapticEffectComponent {
  GENERATED_BODY()

 public:
  /** The shape. Colliders: those of the component that this one is attached to, otherwise of the actor's first that
   * has some, and of all components attached below that one. Changes of the colliders are sent. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics")
  EHapticVolume Shape = EHapticVolume::Colliders;

  /** The mesh. None: that of the static mesh component that this one is attached to, otherwise of the actor's first. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", meta = (EditCondition = "Shape == EHapticVolume::Mesh", EditConditionHides))
  TObjectPtr<UStaticMesh> Mesh;

  /** Depth inside the volume up to which a hand feels it [cm]. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", meta = (ClampMin = "0.01", Units = "cm"))
  float Thickness = 2.0f;

  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics")
  EHapticFelt Felt = EHapticFelt::Shell;

 protected:
  virtual bool Describe(FHapticBody& Body, FString& Problem) const override;
  virtual const USceneComponent* GetShapeOwner() const override;
  virtual TArray<uint64> GetShapeValues() const override;

 private:
  const UStaticMesh* GetMesh() const;
};
