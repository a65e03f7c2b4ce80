/* What is read off whole motions: directions, ranges, the center of mass, jerk. */

#include "body.h"

#include <float.h>
#include <string.h>

#include "../../csrc/jacobi.h"
#define ONE_LANE
#include "../../csrc/rotations.h"

#define PI 3.14159265358979323846

void find_directions(const Poses *poses, int64_t first, const int64_t *triples, int64_t count, double *out)
{
    for (int64_t i = 0; i < count; i++, triples += 3, out += 3) {
        double sum[3] = {0.0};
        for (int64_t f = first; f < poses->frames; f++) {
            const double *start = joint_place(poses, f, triples[0]), *stop = joint_place(poses, f, triples[1]);
            const double way[3] = {stop[0] - start[0], stop[1] - start[1], stop[2] - start[2]};
            double inverse[4], own[3];
            q_conjugate(joint_turn(poses, f, triples[2]), inverse);
            q_turn(inverse, way, own);
            add(sum, own);
        }
        const double size = sqrt(dot(sum, sum)), length = size > DBL_MIN ? size : DBL_MIN;
        for (int a = 0; a < 3; a++)
            out[a] = sum[a] / length;
    }
}

/* The mean of a joint's rotations over frames from `first` on, to `mean` (4,): the eigenvector of sum q q^T with the
   largest eigenvalue, signed as the first of them. */
static void find_mean(const Poses *poses, int64_t first, int64_t joint, double *mean)
{
    double sum[4][4] = {{0.0}}, vectors[4][4], cosine = 0.0;
    for (int64_t f = first; f < poses->frames; f++) {
        const double *q = joint_turn(poses, f, joint);
        for (int a = 0; a < 4; a++)
            for (int b = 0; b < 4; b++)
                sum[a][b] += q[a] * q[b];
    }
    jacobi(*sum, 4, *vectors);
    int largest = 0;
    for (int i = 1; i < 4; i++)
        largest = sum[i][i] > sum[largest][largest] ? i : largest;
    for (int a = 0; a < 4; a++)
        cosine += vectors[a][largest] * joint_turn(poses, first, joint)[a];
    for (int a = 0; a < 4; a++)
        mean[a] = cosine < 0.0 ? -vectors[a][largest] : vectors[a][largest];
}

/* Tangents are compared as quotients of what is not negative: no arc is needed but of the largest. */
typedef struct {
    double sine, cosine;
} Arc;

/* Take an arc of 0 to half a turn where it is the longer one. */
static void lengthen(Arc *longest, double sine, double cosine)
{
    const int behind = cosine < 0.0, was_behind = longest->cosine < 0.0;
    if (behind == was_behind ? sine * longest->cosine > longest->sine * cosine : behind)
        longest->sine = sine, longest->cosine = cosine;
}

/* The twist of an arc as limits.py has it, within half a turn. */
static double twist_of(const Arc *arc, double sign)
{
    const double whole = 2.0 * PI, twist = fmod(2.0 * atan2(sign * arc->sine, arc->cosine) + PI, whole);
    return fabs((twist < 0.0 ? twist + whole : twist) - PI);
}

/* Of a cosine or its square: more by far than its rounding, so that what is let off by it turns less. */
#define SURELY 1e-12

/* How far a joint swings a bone from its center and twists about it, at most: rad, to `widest` (2,). */
static void find_widest(
    const Poses *poses, int64_t first, int64_t joint, const double *center, const double *bone, double *widest)
{
    /* To both sides by themselves, as they are rounded. */
    Arc swing = {0.0, 1.0}, twists[2] = {{0.0, 1.0}, {0.0, 1.0}};
    double inverse[4], least = 1.0;
    q_conjugate(center, inverse);
    for (int64_t f = first; f < poses->frames; f++) {
        double turn[4], turned_bone[3], across[3];
        q_multiply(inverse, joint_turn(poses, f, joint), turn);
        const double sine = dot(turn + 1, bone);
        lengthen(twists + ((sine < 0.0) != (turn[0] < 0.0)), fabs(sine), fabs(turn[0]));
        /* The squared cosine of half the swing: what is left of it costs as much as all before. */
        const double square = turn[0] * turn[0] + sine * sine;
        if (square > least + SURELY)
            continue;
        least = square < least ? square : least;
        q_turn(turn, bone, turned_bone);
        cross(bone, turned_bone, across);
        lengthen(&swing, sqrt(dot(across, across)), dot(turned_bone, bone));
    }
    const double one = twist_of(twists, 1.0), other = twist_of(twists + 1, -1.0);
    widest[0] = atan2(swing.sine, swing.cosine), widest[1] = one > other ? one : other;
}

void find_cones(const Poses *poses, int64_t first, const int64_t *joints, const double *along, const double *bent,
    int64_t count, double *out)
{
    for (int64_t i = 0; i < count; i++, along += 3, bent += 4, out += 6) {
        double mean[4];
        find_mean(poses, first, joints[i], mean);
        q_multiply(mean, bent, out);
        find_widest(poses, first, joints[i], out, along, out + 4);
    }
}

/* Where a point in a joint's frame is in the world. */
static void carried_place(const Poses *poses, int64_t frame, int64_t joint, const double *point, double *place)
{
    q_turn(joint_turn(poses, frame, joint), point, place);
    add(place, joint_place(poses, frame, joint));
}

