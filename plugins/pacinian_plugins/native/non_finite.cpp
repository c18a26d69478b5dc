// Kernels that must handle NaN and infinity, compiled without the assumption that all numbers are finite.
#define NO_IMPORT_ARRAY
#include "pacinian_plugins/solvers/lagrange/newton_start.hpp"
#include "pacinian_plugins/solvers/lagrange/convex/kernels.hpp"

namespace pacinian::lagrange {

void define_non_finite(nb::module_& m);
void define_non_finite(nb::module_& m) {
    define_start(m);
    define_convex(m);
}

}  // namespace pacinian::lagrange
