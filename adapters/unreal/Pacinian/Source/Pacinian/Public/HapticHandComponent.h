#pragma once

#include "Components/ActorComponent.h"
#include "CoreMinimal.h"
#include "HapticTypes.h"

#include "HapticHandComponent.generated.h"

class APlayerController;
struct FHapticSpace;
struct FHapticHand;

/** The source of a hand's joints. */
UENUM(BlueprintType)
enum class EHapticHandSource : uint8 {
  /** The headset's hand tracking. */
  Tracker,
  /** The game calls Set Joints. */
  Game,
  /** An open hand: its palm is at the actor and faces down, its fingers point along X. */
  Open,
  /** For tests: an open hand that the mouse moves. It is there while the left button is down. Shows the cursor. */
  Mouse,
};

/** A hand of 26 joints in OpenXR's order. As soon as a level has such a component, objects are felt only where hands
 * touch them. In a level without hands, whole objects are emitted. At most 8 hands count. Touches name a hand by its
 * side, and further hands of that side "right 2", "right 3"... */
UCLASS(ClassGroup = (Haptics), meta = (BlueprintSpawnableComponent, DisplayName = "Haptic Hand"))
class PACINIAN_API UHapticHandComponent : public UActorComponent {
  GENERATED_BODY()

 public:
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics")
  EHapticSide Side = EHapticSide::Right;

  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics")
  EHapticHandSource Source = EHapticHandSource::Tracker;

  /** Source Mouse: how far the hand is from the actor when the mouse is at the window's edge [cm]. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", meta = (ClampMin = "0", Units = "cm"))
  float MouseReach = 15.0f;

  /** Sends the motion, so that the hand feels where it will be instead of where it was. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", AdvancedDisplay)
  bool bPredictMotion = true;

  /** Sets the positions of the 26 joints in the level [cm], in OpenXR's order: palm, wrist, thumb from its metacarpal on, index... */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  void SetJoints(const TArray<FVector>& Positions);

  /** Sets the radii of the 26 joints [cm]. Empty: an adult's. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  void SetRadii(const TArray<float>& NewRadii);

  /** Sets the hand from Ultraleap's data, in the level [cm], instead of Set Joints and Set Radii. Bones: both ends
   * (prev and next joint) of the metacarpal, proximal, intermediate and distal bone of each digit, from the thumb
   * on: 40 positions. Widths: of the 20 bones. Wrist: the arm's next joint. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  void SetLeap(const TArray<FVector>& Bones, const TArray<float>& Widths, const FVector& Wrist);

  /** Reports that the tracker has lost the hand. It then feels nothing. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  void SetLost();

  /** Returns whether the joints are known. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  bool IsTracked() const;

  virtual void BeginPlay() override;
  virtual void EndPlay(const EEndPlayReason::Type Reason) override;

  /** Writes the present joints. The server component calls it each frame. */
  void Fill(FHapticHand& Hand, const FHapticSpace& Space);

 private:
  void Track();
  void Open(const FVector& Offset);
  void FollowMouse();
  void ShowCursor(APlayerController* Player);
  void Predict(FHapticHand& Hand);
  void ChooseName();

  TArray<FVector> Joints;
  TArray<float> Radii;
  FVector Middle = FVector::ZeroVector;  ///< mean joint as last sent, in the array's frame [m]
  double Time = -1.0;                    ///< real time of that [s]; negative: never
  TWeakObjectPtr<APlayerController> CursorPlayer;  ///< whose cursor this hand has shown
  FString SentName;                      ///< on the server; empty until it is first sent
};
