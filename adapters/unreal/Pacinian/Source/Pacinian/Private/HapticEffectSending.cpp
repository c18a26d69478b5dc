#include "Engine/World.h"
#include "Envelopes.h"
#include "HapticEffectComponent.h"
#include "HapticLink.h"
#include "HapticScene.h"
#include "HapticServerComponent.h"
#include "Motion.h"

namespace wire = pacinian::wire;

void UHapticEffectComponent::Remove() {
  const UHapticScene* Scene = UHapticScene::Of(this);
  const UHapticServerComponent* Server = Scene ? Scene->GetServer() : nullptr;
  const TSharedPtr<FHapticLink> Link = Server ? Server->GetLink() : nullptr;
  if (bShown && Link && Session == Link->Session) Link->Client.remove(Sent->Name);
  bShown = false;
  Session = 0;
}

void UHapticEffectComponent::Send(const FHapticFrame& Frame) {
  if (!IsPlaying() || !Sent) return;
  if (Duration > 0.0f && GetWorld()->GetRealTimeSeconds() - Began >= Duration) {
    Deactivate();
    OnFinished.Broadcast();
    return;
  }
  const FTransform Place = GetShapeTransform();
  const bool bScaled = !Place.GetScale3D().Equals(Sent->Scale, 1e-4);
  const pacinian::Rigid Before = Sent->Pose, Now = Frame.Space.Into(Place);
  TArray<uint64> Values = GetShapeValues();
  if (Session != Frame.Session || bReshaped || bScaled || Values != Sent->Values) {
    Sent->Pose = Now;
    Sent->Scale = Place.GetScale3D();
    Sent->Values = MoveTemp(Values);
    bReshaped = bEnveloped = bMoving = false;
    bShown = Put(Frame);
    Session = Frame.Session;
    return;
  }
  if (!bShown) return;
  if (bEnveloped) Frame.Client.envelope(Sent->Name, Haptic::ToWire(Envelope));
  bEnveloped = false;
  const bool bMoves = Haptic::Moved(Before, Now);
  if (!bMoves && !bMoving) return;
  Sent->Pose = Now;  // otherwise the last one that was sent, so that a slow movement adds up
  const wire::Motion Motion = Haptic::MotionOf(Before, Now, Frame.Elapsed);
  bMoving = bMoves && bPredictMotion;
  Frame.Client.move(Sent->Name, Haptic::ToWire(Sent->Pose), bMoving ? &Motion : nullptr);
}

void UHapticEffectComponent::Refuse(const FString& Path, const FString& Message) {
  constexpr double Recent = 1.0;  // [s]
  const FString All(TEXT("$.objects"));
  if (!Sent || !Path.StartsWith(All, ESearchCase::CaseSensitive)) return;
  const bool bAll = Path == All;
  const bool bOwn = Path.StartsWith(All + TEXT("[") + Haptic::Text(Sent->Name) + TEXT("]"), ESearchCase::CaseSensitive);
  if (!bOwn && !(bAll && bShown && GetWorld()->GetRealTimeSeconds() - PutTime < Recent)) {
    bReshaped = bReshaped || (bShown && !bAll);  // one that was refused before stays away
    return;
  }
  const uint32 Known = Session;
  Remove();
  Session = Known;
  Complaint = Message;
}

bool UHapticEffectComponent::Put(const FHapticFrame& Frame) {
  FString Problem;
  const bool bDescribed = Describe(*Sent, Problem);
  if (!bDescribed && Problem != Complaint)
    UE_LOG(LogPacinian, Warning, TEXT("%s cannot be felt: %s"), *GetName(), *Problem);
  Complaint = Problem;
  if (!bDescribed) {
    Remove();
    return false;
  }
  wire::HapticObject& Felt = Haptic::Placed(Sent->Object, Haptic::ToWire(Sent->Pose));
  if (Strength == EHapticStrength::Force)
    Felt.force = FMath::Clamp(Force, 0.0f, 1000.0f);
  else
    Felt.radiation_pressure = FMath::Clamp(RadiationPressure, 0.0f, 1e6f);
  Felt.envelope = Haptic::ToWire(Envelope);
  Felt.technique = Haptic::ToWire(Technique);
  Felt.priority = FMath::Clamp(Priority, -1000000, 1000000);
  Felt.material.reach = FMath::Clamp(0.01 * Reach, 0.0, 10.0);
  if (Stiffness > 0.0f) Felt.material.stiffness = Stiffness;
  if (Duration > 0.0f) Felt.duration = FMath::Max(1e-3, Duration - (GetWorld()->GetRealTimeSeconds() - Began));
  PutTime = GetWorld()->GetRealTimeSeconds();
  if (Frame.Client.put(Sent->Name, MoveTemp(Sent->Object))) return true;
  Remove();
  return false;
}
