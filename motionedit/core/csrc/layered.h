/* The layered solver in C: its data, and who does what.

   The method is that of layers.py, homing.py and layered_numpy.py in core/ik, frame by frame; what differs is
   how the same numbers are found. The Jacobian J of a frame is never formed. Every row of every task is a force f at a
   point and a torque t, shared by the columns of a chain:

       row . w  =  sum_j w_j . (l_j x f + t) + w_root . f,        l_j = point - p_j

   so G = J J^T needs sums over common columns of the levers l_j alone, J v and J^T y one sweep each. Everything else
   happens among the R rows, and in the space of the orthonormal rows Q that they span ("rank space"):

       C_l = J_l Q_above^T,   S_l = G_ll - C_l C_l^T,   Q_l = B_l (J_l - C_l Q_above)

   Lengths are metres at leg length 0.85 m, angles radians. Symbols: F frames of a motion, N of them to be solved,
   J joints, P of them with translations, K columns (joints that turn), n = 3 K + 3 unknowns, T tasks, R rows, L layers,
   H hinges. */

#ifndef MOTIONEDIT_LAYERED_H
#define MOTIONEDIT_LAYERED_H

#include <stddef.h>
#include <stdint.h>

enum { POSITION, ORIENTATION, CENTER_OF_MASS, AIM, POSTURE };

/* The joints that matter, an ancestor before its descendants. */
typedef struct {
    int64_t joint;       /* its index in the skeleton */
    int64_t parent;      /* a node, or -1 */
    int64_t translation; /* its row among the translated joints, or -1 */
    int64_t column;      /* its column, or -1 */
    double offset[3];    /* where it has no translation */
    double share;        /* of the body's mass */
    double center[3];    /* where that mass is, in the joint's frame */
} Node;

typedef struct {
    int64_t kind, layer, rows, node, base; /* base: a node, or -1 */
    int64_t root, base_root;               /* whether the root's translation moves the point, the base */
    int64_t axes[3];                       /* which of the targets' axes count, `rows` of them */
    int64_t width;                         /* numbers a target has: 3, 4, or 0 for none */
    double weight;
    double offset[3];         /* of the point, in its joint's frame */
    double measure[3][3];     /* the axes that count, rows */
    double axis[3];           /* what an aim looks along, in its joint's frame */
    const double *targets;    /* shape (N, width) */
    const uint8_t *recruited; /* shape (K,) */
} Task;

typedef struct {
    int64_t column;
    double axis[3]; /* in its joint's frame */
    double limits[2];
} Hinge;

typedef struct {
    int64_t nodes, columns, tasks, hinges, layers, joints, translated, rows;
    int64_t root, in_order, moves_root, pulls_root, max_iterations;
    double attraction;
    const Node *node;
    const int64_t *column_node; /* shape (K,) */
    const Task *task;
    const Hinge *hinge;
    const int64_t *frames;             /* shape (N,): the motion's frames that are solved */
    const double *reference_rotations; /* shape (F, J, 4) */
    const double *reference_root;      /* shape (F, 3), where the root is pulled */
    /* in: where each frame starts; out: the solution */
    double *rotations;    /* shape (F, J, 4) */
    double *translations; /* shape (F, P, 3) */
    int64_t *iterations;  /* shape (N,) */
    uint8_t *converged;   /* shape (N,); in: frames that are left as they are */
    int64_t *ranks;       /* shape (N, L) */
} Problem;

/* Solve frames begin to end - 1; 0, or -1 where memory ran out. */
int solve_frames(const Problem *problem, int64_t begin, int64_t end);

/* motion.c: whole motions */
void world_poses(const int64_t *parents, const int64_t *places, const double *offsets, int64_t frames, int64_t joints,
    int64_t translated, const double *rotations, const double *translations, double *positions, double *world);
int smooth_rotations(const double *before, const double *after, int64_t frames, int64_t joints, int64_t first,
    int64_t radius, const double *taps, double none, double *out);

/* What a task pulls at: a force and a torque for each of its rows, on the columns of a chain. */
typedef struct {
    int count, root;
    int *columns;                     /* shape (count,), growing */
    double *levers;                   /* shape (count, 3) */
    double force[3][3], torque[3][3]; /* per row */
    int has_force, has_torque, plain; /* plain: the world's axes times one weight, and no torque */
} Part;

