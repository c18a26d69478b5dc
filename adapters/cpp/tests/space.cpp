// Tests of coordinates by their own laws: conversions and back, matrices of reflections, and calibration from exact
// points.

#include <cmath>
#include <cstdio>
#include <random>

#include "pacinian/space/calibration.h"
#include "pacinian/space/unreal.h"

namespace {

using namespace pacinian;

int failed = 0;
std::mt19937 source(1);

double any() { return std::normal_distribution<double>()(source); }
Vec3 any_place() { return {any(), any(), any()}; }
Rigid any_rigid() { return {any_place(), normalised({any(), any(), any(), any()})}; }

void close_to(Vec3 a, Vec3 b, const char* what, double within = 1e-12) {
  if (length(a - b) <= within) return;
  ++failed;
  std::printf("%s: (%g, %g, %g), not (%g, %g, %g)\n", what, a.x, a.y, a.z, b.x, b.y, b.z);
}

void expect(bool good, const char* what) {
  if (good) return;
  ++failed;
  std::printf("%s\n", what);
}

void frames() {
  for (int i = 0; i < 1000; ++i) {
    const Rigid a = any_rigid(), b = any_rigid();
    const Vec3 place = any_place(), spin = any_place();
    close_to(apply(a * b, place), apply(a, apply(b, place)), "a product is one after the other");
    close_to(apply(inverse(a), apply(a, place)), place, "there and back");
    close_to(unreal::to_world(apply(a, place)), apply(unreal::to_world(a), unreal::to_world(place)),
         "seen from either frame it is the same motion");
    close_to(apply(unreal::from_world(unreal::to_world(a)), place), apply(a, place), "from and to");
    close_to(unreal::to_world(cross(spin, place)),
         cross(unreal::angular(spin), unreal::to_world(place)), "a spin is axial");
    close_to(unreal::angular(unreal::angular(spin)), spin, "a spin there and back");
  }
  close_to(unreal::to_world(Vec3{100.0, 0.0, 0.0}), {0.0, 1.0, 0.0}, "forward");
  close_to(unreal::to_world(Vec3{0.0, 100.0, 0.0}), {1.0, 0.0, 0.0}, "right");
  close_to(unreal::to_world(Vec3{0.0, 0.0, 20.0}), {0.0, 0.0, 0.2}, "up");
}

void calibration() {
  Calibration made;
  std::string problem;
  for (std::size_t count : {3u, 4u, 12u})
    for (int i = 0; i < 100; ++i) {
      const Rigid origin = any_rigid();
      std::vector<Vec3> known, touched;
      for (std::size_t k = 0; k < count; ++k) {
        known.push_back(any_place());
        touched.push_back(apply(origin, known.back()));
      }
      if (!calibrate(known, touched, made, problem)) continue;  // by chance nearly on a line
      expect(made.residual < 1e-9 && made.worst < 1e-9, "exact points leave a residual");
      const Vec3 place = any_place();
      close_to(apply(made.origin, place), apply(origin, place), "the origin", 1e-6);
    }
}

void refused() {
  Calibration made;
  std::string problem;
  const std::vector<Vec3> two = {{}, {0.1, 0, 0}}, same = {{}, {}, {}};
  const std::vector<Vec3> line = {{}, {0.1, 0, 0}, {0.2, 0, 0}};
  const std::vector<Vec3> three = {{}, {0.1, 0, 0}, {0, 0.1, 0}};
  const std::vector<Vec3> lost = {{}, {NAN, 0, 0}, {0, 0.1, 0}};
  expect(!calibrate(two, two, made, problem), "two points");
  expect(!calibrate(three, two, made, problem), "points that were not touched");
  expect(!calibrate(line, line, made, problem), "points on a line");
  expect(!calibrate(same, same, made, problem), "one point");
  expect(!calibrate(three, lost, made, problem), "a point that is NaN");
  expect(!problem.empty(), "no reason");
  expect(calibrate(three, three, made, problem), "three points");
  const Quat none = normalised({NAN, 0.0, 0.0, 0.0});
  expect(none.w == 1.0 && normalised({0.0, 0.0, 0.0, 0.0}).w == 1.0, "no rotation");
}

}  // namespace

int main() {
  frames();
  calibration();
  refused();
  std::printf("%d failed\n", failed);
  return failed == 0 ? 0 : 1;
}
