/* Buffers from Python for whole motions, from kinematics.py, displacement.py and interpolation.py: sizes are checked here. */

#include "module.h"

#include "held.h"
#include "motion.h"

/* Whether parents come before their children, and every place is a row of the translations, or -1. */
static int is_tree(const int64_t *parents, const int64_t *places, int64_t joints, int64_t translated)
{
    for (int64_t j = 0; j < joints; j++)
        if (parents[j] < -1 || parents[j] >= j || places[j] < -1 || places[j] >= translated) {
            PyErr_Format(PyExc_ValueError, "joint %lld has no parent before it, or no translations", (long long)j);
            return 0;
        }
    return 1;
}

static PyObject *forward_frames(PyObject *self, PyObject *arguments)
{
    enum { PARENTS, PLACES, OFFSETS, LOCAL, MOVED, POSITIONS, WORLD, COUNT };
    Py_buffer b[COUNT] = {{0}};
    long long frames;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "y*y*y*y*y*w*w*L", b, b + 1, b + 2, b + 3, b + 4, b + 5, b + 6, &frames))
        return NULL;
    const size_t number = sizeof(double);
    const int64_t joints = b[PARENTS].len / (Py_ssize_t)sizeof(int64_t), poses = frames * joints;
    const int64_t translated = frames > 0 ? b[MOVED].len / (Py_ssize_t)(3 * number) / frames : 0;
    const int fits = has_size(b + PLACES, joints, sizeof(int64_t), "places") &&
                     has_size(b + OFFSETS, 3 * joints, number, "offsets") &&
                     has_size(b + LOCAL, 4 * poses, number, "rotations") &&
                     has_size(b + MOVED, 3 * translated * frames, number, "translations") &&
                     has_size(b + POSITIONS, 3 * poses, number, "positions") &&
                     has_size(b + WORLD, 4 * poses, number, "world rotations") &&
                     (frames == 0 || is_tree(b[PARENTS].buf, b[PLACES].buf, joints, translated));
    if (fits) {
        Py_BEGIN_ALLOW_THREADS world_poses(b[PARENTS].buf, b[PLACES].buf, b[OFFSETS].buf, frames, joints, translated,
            b[LOCAL].buf, b[MOVED].buf, b[POSITIONS].buf, b[WORLD].buf);
        Py_END_ALLOW_THREADS
    }
    return none_if(fits, b, COUNT);
}

static PyObject *smooth(PyObject *self, PyObject *arguments)
{
    enum { BEFORE, AFTER, AXES, TAPS, OUT, COUNT };
    Py_buffer b[COUNT] = {{0}};
    long long frames, first;
    double none;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "y*y*y*y*w*LLd", b, b + 1, b + 2, b + 3, b + 4, &frames, &first, &none))
        return NULL;
    const size_t number = sizeof(double);
    const int64_t joints = frames > 0 ? b[BEFORE].len / (Py_ssize_t)(4 * number) / frames : 0;
    const int64_t radius = b[TAPS].len / (Py_ssize_t)number - 1;
    int status = -2;
    if (has_size(b + BEFORE, 4 * joints * frames, number, "rotations before") &&
        has_size(b + AFTER, 4 * joints * frames, number, "rotations after") &&
        has_size(b + AXES, 3 * joints, number, "axes") &&
        has_size(b + OUT, 4 * joints * frames, number, "smooth rotations")) {
        if (radius < 0 || first < 0 || frames - first <= radius)
            PyErr_SetString(PyExc_ValueError, "too few frames for the filter");
        else {
            Py_BEGIN_ALLOW_THREADS status = smooth_rotations(
                b[BEFORE].buf, b[AFTER].buf, b[AXES].buf, frames, joints, first, radius, b[TAPS].buf, none, b[OUT].buf);
            Py_END_ALLOW_THREADS if (status < 0) PyErr_NoMemory();
        }
    }
    release(b, COUNT);
    if (status < 0)
        return NULL;
    Py_RETURN_NONE;
}

static PyObject *low_pass_rows(PyObject *self, PyObject *arguments)
{
    enum { ROWS, TAPS, OUT, COUNT };
    Py_buffer b[COUNT] = {{0}};
    long long frames;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "y*y*w*L", b, b + 1, b + 2, &frames))
        return NULL;
    const size_t number = sizeof(double);
    const int64_t width = frames > 0 ? b[ROWS].len / (Py_ssize_t)number / frames : 0;
    const int64_t radius = b[TAPS].len / (Py_ssize_t)number - 1;
    int status = -2;
    if (has_size(b + ROWS, width * frames, number, "rows") &&
        has_size(b + OUT, width * frames, number, "smooth rows")) {
        if (radius < 0 || frames <= radius)
            PyErr_SetString(PyExc_ValueError, "too few frames for the filter");
        else {
            Py_BEGIN_ALLOW_THREADS status =
                low_passed_rows(b[ROWS].buf, frames, width, radius, b[TAPS].buf, b[OUT].buf);
            Py_END_ALLOW_THREADS if (status < 0) PyErr_NoMemory();
        }
    }
    release(b, COUNT);
    if (status < 0)
        return NULL;
    Py_RETURN_NONE;
}

PyMethodDef motion_methods[] = {
    {"forward", forward_frames, METH_VARARGS, "Write the world transforms of all joints at all frames."},
    {"smooth", smooth, METH_VARARGS, "Write rotations plus their low-passed displacement."},
    {"low_pass", low_pass_rows, METH_VARARGS, "Write rows smoothed over frames."},
    {NULL, NULL, 0, NULL},
};
