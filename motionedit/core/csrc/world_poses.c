/* Forward kinematics of whole motions: frames side by side, for a joint waits for its parent, but no frame for another. */

#include "motion.h"
#include "rotations.h"

#include <string.h>

/* `n` numbers of the lanes' frames, which are so many numbers apart. */
static inline void take(const double *from, int64_t apart, int n, V *to)
{
    for (int a = 0; a < n; a++) {
        V numbers = all(0.0);
        for (int lane = 0; lane < LANES; lane++)
            LANE(numbers, lane) = from[lane * apart + a];
        to[a] = numbers;
    }
}

static inline void give(const V *from, int64_t apart, int n, double *to)
{
    for (int lane = 0; lane < LANES; lane++)
        for (int a = 0; a < n; a++)
            to[lane * apart + a] = LANE(from[a], lane);
}

/* From a parent's place and turn to those of a joint, whose own are `own` and `turn`. */
static inline void go_on(V *p, V *q, const V *own, const V *turn)
{
    V t[3], s[3];
    cross(q + 1, own, t); /* v + 2 w (u x v) + 2 u x (u x v) */
    t[0] *= 2.0, t[1] *= 2.0, t[2] *= 2.0;
    cross(q + 1, t, s);
    for (int a = 0; a < 3; a++)
        p[a] = p[a] + own[a] + q[0] * t[a] + s[a];
    q_multiply(q, turn, q);
}

/* As world_poses, of the frames of the lanes: the arrays begin at the first, the next is `apart` frames from it. */
static inline void pose_frames(const int64_t *parents, const int64_t *places, const double *offsets, int64_t apart,
    int64_t joints, int64_t translated, const double *rotations, const double *translations, double *positions,
    double *world)
{
    const int64_t next = apart * joints;
    V p[3], q[4], own[3], turn[4];
    memset(p, 0, sizeof p), memset(q, 0, sizeof q); /* a root has no parent, which compilers do not see */
    for (int64_t j = 0; j < joints; j++) {
        for (int a = 0; a < 3; a++)
            own[a] = all(offsets[3 * j + a]);
        if (places[j] >= 0)
            take(translations + 3 * places[j], 3 * apart * translated, 3, own);
        take(rotations + 4 * j, 4 * next, 4, turn);
        if (parents[j] < 0)
            memcpy(p, own, sizeof p), memcpy(q, turn, sizeof q);
        else {
            /* Mostly the one before is the parent. */
            if (parents[j] != j - 1)
                take(positions + 3 * parents[j], 3 * next, 3, p), take(world + 4 * parents[j], 4 * next, 4, q);
            go_on(p, q, own, turn);
        }
        give(p, 3 * next, 3, positions + 3 * j), give(q, 4 * next, 4, world + 4 * j);
    }
}

/* World transforms of every joint: p_j = p_parent + R_parent t_j, q_j = q_parent q_local.

   parents: shape (J,), -1 for the root. places: shape (J,), a joint's row of the translations, or -1. offsets: (J, 3).
   rotations: (N, J, 4), translations: (N, P, 3). Out: positions (N, J, 3), world (N, J, 4). */
void world_poses(const int64_t *parents, const int64_t *places, const double *offsets, int64_t frames, int64_t joints,
    int64_t translated, const double *rotations, const double *translations, double *positions, double *world)
{
    for (int64_t f = 0, count; f < frames; f += count) {
        /* Too few are left: every lane does the same frame. */
        const int64_t apart = frames - f < LANES ? 0 : 1;
        count = apart ? LANES : 1;
        pose_frames(parents, places, offsets, apart, joints, translated, rotations + 4 * f * joints,
            translations + 3 * f * translated, positions + 3 * f * joints, world + 4 * f * joints);
    }
}
