/* How legs go: what motionedit/core/feet/phases.py reads off a motion leg by leg, in one loop. */

#include "phases.h"

#include <string.h>

#define ONE_LANE
#include "../../csrc/rotations.h"

static double way_between(const double *from, const double *to, double *way)
{
    for (int a = 0; a < 3; a++)
        way[a] = to[a] - from[a];
    return sqrt(dot(way, way));
}

/* Where a toe is, as the ankle sees it. */
static void find_toe(const Poses *poses, int64_t frame, int64_t joint, const double *offset, LegPath *path)
{
    double toe[3], way[3], inverse[4];
    memcpy(toe, joint_place(poses, frame, joint), sizeof toe);
    if (offset[0] != 0.0 || offset[1] != 0.0 || offset[2] != 0.0) {
        q_turn(joint_turn(poses, frame, joint), offset, way);
        add(toe, way);
    }
    way_between(path->ankle, toe, way);
    q_conjugate(path->turn, inverse);
    q_turn(inverse, way, path->toe);
}

void find_leg_paths(const Poses *poses, const Legs *legs, double share, LegPath *paths)
{
    for (int64_t f = 0; f < poses->frames; f++)
        for (int64_t i = 0; i < legs->count; i++, paths++) {
            const int64_t *joints = legs->joints + 4 * i;
            const double *hip = joint_place(poses, f, joints[0]), *knee = joint_place(poses, f, joints[1]);
            double way[3];
            memset(paths, 0, sizeof *paths);
            memcpy(paths->hip, hip, sizeof paths->hip);
            memcpy(paths->ankle, joint_place(poses, f, joints[2]), sizeof paths->ankle);
            memcpy(paths->turn, joint_turn(poses, f, joints[2]), sizeof paths->turn);
            if (joints[3] >= 0)
                find_toe(poses, f, joints[3], legs->toes + 3 * i, paths);
            const double length = way_between(hip, knee, way) + way_between(knee, paths->ankle, way);
            const double own = way_between(hip, paths->ankle, way), most = share * length;
            paths->reach = most > own ? most : own;
        }
}
