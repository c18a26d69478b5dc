#include "pacinian/space/hands.h"

#include <cmath>

#include "pacinian/wire/bulk.h"

namespace pacinian {

namespace {

constexpr std::size_t palm = 0, wrist = 1, thumb = 2, middle = 11;  // joints; of digits the first one
constexpr double millimetre = 1e-3, degree = 0.017453292519943295;

/// A right hand that lies flat: x to the little finger, y to the fingertips, z out of its back [mm].
constexpr Vec3 thumbs[] = {{-22, -44, -6}, {-52, -14, -14}, {-74, 8, -17}, {-88, 25, -18}};
constexpr struct {
  Vec3 base, knuckle;
  double angle;  ///< from y towards x [deg]
  double lengths[3];
} fingers[] = {
    {{-14, -32, 0}, {-22.5, 31, 0}, -7, {41, 24, 18}},
    {{0, -32, 0}, {0, 32, 0}, 0, {45, 28, 19}},
    {{12, -31, 0}, {20.5, 27, 0}, 7, {42, 27, 19}},
    {{22, -28, 0}, {38.5, 17, 0}, 16, {33, 19, 17}},
};
constexpr double thick[] = {20, 21, 19, 12.5, 10, 8.5, 20, 10.5, 8.5, 7.5, 6.5, 20, 11,
                            8.5, 7.5, 6.5, 19, 10, 8, 7.5, 6.5, 18, 8.5, 7, 6.5, 5.5};

}  // namespace

Hand open_hand(wire::HandFrameSide side, const Rigid& pose) {
  Hand made;
  std::size_t next = wrist;
  const auto add = [&](Vec3 place) { made.joints[next++] = place; };
  add({0, -60, 0});
  for (const Vec3 place : thumbs) add(place);
  for (const auto& finger : fingers) {
    const Vec3 forward{std::sin(degree * finger.angle), std::cos(degree * finger.angle), 0.0};
    Vec3 place = finger.knuckle;
    add(finger.base);
    add(place);
    for (const double length : finger.lengths) add(place = place + length * forward);
  }
  for (std::size_t i = 0; i < made.joints.size(); ++i) {
    Vec3 place = millimetre * made.joints[i];
    if (side == wire::HandFrameSide::left) place.x = -place.x;
    made.joints[i] = apply(pose, place);
    made.radii[i] = millimetre * thick[i];
  }
  return made;
}

Hand leap_hand(const std::array<std::array<LeapBone, 4>, 5>& digits, Vec3 arm, double wrist_radius) {
  Hand made;
  made.joints[wrist] = arm;
  made.radii[wrist] = wrist_radius;
  std::size_t next = thumb;
  for (std::size_t digit = 0; digit < digits.size(); ++digit) {
    const std::size_t first = digit == 0 ? 1 : 0;
    for (std::size_t i = first; i < 4; ++i) {
      const LeapBone& bone = digits[digit][i];
      const LeapBone& before = digits[digit][i == first ? i : i - 1];
      made.joints[next] = bone.prev_joint;
      made.radii[next++] = 0.25 * (before.width + bone.width);
    }
    made.joints[next] = digits[digit][3].next_joint;
    made.radii[next++] = 0.5 * digits[digit][3].width;
  }
  made.joints[palm] = 0.5 * (made.joints[middle] + made.joints[middle + 1]);
  made.radii[palm] = made.radii[middle];
  return made;
}

wire::HandFrame to_frame(const Hand& hand, wire::HandFrameSide side) {
  wire::HandFrame made;
  made.side = side;
  for (const Vec3& joint : hand.joints)
    for (const double value : {joint.x, joint.y, joint.z}) wire::append(made.joints, static_cast<float>(value));
  for (const double radius : hand.radii) wire::append(made.radii, static_cast<float>(radius));
  return made;
}

}  // namespace pacinian
