// Kernels compiled without the assumption that all numbers are finite.
#define NO_IMPORT_ARRAY
#include "pacinian/rendering/quantiser.hpp"
#include "pacinian/rendering/reachability.hpp"
#include "pacinian/rendering/smoothing.hpp"
#include "pacinian/rendering/field_steering.hpp"
#include "pacinian/scene/non_finite.hpp"
#include "pacinian/solving/non_finite.hpp"

// module.cpp calls these.
namespace pacinian::scene {
void define_non_finite(nb::module_& m);
void define_non_finite(nb::module_& m) { define_checked(m); }
}  // namespace pacinian::scene

namespace pacinian::solving {
void define_non_finite(nb::module_& m);
void define_non_finite(nb::module_& m) { define_checked(m); }
}  // namespace pacinian::solving

namespace pacinian::rendering {

void define(nb::module_& m);
void define(nb::module_& m) {
    define_levels(m);
    define_reachability(m);
    define_smooth(m);
    define_steering(m);
}

}  // namespace pacinian::rendering
