/* The layered solver once more, for processors with AVX-512: eight frames side by side. */

#include "layered.h"
#include "wide.h"

#ifdef WIDE
#define WIDTH 8
#define solve_frames solve_frames_avx512
#define row_kind row_kind_avx512
BEGIN_WIDE("avx512f,avx512dq,avx512vl")
#include "solver.c"
END_WIDE

int has_avx512(void)
{
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl");
}
#endif
