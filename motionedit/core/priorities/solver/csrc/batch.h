/* The layered solver in C: a batch of frames on their way, side by side in lanes, and who does what with it.

   The method is that of layers.py, homing.py, numpy_step.py and numpy_solver.py above this folder; what differs is how
   the same numbers are found. The unknowns of a step are a world-axis increment for each column, or the angles of its
   hinges alone where it has one or two, and the root's shift, all over their mobility: n = 3 K + 3 without hinges. The
   Jacobian J of a frame is never formed. Every row of every task is a force f at a point and a torque t, shared by the
   columns of a chain:

       row . w  =  sum_j w_j . (l_j x f + t) + w_root . f,        l_j = point - p_j

   so G = J J^T needs sums over common columns of the levers l_j alone, J v and J^T y one sweep each. Everything else
   happens among the R rows, and in the space of the orthonormal rows Q that they span ("rank space"), a number a row,
   0 where a row adds no direction to those before:

       G = M M^T,    J = M Q,    Q_l = B_l (J_l - M_l Q_above)

   Rows that take no part in a lane, one-sided ones that are on their side, are zeros of G there. Joints that a layer of
   postures holds are no rows: held.c takes them out. */

#ifndef MOTIONEDIT_BATCH_H
#define MOTIONEDIT_BATCH_H

#include "../../../csrc/lanes.h"
#include "layered.h"

/* What a task pulls at: a force and a torque for each of its rows, on the columns of a chain. */
typedef struct {
    int count, root;
    int *columns;                     /* shape (count,), growing */
    V *levers;                        /* shape (count, 3), times the columns' mobility */
    V force[3][3], torque[3][3];      /* per row */
    int has_force, has_torque, plain; /* plain: the world's axes times one weight, and no torque */
} Part;

typedef struct {
    int parts, rows, first_row; /* of a task that holds a joint: none, and where its errors are among `held_errors` */
    Part part[2];               /* the point's, and the base's */
} Pull;

/* The columns that two parts share, without hinges: places in the one and in the other. */
typedef struct {
    int task[2], part[2], count;
    int *places;     /* shape (count, 2) */
    double mobility; /* the sum of its squares */
} Shared;

/* A joint that a layer of postures holds: its rows are its own unknowns, which leave the system with them. */
typedef struct {
    int unknown, count, hinge, error; /* its first unknown, how many; its hinge or -1; its errors among `held_errors` */
    int again;                        /* whether a layer above holds it already */
    double scale;                     /* of its rows */
} Held;

/* One layer among the rows and in rank space. */
typedef struct Layer {
    int first, rows;
    int held;            /* joints that it holds; it has no rows then */
    Held *joints;        /* shape (held,) */
    struct Layer *above; /* all rows above those, as one layer below them */
    int full;            /* whether B has numbers beside its lower triangle: where a lane's rank was in doubt */
    V *B;                /* shape (rows, rows) */
    V rank;
    V soft;  /* lambda^2 of the pull among its rows, 0 where it shall be met */
    V error; /* its length when it last changed */
} Layer;

/* All arrays are a thread's own. */
typedef struct {
    const Problem *problem;
    int64_t at[LANES], iteration[LANES]; /* which of the N frames a lane has, or -1; and its iteration */
    V moved_before;                      /* rad or m, in the iteration before */
    V gain, anneal;                      /* of the attraction; of it and of the lower layers, at the end */
    Mask steady;                         /* where what is left may be out of reach */
    V stale;                             /* iterations in which what is missed stayed so */
    int64_t annealed_from[LANES];        /* the iteration from which on the gain and the lower layers are annealed */
    Mask nearly, remembers;
    V *local, *reference, *offsets; /* quaternions of nodes and columns; where nodes are in their parents */
    V reference_root[3], *targets;  /* shape (T, 4) */
    V *positions, *rotations;       /* world, shapes (nodes, 3), (nodes, 9) */
    V identity[9];                  /* the rotation of what is above all nodes */
    V *mass_moments, center[3];     /* of subtrees, shape (nodes, 3), and of the whole body */
    double *mass_shares;            /* of subtrees, shape (nodes,) */
    int weighs, unknowns, rows;     /* n; R, those that are none of joints that are held */
    Pull *pulls;
    Shared *shared;
    int shared_count;
    int *column_hinge, *column_hinges;         /* shape (K,): its first hinge, or -1; how many it has */
    int *column_unknown;                       /* shape (K,): its first unknown */
    int *hinge_felt, *hinge_felt_count;        /* shapes (H, R), (H,): the rows that feel it turn */
    V *hinge_axes, *hinge_angles, *hinge_rows; /* shapes (H, 3), in the world; (H,), (H, R) */
    V *hinge_fixed;                            /* rad, shape (H,) */
    Mask *hinge_free, *hinge_free_before;      /* shape (H,) */
    int sided;                                 /* how many rows are one-sided */
    int *sided_row;                            /* shape (R,): which */
    Mask *active, *active_before;              /* shape (R,): which rows take part: all that are not one-sided */
    /* Cones, two a limit: its swing, and its twist. */
    Mask limited;                 /* lanes that keep to them */
    V *cone_turns, *cone_rates;   /* shapes (2 C, 3), (2 C,): directions in the world, what a turn about one changes */
    V *cone_values, *cone_fixed;  /* shape (2 C,): rad; the turns over their mobility that set them on their limits */
    V *cone_rows;                 /* shape (2 C, R), of those that are on their limits in some lane */
    Mask *cone_on, *cone_before;  /* shape (2 C,): which are on their limits, and were in the iteration before */
    int64_t before_limits[LANES]; /* iterations without them */
    Layer *layers;
    Layer **chain; /* the layers that make up rank space, from the first row on */
    int chain_count;
    int holds, held;   /* whether any layer holds joints; how many, all together */
    int is_explicit;   /* whether a layer has: the rows of rank space are then those of X, and not by their levers */
    int *held_unknown; /* shape (n,): a layer's */
    int *holder;       /* shape (n,): the first layer that holds an unknown, or -1 */
    V *held_errors;    /* shape (held, 3) */
    V *J, *X;          /* shape (R, n) */
    V *base;           /* shape (n,): the step of all layers up to the last that holds joints */
    V *held_pull;      /* shape (R,): X z */
    V *G_held, *held_scratch;
    V *errors, *G, *G_frozen;     /* shapes (R,), (R, R), (R, R): blocks on and below the diagonal */
    const V *G_free;              /* G, or G_frozen: without hinges on their limits, rows that take no part */
    V *M;                         /* shape (R, R), lower triangle of layers */
    V *c, *Qz;                    /* rank space, shape (R,) */
    V *scratch_rows, *algebra;    /* shape (6, R); a layer's factorization */
    Mask *dependent;              /* shape (R,): a layer's rows that got no direction */
    int *dependent_row;           /* those of them that got none in some lane */
    V *z, *home, *step, *fast;    /* shape (n,) */
    V *home_before, *step_before; /* shape (n,) */
} Batch;

#endif
