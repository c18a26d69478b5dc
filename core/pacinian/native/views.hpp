// Arrays of NumPy as kernels see them: a pointer and a shape, contiguous, of exactly this type; never a copy.
#pragma once
#include <complex>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

#define PY_ARRAY_UNIQUE_SYMBOL pacinian_numpy
#define NPY_NO_DEPRECATED_API NPY_2_0_API_VERSION
#define NPY_TARGET_VERSION NPY_2_0_API_VERSION
#include <nanobind/nanobind.h>
#include <numpy/arrayobject.h>

namespace nb = nanobind;

namespace pacinian {

using Index = std::ptrdiff_t;
using f4 = float;
using f8 = double;
using c8 = std::complex<float>;
using c16 = std::complex<double>;
using i4 = std::int32_t;
using i8 = std::int64_t;

// T: of an element; const where it is only read. D: dimensions.
template <typename T, int D>
struct View {
    T* data = nullptr;
    Index shape[D] = {};

    Index size() const {
        Index n = 1;
        for (int d = 0; d < D; ++d) n *= shape[d];
        return n;
    }
    T& operator[](Index i) const {
        static_assert(D == 1, "has more than one dimension: use (i, j)");
        return data[i];
    }
    T& operator()(Index i, Index j) const {
        static_assert(D == 2, "has not two dimensions");
        return data[i * shape[1] + j];
    }
    T& operator()(Index i, Index j, Index k) const {
        static_assert(D == 3, "has not three dimensions");
        return data[(i * shape[1] + j) * shape[2] + k];
    }
    T* row(Index i) const {
        static_assert(D >= 2, "has no rows");
        return data + i * (D == 2 ? shape[1] : shape[1] * shape[D - 1]);
    }
    T* row(Index i, Index j) const {
        static_assert(D == 3, "has not three dimensions");
        return data + (i * shape[1] + j) * shape[2];
    }
    operator View<const T, D>() const {
        View<const T, D> other;
        other.data = data;
        for (int d = 0; d < D; ++d) other.shape[d] = shape[d];
        return other;
    }
};

// Raise ValueError unless the shapes fit. Indices in arrays are not checked: they come from our own code.
inline void require(bool fits, const char* what) {
    if (!fits) throw std::invalid_argument(what);
}

// Give a kernel to Python: it runs without the interpreter lock. names: of its arguments.
template <typename Function, typename... Names>
void kernel(nanobind::module_& m, const char* name, Function function, const char* doc, Names... names) {
    m.def(name, function, nanobind::arg(names)..., nanobind::call_guard<nanobind::gil_scoped_release>(), doc);
}

// To be called first in a module.
#ifndef NO_IMPORT_ARRAY
inline void start_numpy() {
    if (_import_array() < 0) throw nanobind::python_error();
}
#endif

// A group of kernels, as a module within the module.
inline void group(nanobind::module_& m, const char* name, void (*define)(nanobind::module_&)) {
    nanobind::module_ part = m.def_submodule(name);
    define(part);
}

}  // namespace pacinian

namespace nanobind::detail {

// As NumPy calls the kind of an element; with its size that is all: there may be two whole numbers of 8 bytes.
template <typename T>
constexpr char dtype_kind() {
    using Plain = std::remove_const_t<T>;
    if constexpr (std::is_same_v<Plain, bool>) return 'b';
    else if constexpr (std::is_floating_point_v<Plain>) return 'f';
    else if constexpr (std::is_integral_v<Plain>) return std::is_signed_v<Plain> ? 'i' : 'u';
    else return 'c';
}

// As Python knows it: see pacinian/types.py.
template <typename T>
constexpr auto dtype_name() {
    using Plain = std::remove_const_t<T>;
    if constexpr (std::is_same_v<Plain, bool>) return const_name("pacinian.types.Flags");
    else if constexpr (std::is_same_v<Plain, float>) return const_name("pacinian.types.Singles");
    else if constexpr (std::is_same_v<Plain, double>) return const_name("pacinian.types.Floats");
    else if constexpr (std::is_same_v<Plain, std::complex<float>>) return const_name("pacinian.types.Gains");
    else if constexpr (std::is_same_v<Plain, std::complex<double>>) return const_name("pacinian.types.Complexes");
    else if constexpr (std::is_same_v<Plain, std::uint8_t>) return const_name("pacinian.types.Bytes");
    else if constexpr (std::is_same_v<Plain, std::uint16_t>) return const_name("pacinian.types.Levels");
    else if constexpr (std::is_same_v<Plain, std::int32_t>) return const_name("pacinian.types.Numbers");
    else return const_name("pacinian.types.Longs");
}

template <typename T, int D>
struct type_caster<pacinian::View<T, D>> {
    using Value = pacinian::View<T, D>;
    static constexpr auto Name = dtype_name<T>();
    template <typename> using Cast = Value;
    template <typename> static constexpr bool can_cast() { return true; }
    explicit operator Value() { return value; }
    Value value;

    // An array is of the caller, who keeps it; nothing is converted.
    bool from_python(handle source, std::uint32_t, cleanup_list*) noexcept {
        constexpr int needed = NPY_ARRAY_C_CONTIGUOUS | NPY_ARRAY_ALIGNED | (std::is_const_v<T> ? 0 : NPY_ARRAY_WRITEABLE);
        if (!PyArray_Check(source.ptr())) return false;
        auto* array = reinterpret_cast<PyArrayObject*>(source.ptr());
        if (PyArray_NDIM(array) != D || (PyArray_FLAGS(array) & needed) != needed) return false;
        if (PyArray_DESCR(array)->kind != dtype_kind<T>() || PyArray_ITEMSIZE(array) != sizeof(T) || PyArray_ISBYTESWAPPED(array))
            return false;
        value.data = static_cast<T*>(PyArray_DATA(array));
        for (int d = 0; d < D; ++d) value.shape[d] = PyArray_DIM(array, d);
        return true;
    }
};

}  // namespace nanobind::detail
