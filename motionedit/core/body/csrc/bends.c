/* How knees and elbows bend: what motionedit/core/body/bends.py does in many calls of numpy, in two loops over frames. */

#include "body.h"

#include <float.h>
#include <string.h>

#define ONE_LANE
#include "../../csrc/rotations.h"

/* A limb at one frame. */
typedef struct {
    const double *top, *joint, *end, *turn, *parent_turn;
} LimbPose;

static LimbPose pose_of(const Poses *poses, int64_t frame, const int64_t *limb)
{
    return (LimbPose){joint_place(poses, frame, limb[0]), joint_place(poses, frame, limb[1]),
        joint_place(poses, frame, limb[2]), joint_turn(poses, frame, limb[1]), joint_turn(poses, frame, limb[3])};
}

/* sum += q^-1 v */
static void add_unturned(const double *q, const double *v, double *sum)
{
    double inverse[4], own[3];
    q_conjugate(q, inverse);
    q_turn(inverse, v, own);
    add(sum, own);
}

static void shorten(double *v, double length)
{
    for (int a = 0; a < 3; a++)
        v[a] /= length;
}

/* The sum of axes, and in how many frames they were seen. */
typedef struct {
    double sum[3];
    int64_t frames;
} Axis;

/* Take a frame of a limb into its sums: its bones seen from its parent's and its joint's frames, and upper x lower of
   the unit bones seen from the parent's, where its length, the sine, says that the limb is bent, and where clearly.
   Returns whether it is straight. */
static int take_frame(const LimbPose *at, int counts, const Limbs *limbs, double *bones, Axis *all, Axis *clear)
{
    const double upper[3] = {at->joint[0] - at->top[0], at->joint[1] - at->top[1], at->joint[2] - at->top[2]};
    const double lower[3] = {at->end[0] - at->joint[0], at->end[1] - at->joint[1], at->end[2] - at->joint[2]};
    const double both = sqrt(dot(upper, upper)) * sqrt(dot(lower, lower));
    double side[3];
    cross(upper, lower, side);
    shorten(side, both > DBL_MIN ? both : DBL_MIN);
    const double sine = sqrt(dot(side, side));
    if (counts) {
        add_unturned(at->parent_turn, upper, bones), add_unturned(at->turn, lower, bones + 3);
        if (sine > limbs->bent)
            add_unturned(at->parent_turn, side, all->sum), all->frames++;
        if (sine > limbs->clear)
            add_unturned(at->parent_turn, side, clear->sum), clear->frames++;
    }
    return sine < limbs->straight;
}

/* The length of a sum, each product rounded with it, as numpy has the dot product of two vectors. */
static double length_of(const double *v)
{
    return sqrt(fma(v[2], v[2], fma(v[1], v[1], v[0] * v[0])));
}

static void write_turns(const Poses *poses, int64_t limb, const Limbs *limbs, const BendsFound *found)
{
    const double *axis = found->axes + 3 * limb, *upper = found->bones + 6 * limb, *lower = upper + 3;
    double *sines = found->turns + limb * poses->frames, *cosines = sines + limbs->count * poses->frames;
    for (int64_t f = 0; f < poses->frames; f++) {
        const LimbPose at = pose_of(poses, f, limbs->joints + 4 * limb);
        double inverse[4], local[4], side[3], *turned_lower = found->lower + 3 * (f * limbs->count + limb);
        q_conjugate(at.parent_turn, inverse);
        q_multiply(inverse, at.turn, local);
        q_turn(local, lower, turned_lower);
        cross(upper, turned_lower, side);
        sines[f] = dot(axis, side), cosines[f] = dot(upper, turned_lower);
    }
}

int find_bends(const Poses *poses, int64_t first, const Limbs *limbs, const BendsFound *found)
{
    memset(found->bones, 0, 6 * sizeof *found->bones * (size_t)limbs->count);
    for (int64_t i = 0; i < limbs->count; i++) {
        double *axis = found->axes + 3 * i, *bones = found->bones + 6 * i;
        Axis all = {.frames = 0}, clear = {.frames = 0};
        for (int64_t f = 0; f < poses->frames; f++) {
            const LimbPose at = pose_of(poses, f, limbs->joints + 4 * i);
            found->straight[i * poses->frames + f] = take_frame(&at, f >= first, limbs, bones, &all, &clear) != 0;
        }
        const int other = clear.frames > limbs->glitch && dot(clear.sum, all.sum) < 0.0;
        memcpy(axis, other ? clear.sum : all.sum, sizeof all.sum);
        const double length = length_of(axis);
        if (!all.frames || !(length > 0.0))
            return 0;
        shorten(axis, length);
        for (double *bone = bones; bone < bones + 6; bone += 3) {
            const double size = sqrt(dot(bone, bone));
            shorten(bone, size > DBL_MIN ? size : DBL_MIN);
        }
        write_turns(poses, i, limbs, found);
    }
    return 1;
}

void find_bent_back(const Poses *poses, int64_t first, const int64_t *joints, const double *upper, const double *lower,
    const double *axes, int64_t count, double *back)
{
    for (int64_t i = 0; i < count; i++, upper += 3, lower += 3, axes += 3) {
        back[i] = 0.0;
        for (int64_t f = first; f < poses->frames && back[i] == 0.0; f++) {
            double bone[3], side[3];
            q_turn(joint_turn(poses, f, joints[i]), lower, bone);
            cross(upper, bone, side);
            back[i] = !(dot(side, axes) >= 0.0);
        }
    }
}
