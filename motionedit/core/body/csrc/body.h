/* What motionedit/core/body does in many calls of numpy, in one: the same to the bit. */

#ifndef MOTIONEDIT_BODY_H
#define MOTIONEDIT_BODY_H

#include <stdint.h>

/* World transforms of a motion: positions (F, J, 3) and rotations (F, J, 4). */
typedef struct {
    int64_t frames, joints;
    const double *positions, *rotations;
} Poses;

/* By what a point is taken to stand: contacts.py says what each is. Times are in frames, lengths in metres. */
typedef struct {
    int64_t half, low_while, longest_gap, shortest, top_while;
    double frame_time, enters, leaves, low, same_place, top, held;
} StandRules;

/* A stretch in which a point stands, both ends in, and how high, in metres. */
typedef struct {
    int64_t point, start, stop;
    double height;
} Stand;

/* The stands of P points along tracks (F, P, 3), so many units to a metre; `feet` (P,) says whose they are.

   Returns how many there are in `found`, which is to be freed; -1 where memory ran out. */
int64_t find_stands(const double *tracks, int64_t frames, int64_t points, const int64_t *feet, const double *up,
    double metre, const StandRules *rules, Stand **found);

/* The median of values, of which there are some; `room` is for as many. */
double median(const double *values, int64_t count, double *room);

/* The medians over frames of the ways from the middle of two joints to that of two others, which may be one: n times
   four joints, (n, 4), to `out` (n, 3). -1 where memory ran out. */
int find_median_ways(const Poses *poses, const int64_t *joints, int64_t count, double *out);

/* A point of a foot that stands from one frame to another, both in. */
typedef struct {
    int64_t point, start, stop;
} PlantFrames;

/* How P points of feet go along tracks (F, P, 3), and which of them stand when: n plants. */
typedef struct {
    int64_t frames, points, plants;
    const double *tracks, *up;
    const PlantFrames *stands;
} FootTracks;

/* By what feet are measured, measures.py says what each is: at `scale` metres a unit, from frame `first` on; `toes` (P,)
   says which points count as toes. */
typedef struct {
    int64_t first;
    const uint8_t *toes;
    double scale, frame_time, near_floor, skates, slides, under;
} FootRules;

/* As measures.FootMeasures. */
typedef struct {
    double skate_mean, skate_ratio, sliding_share, penetration_share, penetration_max, drift_max, floating_max;
} FootFigures;

void measure_feet(const FootTracks *feet, const FootRules *rules, FootFigures *figures);

/* How far a planted point goes on the level from a frame to the next, at most. */
double farthest_slide(const FootTracks *feet);

/* How far a planted point is from where other tracks (F, P, 3) have it, at most. */
double farthest_drift(const FootTracks *feet, const double *other);

static inline const double *joint_place(const Poses *poses, int64_t frame, int64_t joint)
{
    return poses->positions + 3 * (frame * poses->joints + joint);
}

static inline const double *joint_turn(const Poses *poses, int64_t frame, int64_t joint)
{
    return poses->rotations + 4 * (frame * poses->joints + joint);
}

/* The mean directions, over frames from `first` on, from joints to others, seen from third ones: n triples, (n, 3); unit
   vectors, (n, 3). */
void find_directions(const Poses *poses, int64_t first, const int64_t *triples, int64_t count, double *out);

/* The cones of n joints with the bones `along` (n, 3): the mean of a joint's rotations from frame `first` on and then a
   turn `bent` (n, 4) are its cone's center, and how far it swings its bone from there, and twists about it, at most, its
   ranges: (n, 6), rad. */
void find_cones(const Poses *poses, int64_t first, const int64_t *joints, const double *along, const double *bent,
    int64_t count, double *out);

/* Where points (n, 3) in the frames of n joints are in the world at each frame: shape (F, n, 3). */
void carry(const Poses *poses, const int64_t *joints, const double *points, int64_t count, double *out);

/* The sum of these places at each frame, weighted by n `shares`: shape (F, 3). */
void find_center(
    const Poses *poses, const int64_t *joints, const double *points, const double *shares, int64_t count, double *out);

/* The largest step of each joint's rotations (F, J, 4) from one frame to the next, from frame `first` on: rad, and the
   frame that it leads into, (J,) each. With `before` those of before^-1 after: joints that are the same do not step. */
void largest_steps(const double *before, const double *after, int64_t frames, int64_t joints, int64_t first,
    double *angles, int64_t *into);

/* n limbs, each a top, a joint, an end and the joint's parent, (n, 4): bent above one sine,
   clearly above another, straight below the third. So few frames as a `glitch` show nothing. */
typedef struct {
    int64_t count;
    const int64_t *joints;
    double bent, clear, straight;
    long long glitch;
} Limbs;

/* How they bend, as bends.Bend: in which frames they are `straight` (n, F), about which unit `axes` (n, 3), and their
   unit bones, upper and lower, (n, 2, 3). And what the angle about the axis is found from at each frame: the `lower`
   bone in the parent's frame, (F, n, 3), and with the upper one its sine about the axis and its cosine, (2, n, F). */
typedef struct {
    uint8_t *straight;
    double *axes, *bones, *lower, *turns;
} BendsFound;

/* Find how limbs bend in the frames from `first` on; 0 where one of them is bent in none of them. */
int find_bends(const Poses *poses, int64_t first, const Limbs *limbs, const BendsFound *found);

/* Whether the joints of n limbs, whose bones are the same at all frames, `upper` (n, 3) in the frame of a joint's parent
   and `lower` (n, 3) in its own, bend back about `axes` (n, 3) at any frame from `first` on: to `back` (n,). */
void find_bent_back(const Poses *poses, int64_t first, const int64_t *joints, const double *upper, const double *lower,
    const double *axes, int64_t count, double *back);

/* Let those frames be the `same` (F,) that were, and whose numbers (F, width) are equal in both. */
void same_frames(const double *one, const double *other, int64_t frames, int64_t width, uint8_t *same);

/* Which of n rotations (n, 4) are `turned` (n,) from those before by more than `least`: a part of the turn's vector. */
void turned_otherwise(const double *before, const double *after, int64_t count, double least, uint8_t *turned);

/* Which joints' changes, before^-1 after of rotations (F, J, 4), are `far` (J,) from those of the frame before: the cosine of half the angle
   is below one. */
void stepping_joints(
    const double *before, const double *after, int64_t frames, int64_t joints, double cosine, uint8_t *far);

/* Of positions (F, J, 3) the square of each frame's third difference, summed over joints, (F - 3,). Returns the largest
   of any joint, and at which frame and joint. */
double squared_jerks(
    const double *positions, int64_t frames, int64_t joints, double *out, int64_t *frame, int64_t *joint);

#endif
