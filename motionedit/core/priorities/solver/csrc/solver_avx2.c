/* The layered solver once more, for processors with AVX2: four frames side by side. */

#include "layered.h"
#include "wide.h"

#ifdef WIDE
#define WIDTH 4
#define solve_frames solve_frames_avx2
#define row_kind row_kind_avx2
BEGIN_WIDE("avx2")
#include "solver.c"
END_WIDE

int has_avx2(void)
{
    return __builtin_cpu_supports("avx2");
}
#endif
