// Memory for problems with M samples and N transducers, allocated once and reused, and what the kernels found, by name.
#pragma once
#include <initializer_list>
#include <limits>
#include <memory>
#include <vector>

#include "pacinian/solving/matvec.hpp"

namespace pacinian::lagrange {

using solving::TILE;

constexpr Index MAX_START = 16;  // samples up to which the kernel `start` finds the multipliers without a limit

// A NumPy array, zero at first, that C++ and Python share.
template <typename T, int D>
struct Shared {
    nb::object array;
    View<T, D> view;

    explicit Shared(std::initializer_list<Index> shape) {
        constexpr int type = std::is_same_v<T, bool> ? NPY_BOOL
                             : std::is_same_v<T, i8> ? NPY_INT64
                             : std::is_same_v<T, f4> ? NPY_FLOAT
                             : std::is_same_v<T, f8> ? NPY_DOUBLE
                                                     : NPY_CDOUBLE;
        std::copy(shape.begin(), shape.end(), view.shape);
        npy_intp sizes[D];
        std::copy(shape.begin(), shape.end(), sizes);
        PyObject* made = PyArray_ZEROS(D, sizes, type, 0);
        if (!made) throw nb::python_error();
        array = nb::steal(made);
        view.data = static_cast<T*>(PyArray_DATA(reinterpret_cast<PyArrayObject*>(made)));
    }
};

inline namespace MODULE {  // types of its own in each variant, because a process may load several

inline Index tile_rows(Index M) { return (M + 3) / 4 * 4; }

// Up to two equations for each sample.
struct Workspace {
    Index M, N, K;
    Shared<c16, 1> p{{M}}, y{{M}};
    Shared<bool, 1> free{{M}};
    Shared<f4, 2> h{{3, N}};
    Shared<f8, 2> made{{2, M}};
    Shared<f4, 3> tile{{2, tile_rows(M), TILE}};

    f8 error = 0.0, multiple = 0.0, bound = 0.0, objective = 0.0;
    i8 held = 0;
    f8 cost = 0.0;      // sum of c(x_n) at the multipliers y
    f8 residual = 0.0;  // ||F|| / ||p|| at the last dual step
    i8 stalled = 0;     // dual steps in a row that did little; -1 before the first
    f8 damping = 0.0;   // of the primal steps; 0 before the first
    i8 idle = 0;        // primal steps in a row that did little

    Workspace(Index samples, Index transducers) : M(samples), N(transducers), K(2 * samples + 4) {}

    View<f8, 2> system() { return {A.data(), {K, K}}; }
    View<f4, 2> columns() { return {V.data(), {K, 2 * TILE}}; }
    View<c16, 2> factor() { return {L.data(), {std::min(M, MAX_START), std::min(M, MAX_START)}}; }
    f4* steps(Index row) { return W.data() + row * N; }
    View<bool, 1> limited() { return {at_limit.get(), {N}}; }
    i8* indices() { return which.data(); }

    void restart_dual() {
        residual = std::numeric_limits<f8>::max();
        stalled = -1;
    }
    void restart_primal() {
        damping = 0.0;
        idle = 0;
    }

    void check(View<const c8, 2> B) const { require(B.shape[0] == M && B.shape[1] == N, "the workspace has another size"); }

private:
    std::vector<c16> L = std::vector<c16>(std::min(M, MAX_START) * std::min(M, MAX_START));
    std::vector<f8> A = std::vector<f8>(K * K);
    std::vector<f4> V = std::vector<f4>(K * 2 * TILE), W = std::vector<f4>(7 * N);
    std::vector<i8> which = std::vector<i8>(TILE);
    std::unique_ptr<bool[]> at_limit = std::make_unique<bool[]>(N);
};

// For regions. The preconditioner has a block for each of the `sizes`, a number of samples; none if there are none.
struct RegionWorkspace {
    Index M, N, stride;
    std::vector<Index> sizes;
    Shared<f4, 2> h{{3, N}};
    Shared<f8, 2> made{{2, M}};
    Shared<f4, 3> tile{{2, tile_rows(M), TILE}};
    Shared<i8, 1> order{{M}};
    Shared<f4, 1> factor{{count_elements(sizes)}};

    bool met = false;
    f8 bound = 0.0, objective = 0.0;
    i8 held = 0;
    enum class Factor { none, usable, indefinite } state = Factor::none;
    Index passes = 0;  // conjugate gradients in the first step with this preconditioner

    RegionWorkspace(Index samples, Index transducers, View<const i8, 1> blocks, Index step)
        : M(samples), N(transducers), stride(step), sizes(blocks.data, blocks.data + blocks.size()) {
        Index held = 0;
        for (const Index size : sizes) {
            require(size > 0, "RegionWorkspace: a block is empty");
            held += size;
        }
        require(stride > 0 && (sizes.empty() || held == M), "RegionWorkspace: the blocks do not hold all samples");
    }

    // Size of the factor of a block of so many samples: two rows at a time are computed.
    static Index even(Index size) { return size + size % 2; }
    static Index count_elements(const std::vector<Index>& sizes) {
        Index count = 0;
        for (const Index size : sizes) count += 2 * even(size) * even(size);
        return count;
    }

    // Call `each` with the samples of each block, their number, and its factor, until that returns false; return whether none did.
    template <typename Each>
    bool visit_blocks(const Each& each) {
        const i8* block = order.view.data;
        f4* L = factor.view.data;
        for (const Index size : sizes) {
            const Index K = even(size);
            if (!each(block, size, View<f4, 3>{L, {2, K, K}})) return false;
            block += size;
            L += 2 * K * K;
        }
        return true;
    }

    void restart(bool same) {
        met = false;
        if (!same || state == Factor::indefinite) state = Factor::none;
    }
};

}  // namespace MODULE

template <typename Class, typename T, int D>
void share(nb::class_<Class>& c, const char* name, Shared<T, D> Class::* member, const char* signature) {
    c.def_prop_ro(name, [member](const Class& w) { return (w.*member).array; }, nb::sig(signature));
}

inline void define_workspace(nb::module_& m) {
    nb::class_<Workspace> w(m, "Workspace",
                            "Memory for M samples and N transducers, reused from solve to solve, and what the kernels found.\n\n"
                            "p: targets, (M,) [Pa per unit limit]. free: whether their phase is free, (M,). y: multipliers, (M,). h: real and\n"
                            "imaginary part of the gains in units of the limit, and |x_n|, (3, N). made: real and imaginary part of B h, (2, M).\n"
                            "tile: see fused_passes.hpp. error: ||targets - made|| / ||p||, where free phases are those made. cost: sum of c(x_n)\n"
                            "at y. multiple: of |p| that is nearest to what full drive makes. stalled: dual steps in a row that did little.\n"
                            "bound, objective: [Pa^2] for unit limits. held: transducers at their limit.");
    w.def(nb::init<Index, Index>(), nb::arg("M"), nb::arg("N"));
    share(w, "p", &Workspace::p, "def p(self, /) -> pacinian.types.Complexes");
    share(w, "free", &Workspace::free, "def free(self, /) -> pacinian.types.Flags");
    share(w, "y", &Workspace::y, "def y(self, /) -> pacinian.types.Complexes");
    share(w, "h", &Workspace::h, "def h(self, /) -> pacinian.types.Singles");
    share(w, "made", &Workspace::made, "def made(self, /) -> pacinian.types.Floats");
    share(w, "tile", &Workspace::tile, "def tile(self, /) -> pacinian.types.Singles");
    w.def_rw("cost", &Workspace::cost);
    w.def_ro("error", &Workspace::error).def_ro("multiple", &Workspace::multiple).def_ro("stalled", &Workspace::stalled);
    w.def_ro("bound", &Workspace::bound).def_ro("objective", &Workspace::objective).def_ro("held", &Workspace::held);
    w.def("restart_dual", &Workspace::restart_dual, "Count the dual steps that did little from 0.");
    w.def("restart_primal", &Workspace::restart_primal, "Start the primal steps with the default damping.");

    nb::class_<RegionWorkspace> r(m, "RegionWorkspace",
                                  "Memory for regions with M samples and N transducers, and what `solve_region` found.\n\n"
                                  "sizes: number of samples of each block of the preconditioner; empty for no preconditioner. stride: every so many\n"
                                  "transducers one is in it. order: the samples of the first block, then those of the next, (M,); the caller writes\n"
                                  "them. factor: of each block, real and imaginary part, (2, K, K), K = its size rounded up to 2. h, made: as in\n"
                                  "`Workspace`. met: whether the steps have converged. bound, objective: D(y), and\n"
                                  "1/2 sum_m |p - B h|_m^2 / D_m + mu/2 ||h||^2. held: gains at their limit.");
    r.def(nb::init<Index, Index, View<const i8, 1>, Index>(), nb::arg("M"), nb::arg("N"), nb::arg("sizes"), nb::arg("stride"));
    share(r, "order", &RegionWorkspace::order, "def order(self, /) -> pacinian.types.Indices");
    share(r, "h", &RegionWorkspace::h, "def h(self, /) -> pacinian.types.Singles");
    share(r, "made", &RegionWorkspace::made, "def made(self, /) -> pacinian.types.Floats");
    share(r, "factor", &RegionWorkspace::factor, "def factor(self, /) -> pacinian.types.Singles");
    r.def_ro("met", &RegionWorkspace::met).def_ro("held", &RegionWorkspace::held);
    r.def_ro("bound", &RegionWorkspace::bound).def_ro("objective", &RegionWorkspace::objective);
    r.def("restart", &RegionWorkspace::restart, nb::arg("same"),
          "Begin anew. same: whether to start with the last preconditioner, because the samples are the same or have moved alike.");
}

}  // namespace pacinian::lagrange
