/* Buffers from Python for what is in this folder: sizes are checked here, so that a slip there is an error and not a
   crash. */

#include "../../csrc/module.h"

#include "body.h"
#include "../../csrc/held.h"

/* World transforms, of `frames` frames from the place where the arrays begin; either may be None. */
static int poses_of(
    Held *held, PyObject *positions, PyObject *rotations, long long frames, long long joints, Poses *poses)
{
    if (frames < 0 || joints < 0) {
        PyErr_SetString(PyExc_ValueError, "no such frames or joints");
        return 0;
    }
    *poses = (Poses){.frames = frames, .joints = joints};
    if (positions != Py_None) {
        poses->positions = items_of(held, positions, 3 * frames * joints, sizeof(double), 0, "positions");
        if (poses->positions == NULL)
            return 0;
    }
    if (rotations != Py_None) {
        poses->rotations = items_of(held, rotations, 4 * frames * joints, sizeof(double), 0, "rotations");
        if (poses->rotations == NULL)
            return 0;
    }
    return 1;
}

/* Where `count` joints of so many are; NULL, and an error, where one is none. */
static const int64_t *joints_of(Held *held, PyObject *given, int64_t count, const Poses *poses)
{
    const int64_t *joints = items_of(held, given, count, sizeof *joints, 0, "joints");
    for (int64_t i = 0; joints != NULL && i < count; i++)
        if (joints[i] < 0 || joints[i] >= poses->joints) {
            PyErr_Format(PyExc_ValueError, "no joint %lld", (long long)joints[i]);
            return NULL;
        }
    return joints;
}

/* What is done with joints of a motion: with so many indices of each item, numbers of its arrays, and of its results;
   these are of every item, or of all together, and of all frames or of every frame. */
typedef struct {
    void (*work)(const Poses *, int64_t, const int64_t *, const double **, int64_t, double *);
    int64_t indices, numbers[3], results;
    int together, by_frame, needs_positions, needs_rotations;
} OnJoints;

/* Take the poses, first frame, joints, up to three arrays and the results that a call is given; whether all fit. */
static int take_joints(const OnJoints *of, PyObject *arguments, Held *held, Poses *poses, int64_t *first,
    int64_t *count, const int64_t **joints, const double **arrays, double **out)
{
    PyObject *positions, *rotations, *indices, *given, *results;
    long long frames, joint_count, begin, items;
    if (!PyArg_ParseTuple(arguments, "OOLLLOLO!O", &positions, &rotations, &frames, &joint_count, &begin, &indices,
            &items, &PyTuple_Type, &given, &results) ||
        !poses_of(held, positions, rotations, frames, joint_count, poses))
        return 0;
    *first = begin, *count = items;
    if (begin < 0 || items < 0 || (begin >= frames && !of->by_frame) ||
        (of->needs_positions && poses->positions == NULL) || (of->needs_rotations && poses->rotations == NULL)) {
        PyErr_SetString(PyExc_ValueError, "no such frames, or no positions or rotations");
        return 0;
    }
    *joints = joints_of(held, indices, of->indices * items, poses);
    if (*joints == NULL)
        return 0;
    for (int i = 0; i < 3 && of->numbers[i] > 0; i++) {
        PyObject *array = PyTuple_GetItem(given, i);
        arrays[i] = array == NULL ? NULL : items_of(held, array, of->numbers[i] * items, sizeof(double), 0, "numbers");
        if (arrays[i] == NULL)
            return 0;
    }
    const int64_t many = of->results * (of->together ? 1 : items) * (of->by_frame ? frames : 1);
    *out = items_of(held, results, many, sizeof(double), 1, "results");
    return *out != NULL;
}

static PyObject *on_joints(const OnJoints *of, PyObject *arguments)
{
    Held held = {.count = 0};
    Poses poses;
    int64_t first, count;
    const int64_t *joints;
    const double *arrays[3] = {NULL, NULL, NULL};
    double *out;
    const int fits = take_joints(of, arguments, &held, &poses, &first, &count, &joints, arrays, &out);
    if (fits)
        of->work(&poses, first, joints, arrays, count, out);
    return let_go_none_if(fits, &held);
}

