// What this processor, and the operating system, can do.
#pragma once
#if defined(__x86_64__) || defined(_M_X64)
#include <cpuid.h>
#endif

namespace pacinian {

// The level of x86-64: 4 with AVX-512, 3 with AVX2 and FMA, else 1; of other processors 0. Zig has no __builtin_cpu_supports.
inline int level() {
#if defined(__x86_64__) || defined(_M_X64)
    unsigned a, b, c, d;
    constexpr unsigned saved = 1u << 27, fused = 1u << 12, avx2 = 1u << 5;
    constexpr unsigned avx512 = 1u << 16 | 1u << 17 | 1u << 28 | 1u << 30 | 1u << 31;  // F, DQ, CD, BW, VL
    if (!__get_cpuid(1, &a, &b, &c, &d) || !(c & saved) || !(c & fused)) return 1;
    unsigned low, high;
    __asm__ volatile("xgetbv" : "=a"(low), "=d"(high) : "c"(0));  // the registers that the system keeps
    if ((low & 0x06) != 0x06 || !__get_cpuid_count(7, 0, &a, &b, &c, &d) || !(b & avx2)) return 1;
    return (low & 0xe0) == 0xe0 && (b & avx512) == avx512 ? 4 : 3;
#else
    return 0;
#endif
}

}  // namespace pacinian
