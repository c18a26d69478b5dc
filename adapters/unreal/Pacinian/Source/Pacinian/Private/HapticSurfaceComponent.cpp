#include "HapticSurfaceComponent.h"

#include "Components/StaticMeshComponent.h"
#include "HapticLink.h"
#include "Shapes.h"

namespace wire = pacinian::wire;

namespace {

constexpr double Least = 1e-4, Most = 10.0;  // [m]

double Metres(double Centimetres) { return FMath::Clamp(0.01 * FMath::Abs(Centimetres), Least, Most); }

}  // namespace

const USceneComponent* UHapticSurfaceComponent::GetShapeOwner() const {
  if (Shape != EHapticSurface::Mesh || Mesh) return this;
  const USceneComponent* Found = Haptic::MeshNear(*this);
  return Found ? Found : this;
}

TArray<uint64> UHapticSurfaceComponent::GetShapeValues() const {
  if (Shape != EHapticSurface::Mesh) return {};
  return {reinterpret_cast<uint64>(GetMesh())};
}

const UStaticMesh* UHapticSurfaceComponent::GetMesh() const {
  const UStaticMeshComponent* Found = Mesh ? nullptr : Haptic::MeshNear(*this);
  return Found ? Found->GetStaticMesh() : Mesh.Get();
}

FTransform UHapticSurfaceComponent::GetShapeTransform() const {
  FTransform Made = Super::GetShapeTransform();
  const FQuat HalfTurn(1.0, 0.0, 0.0, 0.0);  // about X
  if (Shape != EHapticSurface::Mesh && Made.GetScale3D().Z < 0.0) Made.SetRotation(Made.GetRotation() * HalfTurn);
  return Made;
}

bool UHapticSurfaceComponent::Describe(FHapticBody& Body, FString& Problem) const {
  wire::Surface Surface;
  Surface.thickness = Metres(Thickness);
  const FVector& Scale = Body.Scale;
  switch (Shape) {
    case EHapticSurface::Mesh: {
      wire::Mesh Made;
      if (!Haptic::ToWire(GetMesh(), Scale, Made, Problem)) return false;
      Surface.shape = MoveTemp(Made);
      break;
    }
    case EHapticSurface::Rectangle:  // x and y change places
      Surface.shape = wire::Rectangle{Metres(Size.Y * Scale.Y), Metres(Size.X * Scale.X)};
      break;
    case EHapticSurface::Disc:
      Surface.shape = wire::Disc{Metres(Radius * FMath::Max(FMath::Abs(Scale.X), FMath::Abs(Scale.Y)))};
      break;
  }
  Body.Object = MoveTemp(Surface);
  return true;
}
