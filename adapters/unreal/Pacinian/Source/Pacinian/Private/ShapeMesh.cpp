#include <array>
#include <map>

#include "Components/StaticMeshComponent.h"
#include "Engine/StaticMesh.h"
#include "GameFramework/Actor.h"
#include "Shapes.h"
#include "StaticMeshResources.h"

THIRD_PARTY_INCLUDES_START
#include "pacinian/wire/protocol.h"
THIRD_PARTY_INCLUDES_END

namespace wire = pacinian::wire;

namespace Haptic {

namespace {

void Append(wire::Bytes& To, uint32 Value) {
  for (int Shift = 0; Shift < 32; Shift += 8) To.push_back(static_cast<uint8>(Value >> Shift));
}

/// Merges vertices at the same position: a rendered mesh is split at normals and texture seams, and would not be
/// closed.
bool Weld(const FStaticMeshLODResources& Level, const FVector& Scale, wire::Mesh& Made) {
  const FPositionVertexBuffer& Positions = Level.VertexBuffers.PositionVertexBuffer;
  const FIndexArrayView Indices = Level.IndexBuffer.GetArrayView();
  std::map<std::array<float, 3>, uint32> Known;  // a TMap would keep 0 and -0 apart
  TArray<uint32> Welded;
  Made = {};
  for (uint32 i = 0; i < Positions.GetNumVertices(); ++i) {
    const FVector3f Place = Positions.VertexPosition(i);
    const auto Found = Known.emplace(std::array<float, 3>{Place.X, Place.Y, Place.Z}, static_cast<uint32>(Known.size()));
    Welded.Add(Found.first->second);
    if (!Found.second) continue;
    const pacinian::Vec3 At = pacinian::unreal::to_world(Vec(FVector(Place) * Scale));
    for (const double Value : {At.x, At.y, At.z}) wire::append(Made.vertices, static_cast<float>(Value));
  }
  // The winding order seen from outside is the same in both frames; a mirrored scale reverses it.
  const bool bMirrored = Scale.X * Scale.Y * Scale.Z < 0.0;
  for (int32 i = 0; i + 2 < Indices.Num(); i += 3) {
    const uint32 A = Welded[Indices[i]], B = Welded[Indices[i + 1]], C = Welded[Indices[i + 2]];
    if (A == B || B == C || C == A) continue;
    for (const uint32 Corner : {A, bMirrored ? C : B, bMirrored ? B : C}) Append(Made.faces, Corner);
  }
  const std::size_t Faces = Made.faces.size() / 12;
  return Known.size() <= static_cast<std::size_t>(wire::MAX_VERTICES) && Faces > 0 && Faces <= static_cast<std::size_t>(wire::MAX_FACES);
}

}  // namespace

const UStaticMeshComponent* MeshNear(const USceneComponent& Component) {
  for (const USceneComponent* Above = Component.GetAttachParent(); Above; Above = Above->GetAttachParent())
    if (const auto* Found = Cast<UStaticMeshComponent>(Above); Found && Found->GetStaticMesh()) return Found;
  TInlineComponentArray<UStaticMeshComponent*> All;
  if (Component.GetOwner()) Component.GetOwner()->GetComponents(All);
  for (const UStaticMeshComponent* Found : All)
    if (Found->GetStaticMesh()) return Found;
  return nullptr;
}

bool ToWire(const UStaticMesh* Mesh, const FVector& Scale, wire::Mesh& Made, FString& Problem) {
  const FStaticMeshRenderData* Data = Mesh ? Mesh->GetRenderData() : nullptr;
  if (!Data) {
    Problem = TEXT("there is no static mesh beside it: add one to the actor, or choose one");
    return false;
  }
  if (FPlatformProperties::RequiresCookedData() && !Mesh->bAllowCPUAccess) {
    Problem = TEXT("its static mesh cannot be read in a packaged game: tick Allow CPU Access in the mesh");
    return false;
  }
  for (const FStaticMeshLODResources& Level : Data->LODResources)
    if (Weld(Level, Scale, Made)) return true;
  Problem = FString::Printf(TEXT("its static mesh is empty, or has more than %d vertices or triangles: add a coarser level of detail"),
                            int32(wire::MAX_FACES));
  return false;
}

}  // namespace Haptic
