#include "Components/PrimitiveComponent.h"
#include "GameFramework/Actor.h"
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

bool HasColliders(const UPrimitiveComponent* Component) {
  const UBodySetup* Setup = Component ? const_cast<UPrimitiveComponent*>(Component)->GetBodySetup() : nullptr;
  if (!Setup) return false;
  const FKAggregateGeom& All = Setup->AggGeom;
  return All.SphereElems.Num() + All.BoxElems.Num() + All.SphylElems.Num() > 0;
}

/// A solid at its place, if that is not the origin.
wire::Piece Piece(wire::Primitive Shape, const FVector& Center, const FRotator& Rotation) {
  const pacinian::Rigid Pose = FHapticSpace::Metres(FTransform(Rotation, Center));
  wire::Placed Made;
  Made.shape = MoveTemp(Shape);
  Made.pose = {{Pose.position.x, Pose.position.y, Pose.position.z},
               {Pose.rotation.x, Pose.rotation.y, Pose.rotation.z, Pose.rotation.w}};
  return Made;
}

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

bool ToWire(const UPrimitiveComponent* Collider, const FVector& Scale, wire::Solid& Made, FString& Problem) {
  if (!HasColliders(Collider)) {
    Problem = TEXT("there is no sphere, box or capsule to collide with on the actor: add one, or set Shape to Mesh");
    return false;
  }
  const FKAggregateGeom& All = const_cast<UPrimitiveComponent*>(Collider)->GetBodySetup()->AggGeom;
  wire::Union Parts;
  for (const FKSphereElem& Given : All.SphereElems) {
    const FKSphereElem Elem = Given.GetFinalScaled(Scale, FTransform::Identity);
    Parts.parts.push_back(Piece(wire::Sphere{Metres * Elem.Radius}, Elem.Center, FRotator::ZeroRotator));
  }
  for (const FKBoxElem& Given : All.BoxElems) {
    const FKBoxElem Elem = Given.GetFinalScaled(Scale, FTransform::Identity);
    const pacinian::Vec3 Size = pacinian::unreal::to_world(pacinian::Vec3{Elem.X, Elem.Y, Elem.Z});
    Parts.parts.push_back(Piece(wire::Box{{Size.x, Size.y, Size.z}}, Elem.Center, Elem.Rotation));
  }
  for (const FKSphylElem& Given : All.SphylElems) {
    const FKSphylElem Elem = Given.GetFinalScaled(Scale, FTransform::Identity);
    const bool bBall = Elem.Length <= 0.0f;
    wire::Primitive Shape = wire::Sphere{Metres * Elem.Radius};
    if (!bBall) Shape = wire::Capsule{Metres * Elem.Radius, Metres * Elem.Length};
    Parts.parts.push_back(Piece(MoveTemp(Shape), Elem.Center, Elem.Rotation));
  }
  if (Parts.parts.size() > wire::MAX_PARTS) {
    Problem = TEXT("it has more than 16 spheres, boxes and capsules: use fewer, or set Shape to Mesh");
    return false;
  }
  if (Parts.parts.size() > 1)
    Made = MoveTemp(Parts);
  else if (auto* Only = std::get_if<wire::Placed>(&Parts.parts.front()))
    Made = MoveTemp(*Only);
  return true;
}

}  // namespace Haptic
