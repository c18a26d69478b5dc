#pragma once

#include "CoreIncludes.h"

class AActor;
class UPrimitiveComponent;
class USceneComponent;
class UStaticMesh;
class UStaticMeshComponent;

namespace Haptic {

/** Returns the static mesh component that this one is attached to, otherwise the actor's first with a mesh; or null. */
const UStaticMeshComponent* MeshNear(const USceneComponent& Component);

/** Returns the component with simple collision that this one is attached to, otherwise the actor's first; or null. */
const UPrimitiveComponent* ColliderNear(const USceneComponent& Component);

/** Converts a mesh to metres and the world's axes. Returns false and the problem on failure. */
bool ToWire(const UStaticMesh* Mesh, const FVector& Scale, pacinian::wire::Mesh& Made, FString& Problem);

/** Converts the spheres, boxes and capsules of the simple collision of a component, and of all components attached
 * below it, in its frame. Skips those of another haptic volume. Returns false and the problem on failure. */
bool ToWire(const UPrimitiveComponent* Collider, pacinian::wire::Solid& Made, FString& Problem);

/** Returns all values of these colliders, as GetShapeValues does. They do not change if the whole moves. */
TArray<uint64> ValuesOf(const UPrimitiveComponent* Collider);

}  // namespace Haptic
