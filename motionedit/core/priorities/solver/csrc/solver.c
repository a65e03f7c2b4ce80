/* The layered solver in one piece, compiled for what every processor has, and in solver_avx2.c and solver_avx512.c for wider vectors. */

#include "../../../csrc/jacobi.h"
#include "batch.h"
#include "../../../csrc/rotations.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "body.c"
#include "limits.c"
#include "row_kinds.c"
#include "rows.c"
#include "matrices.c"
#include "algebra.c"
#include "rank_space.c"
#include "held_rows.c"
#include "held_above.c"
#include "held.c"
#include "layers.c"
#include "pulls.c"
#include "layout.c"
#include "descent.c"
#include "homing.c"
#include "iteration.c"
#include "solve.c"
