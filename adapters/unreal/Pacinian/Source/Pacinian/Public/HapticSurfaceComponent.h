#pragma once

#include "CoreMinimal.h"
#include "HapticEffectComponent.h"

#include "HapticSurfaceComponent.generated.h"

class UStaticMesh;

/** The shape of a haptic surface. */
UENUM(BlueprintType)
enum class EHapticSurface : uint8 {
  /** A static mesh, felt on its front faces. */
  Mesh,
  /** A rectangle in the component's XY plane, felt from above. */
  Rectangle,
  /** A disc in the component's XY plane, felt from above. */
  Disc,
};

/** A surface with an even pressure. */
UCLASS(ClassGroup = (Haptics), meta = (BlueprintSpawnableComponent, DisplayName = "Haptic Surface"))
class PACINIAN_API UHapticSurfaceComponent : public UHapticEffectComponent {
  GENERATED_BODY()

 public:
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics")
  EHapticSurface Shape = EHapticSurface::Mesh;

  /** The mesh. None: that of the static mesh component that this one is attached to, otherwise of the actor's first. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", meta = (EditCondition = "Shape == EHapticSurface::Mesh", EditConditionHides))
  TObjectPtr<UStaticMesh> Mesh;

  /** Size along X and Y [cm]. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", meta = (EditCondition = "Shape == EHapticSurface::Rectangle", EditConditionHides))
  FVector2D Size = FVector2D(10.0, 10.0);

  /** Radius of the disc [cm]. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", meta = (ClampMin = "0.01", Units = "cm", EditCondition = "Shape == EHapticSurface::Disc", EditConditionHides))
  float Radius = 5.0f;

  /** Depth below the surface up to which a hand feels it [cm]. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", meta = (ClampMin = "0.01", Units = "cm"))
  float Thickness = 2.0f;

 protected:
  virtual bool Describe(FHapticBody& Body, FString& Problem) const override;
  virtual const USceneComponent* GetShapeOwner() const override;
  virtual TArray<uint64> GetShapeValues() const override;
  /** Turned over if a negative scale along Z mirrors a rectangle or disc. A mesh has mirrored faces instead. */
  virtual FTransform GetShapeTransform() const override;

 private:
  const UStaticMesh* GetMesh() const;
};
