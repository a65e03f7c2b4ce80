/* Buffers from Python for what compares two motions: sizes are checked here, as in body_module.c. */

#include "../../csrc/module.h"

#include "body.h"
#include "../../csrc/held.h"

#include <string.h>

static PyObject *same(PyObject *self, PyObject *arguments)
{
    Held held = {.count = 0};
    PyObject *given[5];
    long long frames;
    int fits = 0;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "OOOOLO", given, given + 1, given + 2, given + 3, &frames, given + 4))
        return NULL;
    uint8_t *out = items_of(&held, given[4], frames, 1, 1, "frames");
    if (out != NULL) {
        memset(out, 1, (size_t)frames);
        fits = 1;
    }
    for (int i = 0; fits && i < 4; i += 2) {
        const double *one = some_of(&held, given[i], &(int64_t){0}, "numbers");
        int64_t count = 0;
        const double *other = one == NULL ? NULL : some_of(&held, given[i + 1], &count, "numbers");
        fits = other != NULL && held.held[held.count - 2].len == held.held[held.count - 1].len &&
               (frames > 0 ? count % frames == 0 : count == 0);
        if (fits && frames > 0)
            same_frames(one, other, frames, count / frames, out);
        else if (!fits && !PyErr_Occurred())
            PyErr_SetString(PyExc_ValueError, "numbers of other frames");
    }
    return let_go_none_if(fits, &held);
}

static PyObject *turned(PyObject *self, PyObject *arguments)
{
    Held held = {.count = 0};
    PyObject *before, *after, *results;
    long long count;
    double least;
    int fits = 0;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "OOLdO", &before, &after, &count, &least, &results))
        return NULL;
    const double *one = items_of(&held, before, 4 * count, sizeof *one, 0, "rotations");
    const double *other = one == NULL ? NULL : items_of(&held, after, 4 * count, sizeof *other, 0, "rotations");
    uint8_t *out = other == NULL ? NULL : items_of(&held, results, count, 1, 1, "results");
    fits = out != NULL;
    if (fits)
        turned_otherwise(one, other, count, least, out);
    return let_go_none_if(fits, &held);
}

static PyObject *stepping(PyObject *self, PyObject *arguments)
{
    Held held = {.count = 0};
    PyObject *before, *after, *results;
    long long frames, joints;
    double cosine;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "OOLLdO", &before, &after, &frames, &joints, &cosine, &results))
        return NULL;
    const double *one = items_of(&held, before, 4 * frames * joints, sizeof *one, 0, "rotations");
    const double *other =
        one == NULL ? NULL : items_of(&held, after, 4 * frames * joints, sizeof *other, 0, "rotations");
    uint8_t *far = other == NULL ? NULL : items_of(&held, results, joints, 1, 1, "joints");
    const int fits = far != NULL && frames >= 0;
    if (fits)
        stepping_joints(one, other, frames, joints, cosine, far);
    else if (!PyErr_Occurred())
        PyErr_SetString(PyExc_ValueError, "no such frames");
    return let_go_none_if(fits, &held);
}

PyMethodDef change_methods[] = {
    {"same", same, METH_VARARGS, "Write which frames have the same numbers in two pairs of arrays."},
    {"turned", turned, METH_VARARGS, "Write which rotations are turned by more than some number."},
    {"stepping", stepping, METH_VARARGS, "Write which joints' changes step from one frame to the next."},
    {NULL, NULL, 0, NULL},
};
