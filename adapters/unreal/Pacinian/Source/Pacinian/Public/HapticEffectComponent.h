#pragma once

#include "Components/SceneComponent.h"
#include "CoreMinimal.h"
#include "HapticTechnique.h"
#include "HapticTouch.h"
#include "HapticTypes.h"

#include "HapticEffectComponent.generated.h"

class UHapticEnvelope;
struct FHapticBody;
struct FHapticFrame;

DECLARE_DYNAMIC_MULTICAST_DELEGATE(FHapticFinished);

/** The common base of all haptic effects: strength, envelope, duration and priority. An effect follows its component. */
UCLASS(Abstract, ClassGroup = (Haptics))
class PACINIAN_API UHapticEffectComponent : public USceneComponent {
  GENERATED_BODY()

 public:
  UHapticEffectComponent();

  /** Name on the server, at most 64 characters. Empty: derived from the names of the actor and the component. Further
   * effects of one name get a number, as in "ball 2". */
  UPROPERTY(EditAnywhere, BlueprintReadOnly, Category = "Haptics")
  FString EffectName;

  /** Whether the effect has a radiation pressure or a force. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics")
  EHapticStrength Strength = EHapticStrength::RadiationPressure;

  /** Pressure on touched skin [Pa]. */
  UPROPERTY(EditAnywhere, BlueprintReadOnly, Category = "Haptics", meta = (ClampMin = "0", UIMax = "20", EditCondition = "Strength == EHapticStrength::RadiationPressure", EditConditionHides))
  float RadiationPressure = 8.0f;

  /** Force of the whole effect [N]. */
  UPROPERTY(EditAnywhere, BlueprintReadOnly, Category = "Haptics", meta = (ClampMin = "0", ClampMax = "1000", EditCondition = "Strength == EHapticStrength::Force", EditConditionHides))
  float Force = 0.005f;

  /** Strength over time. None: constant. */
  UPROPERTY(EditAnywhere, BlueprintReadOnly, Category = "Haptics")
  TObjectPtr<UHapticEnvelope> Envelope;

  /** How the samples are presented in time. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics")
  FHapticTechnique Technique;

  /** The effect ends after this time [s]. 0: it plays until Stop. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", meta = (ClampMin = "0", Units = "s"))
  float Duration = 0.0f;

  /** Effects with a higher priority come first if the array cannot render all. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", meta = (ClampMin = "-1000000", ClampMax = "1000000"))
  int32 Priority = 0;

  /** Pressure per metre of depth [Pa/m]. 0: full pressure at a depth of 2 mm. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", AdvancedDisplay, meta = (ClampMin = "0"))
  float Stiffness = 0.0f;

  /** Distance outside the shape from which it is felt [cm]. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", AdvancedDisplay, meta = (ClampMin = "0", ClampMax = "1000", Units = "cm"))
  float Reach = 0.0f;

  /** Sends the motion, so that the effect is felt where it will be instead of where it was. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", AdvancedDisplay)
  bool bPredictMotion = true;

  /** The duration is over. */
  UPROPERTY(BlueprintAssignable, Category = "Haptics")
  FHapticFinished OnFinished;

  /** A hand begins to feel the effect. */
  UPROPERTY(BlueprintAssignable, Category = "Haptics")
  FHapticTouched OnTouchBegan;

  /** A hand no longer feels the effect. The argument is the last report of the touch. */
  UPROPERTY(BlueprintAssignable, Category = "Haptics")
  FHapticTouched OnTouchEnded;

  /** Starts the effect, or restarts it. Activate does the same. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  void Play();

  /** Stops the effect: it is no longer felt. Deactivate does the same. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  void Stop();

  UFUNCTION(BlueprintPure, Category = "Haptics")
  bool IsPlaying() const;

  /** Returns why the effect cannot be felt, and what to do; empty if it can. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  FString GetProblem() const;

  /** Returns the largest radiation pressure emitted for the effect, as the server reports it [Pa]; 0 if there is none. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  float GetEmitted() const;

  /** Returns the achieved and the requested pressure of the effect, as the server reports them; unknown for a point. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  FHapticRegionFelt GetRegionFelt() const;

  UFUNCTION(BlueprintCallable, Category = "Haptics")
  void SetRadiationPressure(float Pressure);

  UFUNCTION(BlueprintCallable, Category = "Haptics")
  void SetForce(float NewForce);

  /** Sets the radiation pressure relative to the full pressure in Project Settings, Plugins, Pacinian: 0 to 1. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  void SetRelativeStrength(float Share);

  UFUNCTION(BlueprintPure, Category = "Haptics")
  float GetRelativeStrength() const;

  UFUNCTION(BlueprintCallable, Category = "Haptics")
  void SetEnvelope(UHapticEnvelope* NewEnvelope);

  /** Sends the effect again. Call it after changing other properties, or the shape. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  void Refresh();

  virtual void BeginPlay() override;
  virtual void EndPlay(const EEndPlayReason::Type Reason) override;
  virtual void Activate(bool bReset = false) override;
  virtual void Deactivate() override;
#if WITH_EDITOR
  virtual void PostEditChangeProperty(FPropertyChangedEvent& Event) override;
#endif

  /** Gets the outline of the effect in its true size, as pairs of positions in the level, even if it does not play.
   * Returns false and the problem if it has no shape. */
  bool GetOutline(TArray<FVector>& Lines, FString& Problem) const;

  /** Returns whether the effect has this name on the server. */
  bool IsCalled(const FString& Wanted) const;

  /** Sends what has changed. The server component calls it each frame. */
  void Send(const FHapticFrame& Frame);

  /** Handles an object that the server rejected, together with the rest of its message. That object is not sent
   * again until it changes. All others are sent again. Path: of the wrong field; "$.objects" if there are too many: then
   * it concerns what was sent in the last second. The server component calls it. */
  void Refuse(const FString& Path, const FString& Message);

 protected:
  /** Writes the shape as the wire's object. Returns false and the problem if there is none. */
  virtual bool Describe(FHapticBody&, FString&) const PURE_VIRTUAL(UHapticEffectComponent::Describe, return false;);

  /** Returns all values on which the shape depends, except for its scale: the bits of numbers, and objects' addresses. */
  virtual TArray<uint64> GetShapeValues() const { return {}; }

  /** Returns the component that the shape belongs to and moves with. */
  virtual const USceneComponent* GetShapeOwner() const { return this; }

  /** Returns the shape's transform in the level. */
  virtual FTransform GetShapeTransform() const { return GetShapeOwner()->GetComponentTransform(); }

 private:
  bool Put(const FHapticFrame& Frame);
  void Remove();
  FString MakeName() const;

  TSharedPtr<FHapticBody> Sent;
  FString Complaint;        ///< why the effect cannot be felt
  double Began = 0.0;       ///< by the world's real time [s]
  double PutTime = 0.0;     ///< when it was last sent, by the same time [s]
  uint32 Session = 0;       ///< in which the shape was last sent; 0: it must be sent
  bool bShown = false;      ///< the server has the effect
  bool bReshaped = false;   ///< the shape has changed since
  bool bEnveloped = false;  ///< the envelope has changed since
  bool bMoving = false;     ///< whether the last sent motion was not zero
};
