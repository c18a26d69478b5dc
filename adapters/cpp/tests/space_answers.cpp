// Answers each line of numbers by numbers: what Python compares with matrices.
//
//     pose x y z qx qy qz qw vx vy vz wx wy wz     Unreal's pose and velocities, in the world
//     back x y z qx qy qz qw                       the world's pose, in Unreal
//     calibrate count known... touched...          origin x y z qx qy qz qw, residual, worst; or `refused`

#include <iostream>
#include <sstream>

#include "pacinian/space/calibration.h"
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
