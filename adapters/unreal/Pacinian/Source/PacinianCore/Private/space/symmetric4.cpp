#include "symmetric4.h"

#include <cmath>
#include <cstddef>

namespace pacinian {

namespace {

constexpr int sweeps = 30;

/// Rotates the rows p and q, or the columns p and q.
void turn(Matrix4& m, std::size_t p, std::size_t q, double c, double s, bool columns) {
  for (std::size_t k = 0; k < 4; ++k) {
    double& a = columns ? m[k][p] : m[p][k];
    double& b = columns ? m[k][q] : m[q][k];
    const double before = a;
    a = c * before - s * b;
    b = s * before + c * b;
  }
}

}  // namespace

Eigen4 eigen(Matrix4 matrix) {
  Eigen4 out{};
  for (std::size_t i = 0; i < 4; ++i) out.vectors[i][i] = 1.0;
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (std::size_t p = 0; p < 3; ++p)
      for (std::size_t q = p + 1; q < 4; ++q) {
        const double off = matrix[p][q];
        if (off == 0.0) continue;
        const double tau = (matrix[q][q] - matrix[p][p]) / (2.0 * off);
        const double t = std::copysign(1.0, tau) / (std::abs(tau) + std::hypot(1.0, tau));
        const double c = 1.0 / std::hypot(1.0, t);
        turn(matrix, p, q, c, t * c, true);
        turn(matrix, p, q, c, t * c, false);
        turn(out.vectors, p, q, c, t * c, true);
      }
  for (std::size_t i = 0; i < 4; ++i) out.values[i] = matrix[i][i];
  return out;
}

}  // namespace pacinian
