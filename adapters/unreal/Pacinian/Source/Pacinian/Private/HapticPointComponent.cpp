#include "HapticPointComponent.h"

#include "HapticLink.h"

bool UHapticPointComponent::Describe(FHapticBody& Body, FString&) const {
  pacinian::wire::Point Point;
  const double Radius = 0.5 * pacinian::unreal::metres * FMath::Max(0.01f, Diameter);
  Point.area = UE_DOUBLE_PI * Radius * Radius;
  Body.Object = MoveTemp(Point);
  return true;
}