static void directions_work(
    const Poses *poses, int64_t first, const int64_t *joints, const double **arrays, int64_t count, double *out)
{
    (void)arrays;
    find_directions(poses, first, joints, count, out);
}

static void cones_work(
    const Poses *poses, int64_t first, const int64_t *joints, const double **arrays, int64_t count, double *out)
{
    find_cones(poses, first, joints, arrays[0], arrays[1], count, out);
}

static void back_work(
    const Poses *poses, int64_t first, const int64_t *joints, const double **arrays, int64_t count, double *out)
{
    find_bent_back(poses, first, joints, arrays[0], arrays[1], arrays[2], count, out);
}

static void carry_work(
    const Poses *poses, int64_t first, const int64_t *joints, const double **arrays, int64_t count, double *out)
{
    (void)first;
    carry(poses, joints, arrays[0], count, out);
}

static void center_work(
    const Poses *poses, int64_t first, const int64_t *joints, const double **arrays, int64_t count, double *out)
{
    (void)first;
    find_center(poses, joints, arrays[0], arrays[1], count, out);
}

static PyObject *directions(PyObject *self, PyObject *arguments)
{
    (void)self;
    return on_joints(&(const OnJoints){directions_work, 3, {0}, 3, 0, 0, 1, 1}, arguments);
}

static PyObject *cones(PyObject *self, PyObject *arguments)
{
    (void)self;
    return on_joints(&(const OnJoints){cones_work, 1, {3, 4}, 6, 0, 0, 0, 1}, arguments);
}

static PyObject *bent_back(PyObject *self, PyObject *arguments)
{
    (void)self;
    return on_joints(&(const OnJoints){back_work, 1, {3, 3, 3}, 1, 0, 0, 0, 1}, arguments);
}

static PyObject *carried(PyObject *self, PyObject *arguments)
{
    (void)self;
    return on_joints(&(const OnJoints){carry_work, 1, {3}, 3, 0, 1, 1, 1}, arguments);
}

static PyObject *center(PyObject *self, PyObject *arguments)
{
    (void)self;
    return on_joints(&(const OnJoints){center_work, 1, {3, 1}, 3, 1, 1, 1, 1}, arguments);
}

static PyObject *jerks(PyObject *self, PyObject *arguments)
{
    Held held = {.count = 0};
    PyObject *positions, *results, *found = NULL;
    long long frames, joints;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "OLLO", &positions, &frames, &joints, &results))
        return NULL;
    if (frames < 3 || joints < 0)
        return PyErr_Format(PyExc_ValueError, "no such frames or joints");
    const double *places = items_of(&held, positions, 3 * frames * joints, sizeof *places, 0, "positions");
    double *out = places == NULL ? NULL : items_of(&held, results, frames - 3, sizeof *out, 1, "results");
    if (out != NULL) {
        int64_t frame, joint;
        const double largest = squared_jerks(places, frames, joints, out, &frame, &joint);
        found = Py_BuildValue("dLL", largest, (long long)frame, (long long)joint);
    }
    let_go(&held);
    return found;
}

static PyObject *steps(PyObject *self, PyObject *arguments)
{
    Held held = {.count = 0};
    PyObject *given[4];
    long long frames, joints, first;
    Poses before, after;
    int fits = 0;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "OOLLLOO", given, given + 1, &frames, &joints, &first, given + 2, given + 3))
        return NULL;
    if (first < 0 || given[1] == Py_None)
        return PyErr_Format(PyExc_ValueError, "no such frames, or no rotations");
    if (poses_of(&held, Py_None, given[0], frames, joints, &before) &&
        poses_of(&held, Py_None, given[1], frames, joints, &after)) {
        double *angles = items_of(&held, given[2], joints, sizeof *angles, 1, "angles");
        int64_t *into = angles == NULL ? NULL : items_of(&held, given[3], joints, sizeof *into, 1, "frames");
        fits = into != NULL;
        if (fits)
            largest_steps(before.rotations, after.rotations, frames, joints, first, angles, into);
    }
    return let_go_none_if(fits, &held);
}

