/* Buffers from Python for the phases of stances: sizes are checked here, so that a slip there is an error and not a crash. */

#include "../../csrc/module.h"

#include "../../csrc/held.h"
#include "phases.h"

/* Whether the legs' joints are some; a toe's may be none. */
static int are_joints(const Legs *legs, int64_t joints)
{
    for (int64_t i = 0; i < 4 * legs->count; i++)
        if (legs->joints[i] < (i % 4 == 3 ? -1 : 0) || legs->joints[i] >= joints) {
            PyErr_Format(PyExc_ValueError, "no joint %lld", (long long)legs->joints[i]);
            return 0;
        }
    return 1;
}

static PyObject *leg_paths(PyObject *self, PyObject *arguments)
{
    Held held = {.count = 0};
    PyObject *given[5];
    long long frames, joints, count;
    double share;
    int fits = 0;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "OOLLOOLdO", given, given + 1, &frames, &joints, given + 2, given + 3, &count,
            &share, given + 4))
        return NULL;
    Poses poses = {.frames = frames, .joints = joints};
    Legs legs = {.count = count};
    LegPath *paths = NULL;
    if ((poses.positions = items_of(&held, given[0], 3 * frames * joints, sizeof(double), 0, "positions")) != NULL &&
        (poses.rotations = items_of(&held, given[1], 4 * frames * joints, sizeof(double), 0, "rotations")) != NULL &&
        (legs.joints = items_of(&held, given[2], 4 * count, sizeof(int64_t), 0, "legs")) != NULL &&
        (legs.toes = items_of(&held, given[3], 3 * count, sizeof(double), 0, "toes")) != NULL &&
        (paths = items_of(&held, given[4], count * frames, sizeof *paths, 1, "paths")) != NULL)
        fits = are_joints(&legs, joints);
    if (fits)
        find_leg_paths(&poses, &legs, share, paths);
    return let_go_none_if(fits, &held);
}

/* Whether plants are at frames, and of points and feet, that there are. */
static int are_plants(const Soles *soles, const SolePlant *plants, int64_t count)
{
    for (int64_t k = 0; k < count; k++) {
        const SolePlant *plant = plants + k;
        if (plant->start < 0 || plant->start > plant->stop || plant->stop >= soles->frames || plant->point < 0 ||
            plant->point >= soles->points || plant->foot < 0 || plant->foot >= soles->feet) {
            PyErr_Format(PyExc_ValueError, "plant %lld is at no frames, or of no point", (long long)k);
            return 0;
        }
    }
    return 1;
}

static PyObject *phases(PyObject *self, PyObject *arguments)
{
    Held held = {.count = 0};
    PyObject *given[4];
    long long frames, points, feet, count, half, fewest, shortest_kept, rounds;
    Soles soles;
    PhaseRules rules;
    SolePlant *plants = NULL;
    int status = -2;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "OOOOLLLLdd(LLddd)(LLd)", given, given + 1, given + 2, given + 3, &frames, &points,
            &feet, &count, &soles.metre, &soles.frame_time, &half, &fewest, &rules.faster, &rules.above,
            &rules.shortest, &shortest_kept, &rounds, &rules.rounding))
        return NULL;
    soles.frames = frames, soles.points = points, soles.feet = feet;
    rules.half = half, rules.fewest = fewest, rules.shortest_kept = shortest_kept, rules.rounds = rounds;
    if (half < 1)
        return PyErr_Format(PyExc_ValueError, "no frames around one");
    if ((soles.tracks = items_of(&held, given[0], 3 * frames * points, sizeof(double), 0, "tracks")) != NULL &&
        (soles.up = items_of(&held, given[1], 3, sizeof(double), 0, "up")) != NULL &&
        (soles.legs = items_of(&held, given[2], frames * feet, sizeof(LegPath), 0, "legs")) != NULL &&
        (plants = items_of(&held, given[3], count, sizeof *plants, 1, "plants")) != NULL &&
        are_plants(&soles, plants, count)) {
        status = cut_to_phases(&soles, &rules, plants, count);
        if (status < 0)
            PyErr_NoMemory();
    }
    return let_go_none_if(status >= 0, &held);
}

PyMethodDef phase_methods[] = {
    {"leg_paths", leg_paths, METH_VARARGS, "Write how legs go at each frame."},
    {"phases", phases, METH_VARARGS, "Cut plants to the frames in which feet can be held."},
    {NULL, NULL, 0, NULL},
};
