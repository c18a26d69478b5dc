// The core's kernels as a Python module, compiled once for each set of instructions (-DMODULE=_v4, ...).
#include "pacinian/acoustics/kernels.hpp"
#include "pacinian/native/processor.hpp"
#include "pacinian/neighbours.hpp"
#include "pacinian/scene/hands/skin_lod.hpp"
#include "pacinian/scene/hands/skin.hpp"
#include "pacinian/scene/sampling/merge_samples.hpp"
#include "pacinian/scene/sampling/posed_skin.hpp"
#include "pacinian/scene/sampling/contact_nodes.hpp"
#include "pacinian/scene/sampling/ramps.hpp"
#include "pacinian/scene/modulation/visit_order.hpp"
#include "pacinian/scene/shapes/cells.hpp"
#include "pacinian/solving/changed_rows.hpp"
#include "pacinian/solving/kernels.hpp"
#include "pacinian/solving/matvec.hpp"
#include "pacinian/solving/regions.hpp"

namespace pacinian {

namespace solving {

void define_non_finite(nb::module_& m);  // in non_finite.cpp

static void define(nb::module_& m) {
    define_kernels(m);
    define_changes(m);
    define_passes(m);
    define_regions(m);
    define_non_finite(m);
}

}  // namespace solving

namespace scene {

void define_non_finite(nb::module_& m);  // in non_finite.cpp

static void define(nb::module_& m) {
    define_levels(m);
    define_capsules(m);
    define_skin(m);
    define_contact(m);
    define_nodes(m);
    define_ramps(m);
    define_broad(m);
    define_tour(m);
    define_cells(m);
    define_non_finite(m);
}

}  // namespace scene

namespace rendering {

void define(nb::module_& m);  // in non_finite.cpp

}  // namespace rendering

}  // namespace pacinian

NB_MODULE(MODULE, m) {
    using namespace pacinian;
    start_numpy();
    m.def("level", &level, "The level of x86-64 that this processor has: 1, 3 or 4; 0 of another processor.");
    group(m, "neighbours", neighbours::define);
    group(m, "acoustics", acoustics::define);
    group(m, "solving", solving::define);
    group(m, "scene", scene::define);
    group(m, "rendering", rendering::define);
}
