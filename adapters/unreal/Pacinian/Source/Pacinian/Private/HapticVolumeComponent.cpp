#include "HapticVolumeComponent.h"

#include "Components/StaticMeshComponent.h"
#include "HapticLink.h"
#include "Shapes.h"

namespace wire = pacinian::wire;

const USceneComponent* UHapticVolumeComponent::GetShapeOwner() const {
  const USceneComponent* Found = nullptr;
  if (Shape == EHapticVolume::Colliders)
    Found = Haptic::ColliderNear(*this);
  else if (!Mesh)
    Found = Haptic::MeshNear(*this);
  return Found ? Found : this;
}

TArray<uint64> UHapticVolumeComponent::GetShapeValues() const {
  if (Shape == EHapticVolume::Colliders) return Haptic::ValuesOf(Haptic::ColliderNear(*this));
  return {reinterpret_cast<uint64>(GetMesh())};
}

const UStaticMesh* UHapticVolumeComponent::GetMesh() const {
  const UStaticMeshComponent* Found = Mesh ? nullptr : Haptic::MeshNear(*this);
  return Found ? Found->GetStaticMesh() : Mesh.Get();
}

bool UHapticVolumeComponent::Describe(FHapticBody& Body, FString& Problem) const {
  constexpr double SmallestScale = 1e-6;
  if (Body.Scale.GetAbsMin() < SmallestScale) {
    Problem = TEXT("its scale is 0 along an axis, so it has no inside: give it another scale");
    return false;
  }
  wire::Volume Volume;
  Volume.thickness = FMath::Clamp(0.01 * Thickness, 1e-4, 10.0);
  Volume.felt = Felt == EHapticFelt::Interior ? wire::VolumeFelt::interior : wire::VolumeFelt::shell;
  if (Shape == EHapticVolume::Colliders) {
    if (!Haptic::ToWire(Haptic::ColliderNear(*this), Volume.shape, Problem)) return false;
  } else {
    wire::Mesh Made;
    if (!Haptic::ToWire(GetMesh(), Body.Scale, Made, Problem)) return false;
    Volume.shape = MoveTemp(Made);
  }
  Body.Object = MoveTemp(Volume);
  return true;
}
