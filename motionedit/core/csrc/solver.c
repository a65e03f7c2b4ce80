/* The layered solver, in one piece: compiled for what every processor has here, and for wider ones in solver_avx2.c. */

#include "batch.h"
#include "rotations.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "body.c"
#include "tasks.c"

#include "algebra.c"
#include "layers.c"
#include "solve.c"