static PyObject *bends(PyObject *self, PyObject *arguments)
{
    Held held = {.count = 0};
    PyObject *positions, *rotations, *joints_of_limbs, *given[5], *shown = NULL;
    long long frames, joints, first, count;
    Limbs limbs;
    Poses poses;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "OOLLLOLdddLOOOOO", &positions, &rotations, &frames, &joints, &first,
            &joints_of_limbs, &count, &limbs.bent, &limbs.clear, &limbs.straight, &limbs.glitch, given, given + 1,
            given + 2, given + 3, given + 4))
        return NULL;
    if (positions == Py_None || rotations == Py_None || first < 0)
        return PyErr_Format(PyExc_ValueError, "no positions or rotations, or no such frames");
    if (poses_of(&held, positions, rotations, frames, joints, &poses) &&
        (limbs.joints = joints_of(&held, joints_of_limbs, 4 * count, &poses)) != NULL) {
        static const struct {
            const char *name;
            int64_t width, by_frame;
            size_t bytes;
        } items[] = {
            {"straight", 1, 1, 1}, {"axes", 3, 0, 8}, {"bones", 6, 0, 8}, {"lower", 3, 1, 8}, {"turns", 2, 1, 8}};
        void *at[5];
        int taken = 0;
        for (int64_t many; taken < 5; taken++) {
            many = items[taken].width * count * (items[taken].by_frame ? frames : 1);
            at[taken] = items_of(&held, given[taken], many, items[taken].bytes, 1, items[taken].name);
            if (at[taken] == NULL)
                break;
        }
        limbs.count = count;
        const BendsFound found = {at[0], at[1], at[2], at[3], at[4]};
        if (taken == 5)
            shown = PyBool_FromLong(find_bends(&poses, first, &limbs, &found));
    }
    let_go(&held);
    return shown;
}

static PyObject *median_ways(PyObject *self, PyObject *arguments)
{
    Held held = {.count = 0};
    PyObject *positions, *joints_given, *results;
    long long frames, joints, count;
    Poses poses;
    int status = -2;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "OLLOLO", &positions, &frames, &joints, &joints_given, &count, &results))
        return NULL;
    if (positions == Py_None || frames < 1)
        return PyErr_Format(PyExc_ValueError, "no positions, or no frames");
    if (poses_of(&held, positions, Py_None, frames, joints, &poses)) {
        const int64_t *which = joints_of(&held, joints_given, 4 * count, &poses);
        double *out = which == NULL ? NULL : items_of(&held, results, 3 * count, sizeof *out, 1, "results");
        if (out != NULL && (status = find_median_ways(&poses, which, count, out)) < 0)
            PyErr_NoMemory();
    }
    return let_go_none_if(status >= 0, &held);
}

PyMethodDef body_methods[] = {
    {"directions", directions, METH_VARARGS, "Write mean directions between joints, seen from others."},
    {"cones", cones, METH_VARARGS, "Write the cones of joints about the means of their rotations."},
    {"bent_back", bent_back, METH_VARARGS, "Write which limbs bend back at any frame: 1 or 0."},
    {"carried", carried, METH_VARARGS, "Write where points in joints' frames are at each frame."},
    {"center", center, METH_VARARGS, "Write where the weighted mean of points in joints' frames is at each frame."},
    {"steps", steps, METH_VARARGS, "Write the largest step of each joint, and the frames into which these lead."},
    {"bends", bends, METH_VARARGS, "Write how much limbs are bent at each frame, and about which axes."},
    {"median_ways", median_ways, METH_VARARGS, "Write median ways between the middles of joints."},
    {"jerks", jerks, METH_VARARGS, "Write squared third differences; return the largest, its frame and joint."},
    {NULL, NULL, 0, NULL},
};
