#pragma once

#include "Core.h"

class AActor;
class UPrimitiveComponent;
class USceneComponent;
class UStaticMesh;
class UStaticMeshComponent;

namespace Haptic {

/** The static mesh component that one is attached to, or else the actor's first that has a mesh; or null. */
const UStaticMeshComponent* MeshNear(const USceneComponent& Component);

/** The component with simple collision that one is attached to, or else the actor's first; or null. */
const UPrimitiveComponent* ColliderNear(const USceneComponent& Component);

/** A mesh in metres and the world's axes. False, with the problem. */
bool ToWire(const UStaticMesh* Mesh, const FVector& Scale, pacinian::wire::Mesh& Made, FString& Problem);

/** The spheres, boxes and capsules of a component's simple collision, and of all that are attached below it, in its frame.
 * Those below another haptic volume are that one's. False, with the problem. */
bool ToWire(const UPrimitiveComponent* Collider, pacinian::wire::Solid& Made, FString& Problem);

/** A number that is another if one of these is another; not if the whole moves. */
uint64 Fingerprint(const UPrimitiveComponent* Collider);

}  // namespace Haptic
