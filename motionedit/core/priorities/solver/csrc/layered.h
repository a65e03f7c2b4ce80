/* What the layered solver is given, and what the module offers of it.

   Lengths are metres at leg length 0.85 m, angles radians. Symbols: F frames of a motion, N of them to be solved,
   J joints, P of them with translations, K columns (joints that turn), H of them hinges, T tasks, R rows, L layers. */

#ifndef MOTIONEDIT_LAYERED_H
#define MOTIONEDIT_LAYERED_H

#include <stddef.h>
#include <stdint.h>

/* Structures that come from Python are laid out there by the tables of solve_module.c, field by field, by their names. */

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
    int64_t kind, layer, rows, node, base; /* kind: in the table of row_kinds.c; base: a node, or -1 */
    int64_t root, base_root;               /* whether the root's translation moves the point, the base */
    int64_t one_sided;                     /* whether its rows ask for J w >= e alone */
    int64_t axes[3];                       /* which of the targets' axes count, `rows` of them */
    int64_t width;                         /* numbers a target has: 1, 3 or 4 */
    int64_t targets;                       /* where they begin among all targets: shape (N, width) */
    double weight;
    double offset[3];      /* of the point, in its joint's frame */
    double base_offset[3]; /* of the point that a distance is to, in the base's frame */
    double measure[3][3];  /* the axes that count, rows */
    double axis[3];        /* what an aim looks along, in its joint's frame */
} Task;

/* A joint of two hinges has them one after the other: the first turns about an axis of the parent's frame, the second
   about one of its own. */
typedef struct {
    int64_t column;
    int64_t second; /* whether it is the second one of its column */
    double axis[3]; /* in the parent's frame; of a second one in its joint's */
    double upper[3],
        lower[3]; /* its angle is the one about the axis from `upper`, in the parent's frame, to `lower`, in
                                  its joint's */
    double limits[2];
} Hinge;

/* A cone that a column without hinges keeps to: see cones.py. */
typedef struct {
    int64_t column;
    double center[4]; /* the local rotation in its middle */
    double along[3];  /* the bone, in the joint's frame */
    double middle[3]; /* the bone in the middle of the cone, in the parent's frame */
    double halves[2]; /* rad: of the swing, of the twist */
    double least;     /* the cosine of half the lesser: a turn with a larger one is within both */
} Limit;

/* Those of core/priorities/solver/constants.py, where each is explained. */
typedef struct {
    double largest_error, largest_soft_error, largest_way_back, largest_turn, stop_step, stop_left, stop_error,
        largest_ratio, gain_decay, on_limit;
    double rank_tolerance, least_scale, limb, largest_task_share, largest_factor, no_change, no_direction, beyond_limit,
        same_error, far_error, met_without_limits, metres_per_radian, on_side;
    int64_t full_gain_iterations, hasty_iterations, annealed_iterations, stale_iterations, limit_rounds, sided_rounds;
} Constants;

/* How many there are of what, and how frames are solved. */
typedef struct {
    int64_t nodes, columns, tasks, hinges, limits, layers, joints, translated, rows, targets;
    int64_t root, moves_root, max_iterations, ends_early; /* root: a node, or -1 */
    double attraction;
} Settings;

typedef struct {
    Settings of;
    Constants constants;
    int64_t count, motion_frames, levels; /* N, F, and how many priorities are told of */
    int in_order, pulls_root;
    const Node *node;
    const int64_t *column_node; /* shape (K,) */
    const double *mobility;     /* shape (K + 1,): of the columns, and of the root's shift */
    const Task *task;
    const Hinge *hinge;
    const Limit *limit;
    const uint8_t *recruited;          /* shape (T, K) */
    const double *targets;             /* task by task */
    const int64_t *frames;             /* shape (N,): the motion's frames that are solved */
    const double *reference_rotations; /* shape (F, J, 4) */
    const double *reference_root;      /* shape (F, 3), where the root is pulled */
    const double *softness; /* shape (N, L): lambda^2 of a layer that gives way, 0 of one that shall be met */
    const int64_t *level;   /* shape (L,): under which of the priorities a layer is told of */
    /* in: where each frame starts; out: the solution, at the frames that are solved */
    double *rotations;    /* shape (F, J, 4) */
    double *translations; /* shape (F, P, 3) */
    int64_t *iterations;  /* shape (F,) */
    uint8_t *converged;   /* shape (F,); in: frames that are left as they are */
    int64_t *ranks;       /* shape (F, levels) */
    double *left; /* shape (F, levels): the largest error of any row, its weight taken off, before the last step */
} Problem;

/* What is known of a kind of rows. */
typedef struct {
    const char *name;  /* in Python */
    int force, torque; /* whether its rows push, and twist */
    int weighs;        /* whether they pull at all that carries mass, instead of at a node's chain */
    int rows;          /* of a task; 0: the axes that count, one to three */
    int holds;         /* whether they are all unknowns of a node's column, and nothing else */
    int spans;         /* whether they are between two points: a base there must be */
    int width;         /* numbers of a target */
} RowKind;

/* A kind of rows, NULL after the last. */
const RowKind *row_kind(int64_t kind);

/* sense.c: what makes no sense, NULL where all does; the second once the first has found nothing, and sizes fit. */
const char *settings_fault(const Settings *of);
const char *problem_fault(const Problem *problem);

/* Solve frames begin to end - 1; 0, or -1 where memory ran out. All do the same, to the bit: the others are for
   processors that have wider vectors, and only where WIDE is (wide.h). */
int solve_frames(const Problem *problem, int64_t begin, int64_t end);
int has_avx2(void);
int solve_frames_avx2(const Problem *problem, int64_t begin, int64_t end);
int has_avx512(void);
int solve_frames_avx512(const Problem *problem, int64_t begin, int64_t end);

#endif
