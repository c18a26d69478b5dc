#pragma once

#include "Components/SceneComponent.h"
#include "CoreMinimal.h"

#include "ArrayOriginComponent.generated.h"

/**
 * Where the array stands in the tracked world: its middle, its normal along the component's Z.
 *
 * In VR attach it to what the player moves with, as the pawn's VR origin: the array stays in the room when the player
 * teleports. Its pose there is found by touching known points of the array, and kept between sessions.
 */
UCLASS(ClassGroup = (Haptics), meta = (BlueprintSpawnableComponent, DisplayName = "Array Origin"))
class PACINIAN_API UArrayOriginComponent : public USceneComponent {
  GENERATED_BODY()

 public:
  UArrayOriginComponent();

  /** Points to touch, in the component's own frame [cm], 3 or more, not in a line. Empty: the array's corners. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics")
  TArray<FVector> KnownPoints;

  /** By which the alignment is kept on this computer. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics")
  FString CalibrationName = TEXT("default");

  /** Takes over what was kept when play begins. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics")
  bool bLoadOnStart = true;

  /** Draws the array's axes and transducers while the game runs; not in shipping builds. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics")
  bool bDrawArray = true;

  /** Forgets what was touched, and begins anew. False: the points are not known, as no server is connected. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  bool BeginAlignment();

  /** The point of the array to be touched next, in the component's own frame [cm]. False: all have been. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  bool GetNextPoint(FVector& Point) const;

  /** The next point was touched there, in the level [cm]. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  void TouchPoint(const FVector& Position);

  /** How many points have been touched. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  int32 GetTouched() const;

  /** Moves the component to where the array is. False, with the problem: fewer than 3 points, or all in a line. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  bool FinishAlignment(FString& Problem);

  /** Forgets what was touched. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  void CancelAlignment();

  /** Root mean square distance of touched from known points after the last alignment [cm]. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  float GetResidual() const;

  /** The largest of these distances [cm]. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  float GetWorst() const;

  /** Keeps the pose on this computer. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  bool SaveCalibration();

  /** Takes over the pose that was kept. False: there is none. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  bool LoadCalibration();

  /** Removes what was kept; the pose stays. */
  UFUNCTION(BlueprintCallable, CallInEditor, Category = "Haptics")
  void ForgetCalibration();

  virtual void BeginPlay() override;
  virtual void EndPlay(const EEndPlayReason::Type Reason) override;
  virtual void TickComponent(float DeltaTime, ELevelTick TickType, FActorComponentTickFunction* Tick) override;

 private:
  FTransform GetParent() const;
  FString GetSlot() const;

  TArray<FVector> Points;   ///< to touch
  TArray<FVector> Touched;  ///< in the frame of what this is attached to
  double Residual = 0.0, Worst = 0.0;
};
