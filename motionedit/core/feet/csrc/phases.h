/* The phases of stances: what motionedit/core/feet/phases.py does in many calls of numpy, in two. */

#ifndef MOTIONEDIT_PHASES_H
#define MOTIONEDIT_PHASES_H

#include "../../body/csrc/body.h"

/* The joints of n legs, each a thigh, a knee, an ankle and the joint of its toe, -1 without one, (n, 4), and where the toe
   is in that joint's frame, (n, 3). */
typedef struct {
    int64_t count;
    const int64_t *joints;
    const double *toes;
} Legs;

/* What is known of a leg at a frame. */
typedef struct {
    double ankle[3], turn[4], toe[3], hip[3], reach; /* the toe as the ankle sees it */
} LegPath;

/* How n legs go, (F, n): `share` is how much of its length a leg may be stretched to. */
void find_leg_paths(const Poses *poses, const Legs *legs, double share, LegPath *paths);

/* A point of a foot that stands from one frame to another, both in; `stop` is -1 where it does not. */
typedef struct {
    int64_t foot, is_toe, point, start, stop;
} SolePlant;

/* How the P points of n feet go, (F, P, 3), so many units to a metre, and their legs, (F, n). */
typedef struct {
    int64_t frames, points, feet;
    const double *tracks, *up;
    const LegPath *legs;
    double metre, frame_time;
} Soles;

/* By what a point has settled, and is held: settled.py and phases.py say what each is. Times are in frames, those of the
   shortest settled one in seconds, lengths in metres. */
typedef struct {
    int64_t half, fewest, shortest_kept, rounds;
    double faster, above, shortest, rounding;
} PhaseRules;

/* Cut plants at both ends to the frames in which their points have settled; -1 where memory ran out. */
int settle_plants(const Soles *soles, const PhaseRules *rules, SolePlant *plants, int64_t count);

/* Cut plants to the frames in which feet can be held; -1 where memory ran out. */
int cut_to_phases(const Soles *soles, const PhaseRules *rules, SolePlant *plants, int64_t count);

#endif