void carry(const Poses *poses, const int64_t *joints, const double *points, int64_t count, double *out)
{
    for (int64_t f = 0; f < poses->frames; f++)
        for (int64_t i = 0; i < count; i++, out += 3)
            carried_place(poses, f, joints[i], points + 3 * i, out);
}

void find_center(
    const Poses *poses, const int64_t *joints, const double *points, const double *shares, int64_t count, double *out)
{
    memset(out, 0, 3 * sizeof *out * (size_t)poses->frames);
    for (int64_t f = 0; f < poses->frames; f++, out += 3)
        for (int64_t i = 0; i < count; i++) {
            double place[3];
            carried_place(poses, f, joints[i], points + 3 * i, place);
            for (int a = 0; a < 3; a++)
                out[a] += shares[i] * place[a];
        }
}

/* Beside the largest arc others may be larger by their rounding: only these are taken as angles. */
#define NEARLY (1.0 - 1e-12)

/* A joint's largest step so far. */
typedef struct {
    Arc arc;
    double angle;
    int64_t into;
} Step;

/* Take the step from one turn to the next, into a frame, where it is the largest. */
static void take_step(const double *last, const double *next, int64_t frame, Step *largest)
{
    const double cosine = fabs(last[0] * next[0] + last[1] * next[1] + last[2] * next[2] + last[3] * next[3]);
    double inverse[4], turn[4];
    if (cosine > largest->arc.cosine + SURELY)
        return;
    q_conjugate(last, inverse);
    q_multiply(inverse, next, turn);
    const double sine = sqrt(dot(turn + 1, turn + 1));
    if (sine * largest->arc.cosine > largest->arc.sine * cosine * NEARLY) {
        const double angle = 2.0 * atan2(sine, cosine);
        if (angle > largest->angle)
            *largest = (Step){{sine, cosine}, angle, frame};
    }
}

void largest_steps(const double *before, const double *after, int64_t frames, int64_t joints, int64_t first,
    double *angles, int64_t *into)
{
    for (int64_t j = 0; j < joints; j++) {
        Step largest = {{0.0, 1.0}, 0.0, first + 1};
        double last[4] = {0.0}, inverse[4];
        int differ = before == NULL;
        for (int64_t f = first; f < frames; f++) {
            const double *q = after + 4 * (f * joints + j);
            double change[4];
            memcpy(change, q, sizeof change);
            if (before != NULL) {
                const double *own = before + 4 * (f * joints + j);
                differ |= q[0] != own[0] || q[1] != own[1] || q[2] != own[2] || q[3] != own[3];
                q_conjugate(own, inverse);
                q_multiply(inverse, q, change);
            }
            if (f > first)
                take_step(last, change, f, &largest);
            memcpy(last, change, sizeof last);
        }
        angles[j] = differ ? largest.angle : 0.0, into[j] = differ ? largest.into : first + 1;
    }
}

void same_frames(const double *one, const double *other, int64_t frames, int64_t width, uint8_t *same)
{
    for (int64_t f = 0; f < frames; f++, one += width, other += width)
        for (int64_t i = 0; i < width && same[f]; i++)
            same[f] = one[i] == other[i];
}

void turned_otherwise(const double *before, const double *after, int64_t count, double least, uint8_t *turned)
{
    for (int64_t i = 0; i < count; i++, before += 4, after += 4) {
        double inverse[4], turn[4];
        q_conjugate(before, inverse);
        q_multiply(inverse, after, turn);
        turned[i] = 2.0 * fabs(turn[1]) > least || 2.0 * fabs(turn[2]) > least || 2.0 * fabs(turn[3]) > least;
    }
}

void stepping_joints(
    const double *before, const double *after, int64_t frames, int64_t joints, double cosine, uint8_t *far)
{
    memset(far, 0, (size_t)joints);
    for (int64_t j = 0; j < joints; j++) {
        double last[4] = {0.0};
        for (int64_t f = 0; f < frames && !far[j]; f++) {
            const int64_t at = 4 * (f * joints + j);
            double inverse[4], change[4];
            q_conjugate(before + at, inverse);
            q_multiply(inverse, after + at, change);
            if (f > 0)
                far[j] = fabs(last[0] * change[0] + last[1] * change[1] + last[2] * change[2] + last[3] * change[3]) <
                         cosine;
            memcpy(last, change, sizeof last);
        }
    }
}

double squared_jerks(
    const double *positions, int64_t frames, int64_t joints, double *out, int64_t *frame, int64_t *joint)
{
    const int64_t width = 3 * joints;
    double largest = 0.0;
    *frame = *joint = 0;
    for (int64_t f = 0; f + 3 < frames; f++) {
        const double *rows = positions + f * width;
        out[f] = 0.0;
        for (int64_t j = 0; j < joints; j++) {
            double square = 0.0;
            for (int64_t a = 3 * j; a < 3 * j + 3; a++) {
                /* The differences of the differences' differences, as numpy.diff takes them. */
                const double b = rows[width + a], c = rows[2 * width + a];
                const double third = ((rows[3 * width + a] - c) - (c - b)) - ((c - b) - (b - rows[a]));
                square += third * third;
            }
            out[f] += square;
            if (square > largest)
                largest = square, *frame = f, *joint = j;
        }
    }
    return largest;
}
