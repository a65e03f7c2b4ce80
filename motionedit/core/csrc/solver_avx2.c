/* The layered solver once more, for processors with AVX2: four frames side by side. */

#include "layered.h"

#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__)
#pragma GCC target("avx2")
#define solve_frames solve_frames_avx2
#include "solver.c"

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
