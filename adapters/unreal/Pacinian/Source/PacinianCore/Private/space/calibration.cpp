#include "pacinian/space/calibration.h"

#include <algorithm>
#include <cmath>

#include "symmetric4.h"

namespace pacinian {

namespace {

constexpr double least_spread = 1e-3;  // [m] smallest spread of distinct points
constexpr double least_gap = 1e-3;     // relative to the largest eigenvalue: points 40 times longer than wide

Vec3 mean(const std::vector<Vec3>& points) {
  Vec3 sum;
  for (const Vec3& point : points) sum = sum + point;
  return (1.0 / static_cast<double>(points.size())) * sum;
}

/// Returns Horn's matrix: its eigenvector of the largest eigenvalue is the rotation w, x, y, z.
Matrix4 horn(const std::vector<Vec3>& from, Vec3 middle, const std::vector<Vec3>& to, Vec3 centre) {
  Matrix4 n{};
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Vec3 a = from[i] - middle, b = to[i] - centre, c = cross(a, b);
    n[0][0] += dot(a, b);
    n[0][1] += c.x;
    n[0][2] += c.y;
    n[0][3] += c.z;
    n[1][1] += a.x * b.x - a.y * b.y - a.z * b.z;
    n[2][2] += a.y * b.y - a.x * b.x - a.z * b.z;
    n[3][3] += a.z * b.z - a.x * b.x - a.y * b.y;
    n[1][2] += a.x * b.y + a.y * b.x;
    n[1][3] += a.z * b.x + a.x * b.z;
    n[2][3] += a.y * b.z + a.z * b.y;
  }
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t k = 0; k < i; ++k) n[i][k] = n[k][i];
  return n;
}

}  // namespace

bool calibrate(const std::vector<Vec3>& known, const std::vector<Vec3>& touched, Calibration& out,
               std::string& problem) {
  const std::size_t count = known.size();
  if (count < 3 || touched.size() != count) {
    problem = "touch 3 or more known points, each once";
    return false;
  }
  if (!std::all_of(known.begin(), known.end(), finite) ||
      !std::all_of(touched.begin(), touched.end(), finite)) {
    problem = "a point is not finite: was the tracker lost?";
    return false;
  }
  const Vec3 middle = mean(known), centre = mean(touched);
  const Eigen4 found = eigen(horn(known, middle, touched, centre));
  const auto largest = std::max_element(found.values.begin(), found.values.end());
  const auto best = static_cast<std::size_t>(largest - found.values.begin());
  double next = -*largest;
  for (std::size_t i = 0; i < 4; ++i)
    if (i != best) next = std::max(next, found.values[i]);
  if (*largest < least_spread * least_spread || *largest - next < least_gap * *largest) {
    problem = "the points lie about on a line, or in one place: touch others farther apart";
    return false;
  }
  const auto& v = found.vectors;
  out.origin.rotation = normalised({v[1][best], v[2][best], v[3][best], v[0][best]});
  out.origin.position = centre - turn(out.origin.rotation, middle);
  double sum = out.worst = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double distance = length(apply(out.origin, known[i]) - touched[i]);
    out.worst = std::max(out.worst, distance);
    sum += distance * distance;
  }
  out.residual = std::sqrt(sum / static_cast<double>(count));
  return true;
}

}  // namespace pacinian
