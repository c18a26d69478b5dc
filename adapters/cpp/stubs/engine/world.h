#pragma once

// Stubs of a level that plays: actors, components, subsystems and ticks.

#include "object.h"

namespace EEndPlayReason {
enum Type { Destroyed, LevelTransition, EndPlayInEditor, RemovedFromWorld, Quit };
}
enum ELevelTick { LEVELTICK_All };
enum ETickingGroup { TG_PrePhysics, TG_PostUpdateWork };
enum ENetMode { NM_Standalone, NM_DedicatedServer };
struct FActorComponentTickFunction {
  bool bCanEverTick = false, bTickEvenWhenPaused = false;
  ETickingGroup TickGroup = TG_PrePhysics;
};

class AActor;
class APlayerController;

class UActorComponent : public UObject {
  STUB_BODY(UActorComponent, UObject)
  virtual void BeginPlay() { bBegun = true; }
  virtual void EndPlay(const EEndPlayReason::Type) { bBegun = false; }
  virtual void TickComponent(float, ELevelTick, FActorComponentTickFunction*) {}
  virtual void Activate(bool = false) { bActive = true; }
  virtual void Deactivate() { bActive = false; }
  bool IsActive() const { return bActive; }
  bool HasBegunPlay() const { return bBegun; }
  AActor* GetOwner() const;
  ENetMode GetNetMode() const { return StubNetMode; }
  void SetComponentTickEnabled(bool bEnabled) { PrimaryComponentTick.bCanEverTick = bEnabled; }

  static inline ENetMode StubNetMode = NM_Standalone;
  FActorComponentTickFunction PrimaryComponentTick;
  bool bAutoActivate = false;

 private:
  bool bActive = false, bBegun = false;
};

class USceneComponent : public UActorComponent {
  STUB_BODY(USceneComponent, UActorComponent)
  USceneComponent* GetAttachParent() const { return above_; }
  const TArray<TObjectPtr<USceneComponent>>& GetAttachChildren() const { return below_; }
  void SetupAttachment(USceneComponent* To) {
    above_ = To;
    To->below_.Add(this);
  }
  const FTransform& GetRelativeTransform() const { return relative_; }
  FTransform GetComponentTransform() const { return above_ ? relative_ * above_->GetComponentTransform() : relative_; }
  FVector GetComponentLocation() const { return GetComponentTransform().GetLocation(); }
  FVector GetComponentScale() const { return GetComponentTransform().GetScale3D(); }
  FRotator GetComponentRotation() const { return {}; }
  void SetRelativeTransform(const FTransform& Given) { relative_ = Given; }
  void SetWorldLocationAndRotation(const FVector& Place, const FQuat& Turn) {
    const FTransform Given(Turn, Place, GetComponentScale());
    relative_ = above_ ? Given.GetRelativeTransform(above_->GetComponentTransform()) : Given;
  }

 private:
  USceneComponent* above_ = nullptr;
  TArray<TObjectPtr<USceneComponent>> below_;
  FTransform relative_;
};

class AActor : public UObject {
  STUB_BODY(AActor, UObject)
  ~AActor() override;
  template <class T>
  T* CreateDefaultSubobject(const TCHAR* Given) {
    T* Made = NewObject<T>(this);
    Made->Name = Given;
    Components.push_back(Made);
    return Made;
  }
  void SetRootComponent(USceneComponent* Given) { root_ = Given; }
  USceneComponent* GetRootComponent() const { return root_; }
  template <class T>
  void GetComponents(TArray<T*>& Found) const {
    for (UActorComponent* Each : Components)
      if (T* Is = Cast<T>(Each)) Found.Add(Is);
  }
  std::vector<UActorComponent*> Components;

 private:
  USceneComponent* root_ = nullptr;
};

inline AActor* UActorComponent::GetOwner() const { return Cast<AActor>(Outer); }

class UWorldSubsystem : public UObject {
  STUB_BODY(UWorldSubsystem, UObject)
};

class UWorld : public UObject {
  STUB_BODY(UWorld, UObject)
  ~UWorld() override;
  UWorld* GetWorld() const override { return const_cast<UWorld*>(this); }
  double GetRealTimeSeconds() const { return time_; }
  APlayerController* GetFirstPlayerController() const { return StubPlayer; }
  template <class T>
  T* GetSubsystem() const {
    for (UObject* Each : subsystems_)
      if (T* Found = Cast<T>(Each)) return Found;
    subsystems_.push_back(NewObject<T>(const_cast<UWorld*>(this)));
    return static_cast<T*>(subsystems_.back());
  }
  /// Adds an actor to the level; call `begin` when it is complete.
  template <class T>
  T* spawn(const TCHAR* Given) {
    T* Made = NewObject<T>(this);
    Made->Name = Given;
    actors_.push_back(Made);
    return Made;
  }
  void begin(AActor* Actor);
  void tick(float DeltaTime);
  void end(EEndPlayReason::Type Reason);
  void destroy(AActor* Actor);

  APlayerController* StubPlayer = nullptr;

 private:
  void end(AActor* Actor, EEndPlayReason::Type Reason);

  double time_ = 0.0;
  mutable std::vector<UObject*> subsystems_;
  std::vector<AActor*> actors_;
};