typedef struct {
    int parts, first_row;
    Part part[2]; /* the point's, and the base's */
} Pull;

/* The columns that two parts share, without hinges: places in the one and in the other. */
typedef struct {
    int task[2], part[2], count;
    int *places; /* shape (count, 2) */
} Shared;

/* One layer among the rows and in rank space. */
typedef struct {
    int first_row, rows, first_rank, rank;
    int triangular; /* row q of B has q + 1 numbers, else all */
    int *order;     /* shape (rows,): B's columns are the layer's rows in this order */
    double *B;      /* shape (rank, rows) */
} Layer;

/* A frame on its way; all arrays are a thread's own. */
typedef struct {
    const Problem *problem;
    double *positions, *rotations;      /* world, shapes (nodes, 3), (nodes, 9) */
    double *mass_moments, *mass_shares; /* of subtrees, shapes (nodes, 3), (nodes,) */
    double center[3];                   /* of the whole body */
    Pull *pulls;
    Shared *shared;
    int shared_count, weighs;
    int *column_hinge;                              /* shape (K,): its hinge, or -1 */
    int *hinge_felt, *hinge_felt_count;             /* shapes (H, R), (H,): the rows that feel it turn */
    double *hinge_axes, *hinge_angles, *hinge_rows; /* shapes (H, 3), (H,), (H, R) */
    uint8_t *hinge_free, *hinge_free_before;        /* shape (H,) */
    double *hinge_fixed;                            /* rad, shape (H,) */
    Layer *layers;
    double *errors, *G, *G_frozen, *C; /* shapes (R,), (R, R), (R, R), (R, R) */
    const double *G_free;              /* G, or G_frozen where hinges are on their limits */
    double *c, *Qz, *scratch_rank;     /* rank space, shape (R,) */
    double *scratch_rows;              /* shape (5 R,) */
    double *algebra;                   /* scratch of the factorization */
    double *z, *home, *step, *fast;    /* shape (n,) */
    double *home_before, *step_before; /* shape (n,) */
    int remembers;
} Frame;

/* body.c: kinematics */
const double *parent_rotation(const Frame *frame, int64_t node);
void world_quaternion(const Frame *frame, const double *local, int64_t node, double *q);
void forward(Frame *frame, const double *local, const double *translations);
void attraction(Frame *frame, const double *local, const double *translations, int64_t own);
void hinge_state(Frame *frame, const double *local);
double apply_step(Frame *frame, double *local, double *translations);

/* tasks.c: errors, and rows as forces and torques */
void *take(char **memory, size_t *needed, size_t bytes);
void lay_out_tasks(Frame *frame, char **memory, size_t *needed);
void evaluate_tasks(Frame *frame, const double *local, int64_t at);
void gram(Frame *frame);
void add_hinge(const Frame *frame, int64_t h, double sign, double *G);
void rows_times(const Frame *frame, const double *v, double *out);
void add_rows_transposed(const Frame *frame, const double *y, double *out);

/* layers.c: the pass down the layers */
void descend(Frame *frame, double anneal);
void into_rank_space(const Frame *frame, const double *Jv, double *Qv);
void out_of_rank_space(const Frame *frame, double *q, double *y);

/* algebra.c: small dense matrices, row-major */
void damped_factor(Layer *layer, double *S, const double *b, double largest, double *c, double *scratch);

/* out += factor a */
static inline void add_multiple(double *restrict out, double factor, const double *restrict a, int n)
{
    for (int i = 0; i < n; i++)
        out[i] += factor * a[i];
}

/* a . b; four sums at a time do not wait for each other. */
static inline double dot_product(const double *a, const double *b, int n)
{
    double w = 0.0, x = 0.0, y = 0.0, z = 0.0;
    int i = 0;
    for (; i + 4 <= n; i += 4)
        w += a[i] * b[i], x += a[i + 1] * b[i + 1], y += a[i + 2] * b[i + 2], z += a[i + 3] * b[i + 3];
    for (; i < n; i++)
        w += a[i] * b[i];
    return (w + x) + (y + z);
}
size_t factor_scratch(int k);

#define METRES_PER_RADIAN 0.3

#endif
