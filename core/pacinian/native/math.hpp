// What kernels share: squares, sizes, and products of complex numbers that the compiler can vectorise.
#pragma once
#include <cmath>

#include "views.hpp"

namespace pacinian {

template <typename T>
inline T square(T x) {
    return x * x;
}

template <typename T>
inline T power(std::complex<T> z) {  // |z|^2
    return z.real() * z.real() + z.imag() * z.imag();
}

}  // namespace pacinian
