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

/** What all haptic effects have: strength, envelope, duration, priority, and that they follow their component. */
UCLASS(Abstract, ClassGroup = (Haptics))
class PACINIAN_API UHapticEffectComponent : public USceneComponent {
  GENERATED_BODY()

 public:
  UHapticEffectComponent();

  /** By which the server knows it, at most 64 characters. Empty: made of the actor's and the component's name. */
  UPROPERTY(EditAnywhere, BlueprintReadOnly, Category = "Haptics")
  FString EffectName;

  /** Whether it has a radiation pressure or a force. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics")
  EHapticStrength Strength = EHapticStrength::RadiationPressure;

  /** How hard it presses where it is touched [Pa]. */
  UPROPERTY(EditAnywhere, BlueprintReadOnly, Category = "Haptics", meta = (ClampMin = "0", UIMax = "20", EditCondition = "Strength == EHapticStrength::RadiationPressure", EditConditionHides))
  float RadiationPressure = 8.0f;

  /** How hard it presses altogether [N]. */
  UPROPERTY(EditAnywhere, BlueprintReadOnly, Category = "Haptics", meta = (ClampMin = "0", ClampMax = "1000", EditCondition = "Strength == EHapticStrength::Force", EditConditionHides))
  float Force = 0.005f;

  /** How strong it is over time. None: always the same. */
  UPROPERTY(EditAnywhere, BlueprintReadOnly, Category = "Haptics")
  TObjectPtr<UHapticEnvelope> Envelope;

  /** How its samples are presented in time. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics")
  FHapticTechnique Technique;

  /** For how long it can be felt once it plays [s]. 0: until Stop. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", meta = (ClampMin = "0", Units = "s"))
  float Duration = 0.0f;

  /** Higher ones come first where the array cannot do all. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", meta = (ClampMin = "-1000000", ClampMax = "1000000"))
  int32 Priority = 0;

  /** How fast the pressure grows with depth [Pa/m]. 0: all of it is felt 2 mm deep. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", AdvancedDisplay, meta = (ClampMin = "0"))
  float Stiffness = 0.0f;

  /** How far outside of it it is felt already [cm]. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", AdvancedDisplay, meta = (ClampMin = "0", ClampMax = "1000", Units = "cm"))
  float Reach = 0.0f;

  /** Tells the server how it moves, so that it is felt where it will be, not where it was. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", AdvancedDisplay)
  bool bPredictMotion = true;

  /** Its duration is over. */
  UPROPERTY(BlueprintAssignable, Category = "Haptics")
  FHapticFinished OnFinished;

  /** A hand begins to feel it. */
  UPROPERTY(BlueprintAssignable, Category = "Haptics")
  FHapticTouched OnTouchBegan;

  /** A hand feels it no more, as it was told last. */
  UPROPERTY(BlueprintAssignable, Category = "Haptics")
  FHapticTouched OnTouchEnded;

  /** Can be felt from now on, for its duration. Activate does the same. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  void Play();

  /** Cannot be felt any more. Deactivate does the same. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  void Stop();

  UFUNCTION(BlueprintPure, Category = "Haptics")
  bool IsPlaying() const;

  /** Why it cannot be felt, and what to do. Empty if it can. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  FString GetProblem() const;

  /** The largest radiation pressure that is emitted for it now [Pa], as the server says; 0 if none is. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  float GetEmitted() const;

  /** What is felt of it, against what was asked, as the server says; not known of a point. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  FHapticRegionFelt GetRegionFelt() const;

  UFUNCTION(BlueprintCallable, Category = "Haptics")
  void SetRadiationPressure(float Pressure);

  UFUNCTION(BlueprintCallable, Category = "Haptics")
  void SetForce(float NewForce);

  /** The radiation pressure, from 0 to 1: its share of the full one in Project Settings, Plugins, Pacinian. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  void SetRelativeStrength(float Share);

  UFUNCTION(BlueprintPure, Category = "Haptics")
  float GetRelativeStrength() const;

  UFUNCTION(BlueprintCallable, Category = "Haptics")
  void SetEnvelope(UHapticEnvelope* NewEnvelope);

  /** After other properties, or the shape, have been changed. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  void Refresh();

  virtual void BeginPlay() override;
  virtual void EndPlay(const EEndPlayReason::Type Reason) override;
  virtual void Activate(bool bReset = false) override;
  virtual void Deactivate() override;
#if WITH_EDITOR
  virtual void PostEditChangeProperty(FPropertyChangedEvent& Event) override;
#endif

  /** Lines of what is felt, as pairs of places in the level, in true size; also where nothing plays. False, with the problem, if
   * it has no shape. */
  bool GetOutline(TArray<FVector>& Lines, FString& Problem) const;

  /** Whether the server knows it by that name. */
  bool IsCalled(const FString& Wanted) const;

  /** Tells the server of it. Called by the server component in each frame. */
  void Send(const FHapticFrame& Frame);

  /** The server would not take an object, nor what came with it in one message: that one is not told again until it
   * changes, all others are. Path: of the field that is wrong. Called by the server component. */
  void Refuse(const FString& Path, const FString& Message);

 protected:
  /** Its shape, as the server knows it. False, with the problem, if it has none. */
  virtual bool Describe(FHapticBody&, FString&) const PURE_VIRTUAL(UHapticEffectComponent::Describe, return false;);

  /** A number that is another if its shape is, but for its scale. */
  virtual uint64 GetShapeFingerprint() const { return 0; }

  /** What its shape is part of and moves with. */
  virtual const USceneComponent* GetShapeOwner() const { return this; }

 private:
  bool Put(const FHapticFrame& Frame);
  void Remove();

  TSharedPtr<FHapticBody> Sent;
  FString Complaint;        ///< why it cannot be felt
  double Began = 0.0;       ///< of the world's time [s]
  uint32 Session = 0;       ///< for which it was described; 0: it has to be
  bool bShown = false;      ///< the server has it, since then
  bool bReshaped = false;   ///< since then
  bool bEnveloped = false;  ///< its envelope is another since then
  bool bMoving = false;     ///< as the server was told
};
