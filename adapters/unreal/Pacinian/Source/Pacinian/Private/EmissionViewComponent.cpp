#include "EmissionViewComponent.h"

#include "DrawDebugHelpers.h"
#include "Emitted.h"
#include "Engine/World.h"

namespace wire = pacinian::wire;

namespace {

constexpr double Arrow = 2.0;  // [cm]
constexpr float Dot = 10.0f;   // [pixels]
constexpr int32 Joints = 26;   // of a hand

}  // namespace

UEmissionViewComponent::UEmissionViewComponent() {
  PrimaryComponentTick.bCanEverTick = true;
  PrimaryComponentTick.bTickEvenWhenPaused = true;  // the array sounds meanwhile
  PrimaryComponentTick.TickGroup = TG_PostUpdateWork;
}

void UEmissionViewComponent::GetSamples(TArray<FVector>& Positions, TArray<float>& Pressures) const {
  Positions.Reset();
  Pressures.Reset();
  const TSharedPtr<FHapticLink> Link = Haptic::LinkOf(this);
  const wire::State* State = Haptic::Fresh(Link);
  for (std::size_t i = 0; State && i < Haptic::Samples(*State); ++i) {
    Positions.Add(Link->Space.Out(Haptic::At(State->points, i)));
    Pressures.Add(wire::float_at(State->achieved, i));
  }
}

void UEmissionViewComponent::TickComponent(float DeltaTime, ELevelTick TickType, FActorComponentTickFunction* Tick) {
  Super::TickComponent(DeltaTime, TickType, Tick);
#if ENABLE_DRAW_DEBUG
  const TSharedPtr<FHapticLink> Link = Haptic::LinkOf(this);
  const wire::State* State = Haptic::Fresh(Link);
  if (!State) return;
  float Strongest = 1e-6f;
  const std::size_t Count = Haptic::Samples(*State);
  for (std::size_t i = 0; i < Count; ++i) Strongest = FMath::Max(Strongest, wire::float_at(State->asked, i));
  for (std::size_t i = 0; i < Count; ++i) {
    const FVector Place = Link->Space.Out(Haptic::At(State->points, i));
    const float Share = FMath::Clamp(wire::float_at(State->achieved, i) / Strongest, 0.0f, 1.0f);
    const FColor Colour = FLinearColor::LerpUsingHSV(FLinearColor::Blue, FLinearColor::Red, Share).ToFColor(true);
    if (bDrawSamples) DrawDebugPoint(GetWorld(), Place, Dot, Colour);
    if (bDrawNormals)
      DrawDebugLine(GetWorld(), Place, Place + Arrow * Link->Space.OutDirection(Haptic::At(State->normals, i)), Colour);
  }
  for (std::size_t i = 0; bDrawHands && i < State->hands.size() / 12; ++i) {
    const FVector Place = Link->Space.Out(Haptic::At(State->hands, i));
    if (!Place.ContainsNaN()) DrawDebugPoint(GetWorld(), Place, i % Joints == 0 ? 8.0f : 5.0f, FColor::White);
  }
#endif
}
