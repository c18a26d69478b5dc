// Squares, of numbers and of complex numbers' sizes.
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
