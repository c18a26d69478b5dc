#include <cstring>

#include "Components/PrimitiveComponent.h"
#include "GameFramework/Actor.h"
#include "HapticVolumeComponent.h"
#include "PhysicsEngine/BodySetup.h"
#include "Shapes.h"
#include "Space.h"

THIRD_PARTY_INCLUDES_START
#include "pacinian/wire/protocol.h"
THIRD_PARTY_INCLUDES_END

namespace wire = pacinian::wire;

namespace Haptic {

namespace {

constexpr double Metres = pacinian::unreal::metres;

using FColliders = TInlineComponentArray<const UPrimitiveComponent*>;  // on the stack: it is made in each frame

bool HasColliders(const UPrimitiveComponent* Component) {
  const UBodySetup* Setup = Component ? const_cast<UPrimitiveComponent*>(Component)->GetBodySetup() : nullptr;
  if (!Setup) return false;
  const FKAggregateGeom& All = Setup->AggGeom;
  return All.SphereElems.Num() + All.BoxElems.Num() + All.SphylElems.Num() > 0;
}

/// Returns a solid with its pose in a frame.
wire::Piece Piece(wire::Primitive Shape, const pacinian::Rigid& Frame, const FVector& Center, const FRotator& Rotation) {
  const pacinian::Rigid Pose = Frame * FHapticSpace::Metres(FTransform(Rotation, Center));
  wire::Placed Made;
  Made.shape = MoveTemp(Shape);
  Made.pose = {{Pose.position.x, Pose.position.y, Pose.position.z},
               {Pose.rotation.x, Pose.rotation.y, Pose.rotation.z, Pose.rotation.w}};
  return Made;
}

/// Returns whether a haptic volume is attached to a component; then that volume has the component's colliders.
bool IsTaken(const USceneComponent& Component) {
  for (const TObjectPtr<USceneComponent>& Below : Component.GetAttachChildren())
    if (Cast<UHapticVolumeComponent>(Below.Get())) return true;
  return false;
}

/// Collects a component, if it has colliders, and all components below it.
void Gather(const USceneComponent& Component, FColliders& Found) {
  if (const auto* Own = Cast<UPrimitiveComponent>(&Component); HasColliders(Own)) Found.Add(Own);
  for (const TObjectPtr<USceneComponent>& Below : Component.GetAttachChildren())
    if (Below && !IsTaken(*Below)) Gather(*Below, Found);
}

/// Adds the elements of one component. Frame: the component's frame in that of the whole.
void Append(const UPrimitiveComponent& Component, const pacinian::Rigid& Frame, wire::Union& Parts) {
  const FKAggregateGeom& All = const_cast<UPrimitiveComponent&>(Component).GetBodySetup()->AggGeom;
  const FVector Scale = Component.GetComponentScale();
  for (const FKSphereElem& Given : All.SphereElems) {
    const FKSphereElem Elem = Given.GetFinalScaled(Scale, FTransform::Identity);
    Parts.parts.push_back(Piece(wire::Sphere{Metres * Elem.Radius}, Frame, Elem.Center, FRotator::ZeroRotator));
  }
  for (const FKBoxElem& Given : All.BoxElems) {
    const FKBoxElem Elem = Given.GetFinalScaled(Scale, FTransform::Identity);
    const pacinian::Vec3 Size = pacinian::unreal::to_world(pacinian::Vec3{Elem.X, Elem.Y, Elem.Z});
    Parts.parts.push_back(Piece(wire::Box{{Size.x, Size.y, Size.z}}, Frame, Elem.Center, Elem.Rotation));
  }
  for (const FKSphylElem& Given : All.SphylElems) {
    const FKSphylElem Elem = Given.GetFinalScaled(Scale, FTransform::Identity);
    const bool bBall = Elem.Length <= 0.0f;
    wire::Primitive Shape = wire::Sphere{Metres * Elem.Radius};
    if (!bBall) Shape = wire::Capsule{Metres * Elem.Radius, Metres * Elem.Length};
    Parts.parts.push_back(Piece(MoveTemp(Shape), Frame, Elem.Center, Elem.Rotation));
  }
}

void AddBits(TArray<uint64>& Values, std::initializer_list<double> Given) {
  for (const double Each : Given) {
    uint64 Bits;
    std::memcpy(&Bits, &Each, sizeof Bits);
    Values.Add(Bits);
  }
}

void AddBits(TArray<uint64>& Values, const FVector& Given) { AddBits(Values, {Given.X, Given.Y, Given.Z}); }

void AddBits(TArray<uint64>& Values, const FRotator& Given) { AddBits(Values, {Given.Pitch, Given.Yaw, Given.Roll}); }

}  // namespace

const UPrimitiveComponent* ColliderNear(const USceneComponent& Component) {
  for (const USceneComponent* Above = Component.GetAttachParent(); Above; Above = Above->GetAttachParent())
    if (const auto* Found = Cast<UPrimitiveComponent>(Above); HasColliders(Found)) return Found;
  TInlineComponentArray<UPrimitiveComponent*> All;
  if (Component.GetOwner()) Component.GetOwner()->GetComponents(All);
  for (const UPrimitiveComponent* Found : All)
    if (HasColliders(Found)) return Found;
  return nullptr;
}

bool ToWire(const UPrimitiveComponent* Collider, wire::Solid& Made, FString& Problem) {
  if (!HasColliders(Collider)) {
    Problem = TEXT("there is no sphere, box or capsule to collide with on the actor: add one, or set Shape to Mesh");
    return false;
  }
  FColliders Found;
  Gather(*Collider, Found);
  const pacinian::Rigid Whole = pacinian::inverse(FHapticSpace::Metres(Collider->GetComponentTransform()));
  wire::Union Parts;
  for (const UPrimitiveComponent* Each : Found)
    Append(*Each, Each == Collider ? pacinian::Rigid() : Whole * FHapticSpace::Metres(Each->GetComponentTransform()), Parts);
  if (Parts.parts.size() > wire::MAX_PARTS) {
    Problem = TEXT("it has more than 16 spheres, boxes and capsules, with those attached to it: use fewer, or set Shape to Mesh");
    return false;
  }
  if (Parts.parts.size() > 1)
    Made = MoveTemp(Parts);
  else if (auto* Only = std::get_if<wire::Placed>(&Parts.parts.front()))
    Made = MoveTemp(*Only);
  return true;
}

TArray<uint64> ValuesOf(const UPrimitiveComponent* Collider) {
  FColliders Found;
  if (Collider) Gather(*Collider, Found);
  TArray<uint64> Values;
  for (const UPrimitiveComponent* Each : Found) {
    const FKAggregateGeom& All = const_cast<UPrimitiveComponent*>(Each)->GetBodySetup()->AggGeom;
    Values.Add(reinterpret_cast<uint64>(Each));
    for (const int32 Count : {All.SphereElems.Num(), All.BoxElems.Num(), All.SphylElems.Num()}) Values.Add(Count);
    for (const FKSphereElem& Elem : All.SphereElems) AddBits(Values, Elem.Center), AddBits(Values, {Elem.Radius});
    for (const FKBoxElem& Elem : All.BoxElems)
      AddBits(Values, Elem.Center), AddBits(Values, Elem.Rotation), AddBits(Values, {Elem.X, Elem.Y, Elem.Z});
    for (const FKSphylElem& Elem : All.SphylElems)
      AddBits(Values, Elem.Center), AddBits(Values, Elem.Rotation), AddBits(Values, {Elem.Radius, Elem.Length});
    FTransform Inside;
    for (const USceneComponent* At = Each; At && At != Collider; At = At->GetAttachParent())
      Inside = Inside * At->GetRelativeTransform();
    const FQuat Turn = Inside.GetRotation();
    AddBits(Values, Inside.GetLocation()), AddBits(Values, {Turn.X, Turn.Y, Turn.Z, Turn.W});
    AddBits(Values, Inside.GetScale3D());
  }
  return Values;
}

}  // namespace Haptic
