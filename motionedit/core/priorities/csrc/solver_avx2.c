/* The layered solver once more, for processors with AVX2: four frames side by side. Not with gcc on Windows, whose stack is
   not aligned for such vectors. */

#include "layered.h"

#if defined(__GNUC__) && defined(__x86_64__) && (defined(__clang__) || !defined(_WIN32))
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2")
#endif
#define FOUR_LANES
#define solve_frames solve_frames_avx2
#define row_kind row_kind_avx2
#include "solver.c"
#ifdef __clang__
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif

int has_avx2(void)
{
    return __builtin_cpu_supports("avx2");
}
#else
int has_avx2(void)
{
    return 0;
}

int solve_frames_avx2(const Problem *problem, int64_t begin, int64_t end)
{
    return solve_frames(problem, begin, end);
}
#endif
