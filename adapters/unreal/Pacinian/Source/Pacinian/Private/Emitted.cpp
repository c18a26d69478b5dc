#include "Emitted.h"

#include "HapticScene.h"
#include "HapticServerComponent.h"

namespace wire = pacinian::wire;

namespace Haptic {

namespace {

constexpr double Old = 0.5;  // [s]; an older state is not shown

}  // namespace

TSharedPtr<FHapticLink> LinkOf(const UObject* Object) {
  const UHapticScene* Scene = UHapticScene::Of(Object);
  const UHapticServerComponent* Server = Scene ? Scene->GetServer() : nullptr;
  return Server ? Server->GetLink() : nullptr;
}

const wire::State* Fresh(const TSharedPtr<FHapticLink>& Link) {
  const wire::State* State = Link ? Link->Client.state() : nullptr;
  return State && Link->Client.age(*State) < Old ? State : nullptr;
}

std::size_t Samples(const wire::State& State) {
  const std::size_t Count = State.points.size() / 12;
  const bool bWhole = State.achieved.size() == 4 * Count && State.asked.size() == 4 * Count &&
                      State.normals.size() == 12 * Count && State.index.size() == 4 * Count;
  return bWhole && State.output == wire::Output::sounding ? Count : 0;
}

pacinian::Vec3 At(const wire::Bytes& Rows, std::size_t i) {
  return {wire::float_at(Rows, 3 * i), wire::float_at(Rows, 3 * i + 1), wire::float_at(Rows, 3 * i + 2)};
}

float Strongest(const wire::State& State, const std::string& Name) {
  float Most = 0.0f;
  for (std::size_t i = 0; i < Samples(State); ++i) {
    const std::uint32_t Index = wire::uint32_at(State.index, i);
    if (Index < State.objects.size() && State.objects[Index] == Name)
      Most = FMath::Max(Most, wire::float_at(State.achieved, i));
  }
  return Most;
}

FHapticTouch ToTouch(const wire::TouchState& Told, const FHapticSpace& Space) {
  FHapticTouch Made;
  Made.Effect = Text(Told.object);
  Made.Hand = Text(Told.hand);
  Made.Position = Space.Out({Told.position[0], Told.position[1], Told.position[2]});
  Made.Pressure = static_cast<float>(Told.pressure);
  Made.Strength = static_cast<float>(Told.strength);
  return Made;
}

}  // namespace Haptic
