#pragma once

#include "Components/SceneComponent.h"
#include "CoreMinimal.h"

#include "ArrayOriginComponent.generated.h"

/** The pose of the array in the tracked world: its middle, with its normal along the component's Z.
 *
 * In VR, attach the component to what moves with the player, such as the pawn's VR origin. The array then stays in
 * the room when the player teleports. To find the pose, touch known points of the array; the pose is stored between
 * sessions. */
UCLASS(ClassGroup = (Haptics), meta = (BlueprintSpawnableComponent, DisplayName = "Array Origin"))
class PACINIAN_API UArrayOriginComponent : public USceneComponent {
  GENERATED_BODY()

 public:
  UArrayOriginComponent();

  /** Points to touch, in the component's frame [cm]: at least 3, not on a line. Empty: the array's corners. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics")
  TArray<FVector> KnownPoints;

  /** Name under which the alignment is stored on this computer. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics")
  FString CalibrationName = TEXT("default");

  /** Applies the stored pose when play begins. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics")
  bool bLoadOnStart = true;

  /** Draws the array's axes and transducers while the game runs; not in shipping builds. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics")
  bool bDrawArray = true;

  /** Discards the touched points and starts again. Returns false if the points are unknown, because no server is connected. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  bool BeginAlignment();

  /** Gets the next point to touch, in the component's frame [cm]. Returns false if all points have been touched. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  bool GetNextPoint(FVector& Point) const;

  /** Records where the user touched the next point: a position in the level [cm]. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  void TouchPoint(const FVector& Position);

  /** Returns the number of points that have been touched. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  int32 GetTouched() const;

  /** Moves the component to the touched points. Returns false and the problem if fewer than 3 points were touched,
   * or if all lie on a line. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  bool FinishAlignment(FString& Problem);

  /** Discards the touched points. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  void CancelAlignment();

  /** Returns the root mean square distance between touched and known points after the last alignment [cm]. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  float GetResidual() const;

  /** Returns the largest of these distances [cm]. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  float GetWorst() const;

  /** Stores the pose on this computer. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  bool SaveCalibration();

  /** Applies the stored pose. Returns false if there is none. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  bool LoadCalibration();

  /** Deletes the stored pose. The component does not move. */
  UFUNCTION(BlueprintCallable, CallInEditor, Category = "Haptics")
  void ForgetCalibration();

  virtual void BeginPlay() override;
  virtual void EndPlay(const EEndPlayReason::Type Reason) override;
  virtual void TickComponent(float DeltaTime, ELevelTick TickType, FActorComponentTickFunction* Tick) override;

 private:
  FTransform GetParent() const;
  FString GetSlot() const;

  TArray<FVector> Points;   ///< points to touch
  TArray<FVector> Touched;  ///< in the frame of the attach parent
  double Residual = 0.0, Worst = 0.0;
};
