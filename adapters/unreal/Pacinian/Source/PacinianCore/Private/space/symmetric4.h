#pragma once

#include <array>

namespace pacinian {

using Matrix4 = std::array<std::array<double, 4>, 4>;

/// Eigenvalues of a symmetric matrix, and its eigenvectors as columns, in no order.
struct Eigen4 {
  std::array<double, 4> values;
  Matrix4 vectors;
};

/// Uses Jacobi rotations. Golub and Van Loan, Matrix Computations, 8.5.
Eigen4 eigen(Matrix4 matrix);

}  // namespace pacinian
