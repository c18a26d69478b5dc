#include "OpenHand.h"

namespace Haptic {

namespace {

constexpr int32 Count = 26;

constexpr float Places[3 * Count] = {
    // forward, right, up of each joint of a right hand [mm]
    0, 0, 0, -60, 0, 0, -44, -22, -6, -14, -52, -14, 8, -74, -17, 25, -88, -18,                      // thumb
    -32, -14, 0, 31, -22.5f, 0, 71.7f, -27.5f, 0, 95.5f, -30.4f, 0, 113.4f, -32.6f, 0,              // index
    -32, 0, 0, 32, 0, 0, 77, 0, 0, 105, 0, 0, 124, 0, 0,                                            // middle
    -31, 12, 0, 27, 20.5f, 0, 68.7f, 25.6f, 0, 95.5f, 28.9f, 0, 114.3f, 31.2f, 0,                   // ring
    -28, 22, 0, 17, 38.5f, 0, 48.7f, 47.6f, 0, 67, 52.8f, 0, 83.3f, 57.5f, 0,                       // little
};

constexpr float Thick[Count] = {  // [mm]
    20, 21, 19, 12.5f, 10, 8.5f, 20, 10.5f, 8.5f, 7.5f, 6.5f, 20, 11,
    8.5f, 7.5f, 6.5f, 19, 10, 8, 7.5f, 6.5f, 18, 8.5f, 7, 6.5f, 5.5f,
};

}  // namespace

void OpenHand(const FTransform& Palm, bool bLeft, TArray<FVector>& Joints, TArray<float>& Radii) {
  const FTransform Placed(Palm.GetRotation(), Palm.GetLocation());
  Joints.Reset();
  Radii.Reset();
  for (int32 i = 0; i < Count; ++i) {
    const float* At = Places + 3 * i;
    Joints.Add(Placed.TransformPosition(0.1 * FVector(At[0], bLeft ? -At[1] : At[1], At[2])));
    Radii.Add(0.1f * Thick[i]);
  }
}

}  // namespace Haptic
