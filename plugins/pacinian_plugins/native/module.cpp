// The plug-ins' kernels as a Python module, compiled once for each instruction set (-DMODULE=_v4, ...).
#include "pacinian_plugins/solvers/greedy.hpp"
#include "pacinian_plugins/solvers/gs/alternation.hpp"
#include "pacinian_plugins/solvers/lagrange/dual_newton.hpp"
#include "pacinian_plugins/solvers/lagrange/weighted_gs.hpp"
#include "pacinian_plugins/solvers/lagrange/primal_newton.hpp"
#include "pacinian_plugins/solvers/lagrange/region_newton.hpp"

namespace pacinian::lagrange {

void define_non_finite(nb::module_& m);  // in non_finite.cpp

static void define(nb::module_& m) {
    define_workspace(m);
    define_small(m);
    define_sweeps(m);
    define_dual(m);
    define_equalise(m);
    define_newton_step(m);
    define_primal(m);
    define_region(m);
    define_non_finite(m);
}

}  // namespace pacinian::lagrange

NB_MODULE(MODULE, m) {
    using namespace pacinian;
    start_numpy();
    group(m, "lagrange", lagrange::define);
    group(m, "gs", gs::define);
    group(m, "greedy", greedy::define);
}
