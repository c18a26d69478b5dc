#include "Motion.h"

#include <cmath>

THIRD_PARTY_INCLUDES_START
#include "pacinian/wire/protocol.h"
THIRD_PARTY_INCLUDES_END

namespace wire = pacinian::wire;

namespace Haptic {

namespace {

constexpr double MaxSpeed = 10.0;  // [m/s], and times 5 [rad/s]; faster is a jump
constexpr double MinMove = 1e-6;    // [m]
constexpr double MinTurn = 1e-5;  // [rad]

/// Returns the rotation from one to the other, as a vector along its axis [rad].
pacinian::Vec3 Turn(const pacinian::Quat& From, const pacinian::Quat& To) {
  const pacinian::Quat Between = To * pacinian::inverse(From);
  const pacinian::Vec3 Axis{Between.x, Between.y, Between.z};
  const double Sine = std::sqrt(pacinian::dot(Axis, Axis));
  if (Sine < 1e-12) return {};
  const double Angle = 2.0 * std::atan2(Between.w < 0.0 ? -Sine : Sine, std::abs(Between.w));
  return (Angle / Sine) * Axis;
}

double Length(const pacinian::Vec3& Given) { return std::sqrt(pacinian::dot(Given, Given)); }

}  // namespace

bool Moved(const pacinian::Rigid& From, const pacinian::Rigid& To) {
  return Length(To.position - From.position) > MinMove || Length(Turn(From.rotation, To.rotation)) > MinTurn;
}

wire::Motion MotionOf(const pacinian::Rigid& From, const pacinian::Rigid& To, double Elapsed) {
  if (!(Elapsed > 0.0)) return {};
  const pacinian::Vec3 Velocity = (1.0 / Elapsed) * (To.position - From.position);
  const pacinian::Vec3 Angular = (1.0 / Elapsed) * Turn(From.rotation, To.rotation);
  if (!(Length(Velocity) < MaxSpeed) || !(Length(Angular) < 5.0 * MaxSpeed)) return {};
  return {{Velocity.x, Velocity.y, Velocity.z}, {Angular.x, Angular.y, Angular.z}};
}

std::array<double, 3> ToWire(const pacinian::Vec3& Given) {
  constexpr double Most = wire::MAX_COORDINATE;
  return {FMath::Clamp(Given.x, -Most, Most), FMath::Clamp(Given.y, -Most, Most), FMath::Clamp(Given.z, -Most, Most)};
}

wire::Pose ToWire(const pacinian::Rigid& Given) {
  const pacinian::Quat& Turned = Given.rotation;
  return {ToWire(Given.position), {Turned.x, Turned.y, Turned.z, Turned.w}};
}

wire::HapticObject& Placed(wire::Object& Object, const wire::Pose& Pose) {
  if (auto* Surface = std::get_if<wire::Surface>(&Object)) {
    Surface->pose = Pose;
    return *Surface;
  }
  if (auto* Volume = std::get_if<wire::Volume>(&Object)) {
    Volume->pose = Pose;
    return *Volume;
  }
  auto* Point = std::get_if<wire::Point>(&Object);
  if (!Point) Point = &Object.emplace<wire::Point>();
  Point->position = Pose.position;
  return *Point;
}

}  // namespace Haptic
