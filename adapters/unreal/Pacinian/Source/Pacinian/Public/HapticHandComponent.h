#pragma once

#include "Components/ActorComponent.h"
#include "CoreMinimal.h"
#include "HapticTypes.h"

#include "HapticHandComponent.generated.h"

struct FHapticSpace;
struct FHapticHand;

/** Where a hand comes from. */
UENUM(BlueprintType)
enum class EHapticHandSource : uint8 {
  /** The headset's hand tracking. */
  Tracker,
  /** The game calls Set Joints. */
  Game,
  /** An open hand: its palm is where the actor is and faces down, its fingers point along X. */
  Open,
};

/**
 * A hand that feels the scene: 26 joints in OpenXR's order. Where a level has such components the scene is felt by hands
 * only; without any, objects are emitted whole.
 */
UCLASS(ClassGroup = (Haptics), meta = (BlueprintSpawnableComponent, DisplayName = "Haptic Hand"))
class PACINIAN_API UHapticHandComponent : public UActorComponent {
  GENERATED_BODY()

 public:
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics")
  EHapticSide Side = EHapticSide::Right;

  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics")
  EHapticHandSource Source = EHapticHandSource::Tracker;

  /** Tells the server how it moves, so that it feels where it will be, not where it was. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", AdvancedDisplay)
  bool bPredictMotion = true;

  /** Where the 26 joints are, in the level [cm], in OpenXR's order: palm, wrist, thumb from the wrist on, index... */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  void SetJoints(const TArray<FVector>& Positions);

  /** How thick the 26 joints are [cm]. Empty: an adult's. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  void SetRadii(const TArray<float>& NewRadii);

  /** In place of Set Joints and Set Radii: a hand as Ultraleap tells it, in the level [cm]. Bones: both ends (prev and next
   * joint) of the metacarpal, proximal, intermediate and distal bone of the five digits from the thumb on: 40. Widths: of the
   * 20 bones. Wrist: the arm's next joint. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  void SetLeap(const TArray<FVector>& Bones, const TArray<float>& Widths, const FVector& Wrist);

  /** The tracker has lost the hand: it feels nothing. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  void SetLost();

  /** Whether its joints are known. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  bool IsTracked() const;

  virtual void BeginPlay() override;
  virtual void EndPlay(const EEndPlayReason::Type Reason) override;

  /** Its joints as of now. Called by the server component in each frame. */
  void Fill(FHapticHand& Hand, const FHapticSpace& Space);

 private:
  void Track();
  void Predict(FHapticHand& Hand);

  TArray<FVector> Joints;
  TArray<float> Radii;
  FVector Middle = FVector::ZeroVector;  ///< of the joints when they were told, in the array's frame [m]
  double Time = -1.0;                    ///< of that, of the world [s]; negative: never
};
