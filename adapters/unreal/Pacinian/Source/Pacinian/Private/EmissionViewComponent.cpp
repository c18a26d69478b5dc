#include "EmissionViewComponent.h"

#include "DrawDebugHelpers.h"
#include "Engine/World.h"
#include "HapticScene.h"
#include "HapticServerComponent.h"
#include "Link.h"

namespace wire = pacinian::wire;

namespace {

constexpr double Old = 0.5;     // [s] beyond which a state is not shown
constexpr double Arrow = 2.0;   // [cm]
constexpr int32 Joints = 26;    // of a hand

TSharedPtr<FHapticLink> LinkOf(const UObject* Object) {
  const UHapticScene* Scene = UHapticScene::Of(Object);
  const UHapticServerComponent* Server = Scene ? Scene->GetServer() : nullptr;
  return Server ? Server->GetLink() : nullptr;
}

/// What is emitted now, or null.
const wire::State* Fresh(const TSharedPtr<FHapticLink>& Link) {
  const wire::State* State = Link ? Link->Client.state() : nullptr;
  return State && Link->Client.age(*State) < Old ? State : nullptr;
}

pacinian::Vec3 At(const wire::Bytes& Rows, std::size_t i) {
  return {wire::float_at(Rows, 3 * i), wire::float_at(Rows, 3 * i + 1), wire::float_at(Rows, 3 * i + 2)};
}

std::size_t Count(const wire::State& State) {
  return FMath::Min(State.points.size() / 12, FMath::Min(State.achieved.size(), State.asked.size()) / 4);
}

}  // namespace

UEmissionViewComponent::UEmissionViewComponent() {
  PrimaryComponentTick.bCanEverTick = true;
  PrimaryComponentTick.TickGroup = TG_PostUpdateWork;
}

void UEmissionViewComponent::GetSamples(TArray<FVector>& Positions, TArray<float>& Pressures) const {
  Positions.Reset();
  Pressures.Reset();
  const TSharedPtr<FHapticLink> Link = LinkOf(this);
  const wire::State* State = Fresh(Link);
  if (!State || State->output != wire::Output::sounding) return;
  for (std::size_t i = 0; i < Count(*State); ++i) {
    Positions.Add(Link->Space.Out(At(State->points, i)));
    Pressures.Add(wire::float_at(State->achieved, i));
  }
}

void UEmissionViewComponent::TickComponent(float DeltaTime, ELevelTick TickType, FActorComponentTickFunction* Tick) {
  Super::TickComponent(DeltaTime, TickType, Tick);
#if ENABLE_DRAW_DEBUG
  const TSharedPtr<FHapticLink> Link = LinkOf(this);
  const wire::State* State = Fresh(Link);
  if (!State) return;
  float Strongest = 1e-6f;
  for (std::size_t i = 0; i < Count(*State); ++i) Strongest = FMath::Max(Strongest, wire::float_at(State->asked, i));
  const bool bSounds = State->output == wire::Output::sounding;
  for (std::size_t i = 0; bSounds && i < Count(*State); ++i) {
    const FVector Place = Link->Space.Out(At(State->points, i));
    const float Share = FMath::Clamp(wire::float_at(State->achieved, i) / Strongest, 0.0f, 1.0f);
    const FColor Colour = FLinearColor::LerpUsingHSV(FLinearColor::Blue, FLinearColor::Red, Share).ToFColor(true);
    if (bDrawSamples) DrawDebugPoint(GetWorld(), Place, PointSize, Colour);
    if (bDrawNormals && State->normals.size() >= 12 * (i + 1))
      DrawDebugLine(GetWorld(), Place, Place + Arrow * Link->Space.OutDirection(At(State->normals, i)), Colour);
  }
  for (std::size_t i = 0; bDrawHands && i < State->hands.size() / 12; ++i) {
    const FVector Place = Link->Space.Out(At(State->hands, i));
    if (!Place.ContainsNaN()) DrawDebugPoint(GetWorld(), Place, i % Joints == 0 ? 8.0f : 5.0f, FColor::White);
  }
#endif
}
