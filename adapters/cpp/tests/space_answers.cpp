// Answers each line of numbers with numbers, which Python compares with matrices.
//
//     pose x y z qx qy qz qw vx vy vz wx wy wz     Unreal's pose and velocities, in the world
//     back x y z qx qy qz qw                       the world's pose, in Unreal
//     open side x y z qx qy qz qw                  joints and radii of an open hand
//     leap 20 x (prev next width) wrist            the same of a hand as LeapC tells it
//     calibrate count known... touched...          origin x y z qx qy qz qw, residual, worst; or `refused`

#include <iostream>
#include <sstream>

#include "pacinian/space/calibration.h"
#include "pacinian/space/hands.h"
#include "pacinian/space/unreal.h"

namespace {

using namespace pacinian;

std::istream& operator>>(std::istream& in, Vec3& v) { return in >> v.x >> v.y >> v.z; }
std::istream& operator>>(std::istream& in, Rigid& a) {
  Quat& q = a.rotation;
  return in >> a.position >> q.x >> q.y >> q.z >> q.w;
}
std::ostream& operator<<(std::ostream& out, Vec3 v) {
  return out << v.x << " " << v.y << " " << v.z << " ";
}
std::ostream& operator<<(std::ostream& out, Rigid a) {
  const Quat q = a.rotation;
  return out << a.position << q.x << " " << q.y << " " << q.z << " " << q.w << " ";
}

}  // namespace

int main() {
  std::cout.precision(17);
  for (std::string line; std::getline(std::cin, line);) {
    std::istringstream in(line);
    std::string what, problem;
    Rigid pose;
    Vec3 velocity, spin;
    in >> what;
    if (what == "pose") {
      in >> pose >> velocity >> spin;
      std::cout << unreal::to_world(pose) << unreal::to_world(velocity) << unreal::angular(spin);
    } else if (what == "back") {
      in >> pose;
      std::cout << unreal::from_world(pose);
    } else if (what == "open" || what == "leap") {
      Hand hand;
      if (what == "open") {
        std::string side;
        in >> side >> pose;
        hand = open_hand(side == "left" ? wire::HandFrameSide::left : wire::HandFrameSide::right, pose);
      } else {
        std::array<std::array<LeapBone, 4>, 5> digits;
        for (auto& digit : digits)
          for (LeapBone& bone : digit) in >> bone.prev_joint >> bone.next_joint >> bone.width;
        in >> velocity;
        hand = leap_hand(digits, velocity);
      }
      for (const Vec3& joint : hand.joints) std::cout << joint;
      for (const double radius : hand.radii) std::cout << radius << " ";
    } else {
      std::size_t count = 0;
      in >> count;
      std::vector<Vec3> known(count), touched(count);
      for (Vec3& point : known) in >> point;
      for (Vec3& point : touched) in >> point;
      Calibration made;
      if (calibrate(known, touched, made, problem))
        std::cout << made.origin << made.residual << " " << made.worst;
      else
        std::cout << "refused";
    }
    std::cout << "\n";
  }
  return 0;
}
