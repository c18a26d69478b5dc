#include "ArrayAlignment.h"

#include "HapticLink.h"
#include "HapticScene.h"
#include "HapticServerComponent.h"

namespace wire = pacinian::wire;

namespace Haptic {

TArray<FVector> Corners(const UObject* Object) {
  const UHapticScene* Scene = UHapticScene::Of(Object);
  const UHapticServerComponent* Server = Scene ? Scene->GetServer() : nullptr;
  const TSharedPtr<FHapticLink> Link = Server ? Server->GetLink() : nullptr;
  const wire::Abilities* Abilities = Link ? Link->Client.capabilities() : nullptr;
  const std::size_t Count = Abilities ? Abilities->positions.size() / 12 : 0;
  if (Count == 0) return {};
  if (Link->CornersSession == Link->Session) return Link->Corners;
  TArray<FVector> Found;
  constexpr double Ways[4][2] = {{1.0, 1.0}, {1.0, -1.0}, {-1.0, -1.0}, {-1.0, 1.0}};
  for (const auto& Way : Ways) {
    FVector Outermost = FVector::ZeroVector;
    double Most = -1e300;
    for (std::size_t i = 0; i < Count; ++i) {
      const pacinian::Vec3 At{wire::float_at(Abilities->positions, 3 * i),
                              wire::float_at(Abilities->positions, 3 * i + 1),
                              wire::float_at(Abilities->positions, 3 * i + 2)};
      const double Reach = Way[0] * At.x + Way[1] * At.y;
      if (Reach <= Most) continue;
      Most = Reach;
      Outermost = Vec(pacinian::unreal::from_world(At));
    }
    Found.Add(Outermost);
  }
  Link->CornersSession = Link->Session;
  Link->Corners = Found;
  return Found;
}

bool Align(const TArray<FVector>& Known, const TArray<FVector>& Touched, FTransform& Found, double& Residual,
           double& Worst, FString& Problem) {
  std::vector<pacinian::Vec3> From, To;
  for (int32 i = 0; i < Touched.Num() && i < Known.Num(); ++i) {
    From.push_back(pacinian::unreal::to_world(Vec(Known[i])));
    To.push_back(pacinian::unreal::to_world(Vec(Touched[i])));
  }
  pacinian::Calibration Made;
  std::string Why;
  if (!pacinian::calibrate(From, To, Made, Why)) {
    Problem = Text(Why);
    return false;
  }
  Found = FHapticSpace::Centimetres(Made.origin);
  Residual = Made.residual / pacinian::unreal::metres;
  Worst = Made.worst / pacinian::unreal::metres;
  return true;
}

}  // namespace Haptic
