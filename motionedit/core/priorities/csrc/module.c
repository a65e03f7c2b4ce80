/* The Python module `_compiled`: buffers in, work without the interpreter's lock, results in buffers that came in.

   core/priorities/compiled_solver.py lays out the buffers of `solve`, core/kinematics.py and core/priorities/continuity.py those of the
   others; sizes are checked here, so that a slip there is an error and not a crash. */

#define PY_SSIZE_T_CLEAN
#define Py_LIMITED_API 0x030B0000
#include <Python.h>

#include "layered.h"

#include <stdlib.h>
#include <string.h>

enum {
    SIZES,
    NODE_INTEGERS,
    NODE_NUMBERS,
    COLUMN_NODES,
    TASK_INTEGERS,
    TASK_NUMBERS,
    RECRUITED,
    TARGETS,
    HINGE_COLUMNS,
    HINGE_NUMBERS,
    FRAMES,
    REFERENCE_ROTATIONS,
    REFERENCE_ROOT,
    ROTATIONS,
    TRANSLATIONS,
    ITERATIONS,
    CONVERGED,
    RANKS,
    BUFFERS
};
enum {
    N_FRAMES,
    N_NODES,
    N_COLUMNS,
    N_TASKS,
    N_HINGES,
    N_LAYERS,
    N_JOINTS,
    N_TRANSLATED,
    ROOT,
    IN_ORDER,
    MOVES_ROOT,
    PULLS_ROOT,
    MAX_ITERATIONS,
    MOTION_FRAMES,
    N_SIZES
};
enum { NODE_INTEGER_COUNT = 4, NODE_NUMBER_COUNT = 7, TASK_INTEGER_COUNT = 11, TASK_NUMBER_COUNT = 16 };

static int has_size(const Py_buffer *buffer, int64_t count, size_t bytes, const char *name)
{
    if (count >= 0 && (size_t)buffer->len == (size_t)count * bytes)
        return 1;
    PyErr_Format(
        PyExc_ValueError, "%s has %zd bytes instead of %zd", name, buffer->len, (Py_ssize_t)((size_t)count * bytes));
    return 0;
}

static void read_node(Node *node, const int64_t *integers, const double *numbers)
{
    node->joint = integers[0], node->parent = integers[1], node->translation = integers[2], node->column = integers[3];
    memcpy(node->offset, numbers, sizeof node->offset);
    node->share = numbers[3];
    memcpy(node->center, numbers + 4, sizeof node->center);
}

static void read_task(Task *task, const int64_t *integers, const double *numbers)
{
    task->kind = integers[0], task->layer = integers[1], task->rows = integers[2];
    task->node = integers[3], task->base = integers[4], task->root = integers[5], task->base_root = integers[6];
    memcpy(task->axes, integers + 7, sizeof task->axes);
    task->width = integers[10];
    task->weight = numbers[0];
    memcpy(task->offset, numbers + 1, sizeof task->offset);
    memcpy(task->measure, numbers + 4, sizeof task->measure);
    memcpy(task->axis, numbers + 13, sizeof task->axis);
}

/* Read the problem out of the buffers; nodes, tasks and hinges are allocated in `memory`. */
static int read_problem(Problem *problem, Py_buffer *buffers, void **memory)
{
    if (!has_size(buffers + SIZES, N_SIZES, sizeof(int64_t), "sizes"))
        return 0;
    const int64_t *sizes = buffers[SIZES].buf;
    const int64_t frames = sizes[N_FRAMES], nodes = sizes[N_NODES], columns = sizes[N_COLUMNS], tasks = sizes[N_TASKS];
    const int64_t whole = sizes[MOTION_FRAMES], hinges = sizes[N_HINGES], joints = sizes[N_JOINTS],
                  moved = sizes[N_TRANSLATED];
    const size_t integer = sizeof(int64_t), number = sizeof(double);
    if (!has_size(buffers + NODE_INTEGERS, nodes * NODE_INTEGER_COUNT, integer, "node integers") ||
        !has_size(buffers + NODE_NUMBERS, nodes * NODE_NUMBER_COUNT, number, "node numbers") ||
        !has_size(buffers + COLUMN_NODES, columns, integer, "column nodes") ||
        !has_size(buffers + TASK_INTEGERS, tasks * TASK_INTEGER_COUNT, integer, "task integers") ||
        !has_size(buffers + TASK_NUMBERS, tasks * TASK_NUMBER_COUNT, number, "task numbers") ||
        !has_size(buffers + RECRUITED, tasks * columns, 1, "recruited") ||
        !has_size(buffers + HINGE_COLUMNS, hinges, integer, "hinge columns") ||
        !has_size(buffers + HINGE_NUMBERS, hinges * 5, number, "hinge numbers") ||
        !has_size(buffers + FRAMES, frames, integer, "frames") ||
        !has_size(buffers + REFERENCE_ROTATIONS, whole * joints * 4, number, "reference rotations") ||
        !has_size(buffers + REFERENCE_ROOT, sizes[PULLS_ROOT] ? whole * 3 : 0, number, "reference root") ||
        !has_size(buffers + ROTATIONS, whole * joints * 4, number, "rotations") ||
        !has_size(buffers + TRANSLATIONS, whole * moved * 3, number, "translations") ||
        !has_size(buffers + ITERATIONS, frames, integer, "iterations") ||
        !has_size(buffers + CONVERGED, frames, 1, "converged") ||
        !has_size(buffers + RANKS, frames * sizes[N_LAYERS], integer, "ranks"))
        return 0;
    *memory = malloc(sizeof(Node) * nodes + sizeof(Task) * tasks + sizeof(Hinge) * hinges + 1);
    if (*memory == NULL) {
        PyErr_NoMemory();
        return 0;
    }
    Node *node = *memory;
    Task *task = (Task *)(node + nodes);
    Hinge *hinge = (Hinge *)(task + tasks);
    for (int64_t i = 0; i < nodes; i++)
        read_node(node + i, (int64_t *)buffers[NODE_INTEGERS].buf + NODE_INTEGER_COUNT * i,
            (double *)buffers[NODE_NUMBERS].buf + NODE_NUMBER_COUNT * i);
    int64_t rows = 0, given = 0;
    for (int64_t t = 0; t < tasks; t++) {
        read_task(task + t, (int64_t *)buffers[TASK_INTEGERS].buf + TASK_INTEGER_COUNT * t,
            (double *)buffers[TASK_NUMBERS].buf + TASK_NUMBER_COUNT * t);
        task[t].targets = (double *)buffers[TARGETS].buf + given;
        task[t].recruited = (uint8_t *)buffers[RECRUITED].buf + columns * t;
        rows += task[t].rows, given += task[t].width * frames;
    }
    if (!has_size(buffers + TARGETS, given, number, "targets"))
        return 0;
    for (int64_t h = 0; h < hinges; h++) {
        const double *numbers = (double *)buffers[HINGE_NUMBERS].buf + 5 * h;
        hinge[h].column = ((int64_t *)buffers[HINGE_COLUMNS].buf)[h];
        memcpy(hinge[h].axis, numbers, sizeof hinge[h].axis);
        memcpy(hinge[h].limits, numbers + 3, sizeof hinge[h].limits);
    }
    *problem = (Problem){
        .nodes = nodes,
        .columns = columns,
        .tasks = tasks,
        .hinges = hinges,
        .layers = sizes[N_LAYERS],
        .joints = joints,
        .translated = moved,
        .rows = rows,
        .root = sizes[ROOT],
        .in_order = sizes[IN_ORDER],
        .moves_root = sizes[MOVES_ROOT],
        .pulls_root = sizes[PULLS_ROOT],
        .max_iterations = sizes[MAX_ITERATIONS],
        .node = node,
        .column_node = buffers[COLUMN_NODES].buf,
        .task = task,
        .hinge = hinge,
        .frames = buffers[FRAMES].buf,
        .reference_rotations = buffers[REFERENCE_ROTATIONS].buf,
        .reference_root = buffers[REFERENCE_ROOT].buf,
        .rotations = buffers[ROTATIONS].buf,
        .translations = buffers[TRANSLATIONS].buf,
        .iterations = buffers[ITERATIONS].buf,
        .converged = buffers[CONVERGED].buf,
        .ranks = buffers[RANKS].buf,
    };
    return 1;
}

static PyObject *solve_with(int (*solver)(const Problem *, int64_t, int64_t), PyObject *arguments)
{
    Py_buffer buffers[BUFFERS] = {{0}};
    Py_buffer *b = buffers;
    double attraction;
    long long begin, end;
    if (!PyArg_ParseTuple(arguments, "y*y*y*y*y*y*y*y*y*y*y*y*y*w*w*w*w*w*dLL", b, b + 1, b + 2, b + 3, b + 4, b + 5,
            b + 6, b + 7, b + 8, b + 9, b + 10, b + 11, b + 12, b + 13, b + 14, b + 15, b + 16, b + 17, &attraction,
            &begin, &end))
        return NULL;
    Problem problem;
    void *memory = NULL;
    int status = -2;
    if (read_problem(&problem, buffers, &memory)) {
        problem.attraction = attraction;
        if (0 <= begin && begin <= end && end <= ((int64_t *)buffers[SIZES].buf)[N_FRAMES]) {
            Py_BEGIN_ALLOW_THREADS status = solver(&problem, begin, end);
            Py_END_ALLOW_THREADS if (status < 0) PyErr_NoMemory();
        } else
            PyErr_SetString(PyExc_ValueError, "no such frames");
    }
    free(memory);
    for (int i = 0; i < BUFFERS; i++)
        PyBuffer_Release(buffers + i);
    if (status < 0)
        return NULL;
    Py_RETURN_NONE;
}

static PyObject *solve(PyObject *self, PyObject *arguments)
{
    (void)self;
    return solve_with(has_avx2() ? solve_frames_avx2 : solve_frames, arguments);
}

static PyObject *solve_narrow(PyObject *self, PyObject *arguments)
{
    (void)self;
    return solve_with(solve_frames, arguments);
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
                     has_size(b + WORLD, 4 * poses, number, "world rotations");
    if (fits) {
        Py_BEGIN_ALLOW_THREADS world_poses(b[PARENTS].buf, b[PLACES].buf, b[OFFSETS].buf, frames, joints, translated,
            b[LOCAL].buf, b[MOVED].buf, b[POSITIONS].buf, b[WORLD].buf);
        Py_END_ALLOW_THREADS
    }
    for (int i = 0; i < COUNT; i++)
        PyBuffer_Release(b + i);
    if (!fits)
        return NULL;
    Py_RETURN_NONE;
}

static PyObject *smooth(PyObject *self, PyObject *arguments)
{
    enum { BEFORE, AFTER, TAPS, OUT, COUNT };
    Py_buffer b[COUNT] = {{0}};
    long long frames, first;
    double none;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "y*y*y*w*LLd", b, b + 1, b + 2, b + 3, &frames, &first, &none))
        return NULL;
    const size_t number = sizeof(double);
    const int64_t joints = frames > 0 ? b[BEFORE].len / (Py_ssize_t)(4 * number) / frames : 0;
    const int64_t radius = b[TAPS].len / (Py_ssize_t)number - 1;
    int status = -2;
    if (has_size(b + BEFORE, 4 * joints * frames, number, "rotations before") &&
        has_size(b + AFTER, 4 * joints * frames, number, "rotations after") &&
        has_size(b + OUT, 4 * joints * frames, number, "smooth rotations")) {
        if (radius < 0 || first < 0 || frames - first <= radius)
            PyErr_SetString(PyExc_ValueError, "too few frames for the filter");
        else {
            Py_BEGIN_ALLOW_THREADS status = smooth_rotations(
                b[BEFORE].buf, b[AFTER].buf, frames, joints, first, radius, b[TAPS].buf, none, b[OUT].buf);
            Py_END_ALLOW_THREADS if (status < 0) PyErr_NoMemory();
        }
    }
    for (int i = 0; i < COUNT; i++)
        PyBuffer_Release(b + i);
    if (status < 0)
        return NULL;
    Py_RETURN_NONE;
}

static PyMethodDef methods[] = {
    {"solve", solve, METH_VARARGS, "Solve frames begin to end - 1 in place."},
    {"solve_narrow", solve_narrow, METH_VARARGS, "As solve, with what every processor has: the same to the bit."},
    {"forward", forward_frames, METH_VARARGS, "Write the world transforms of all joints at all frames."},
    {"smooth", smooth, METH_VARARGS, "Write rotations plus their low-passed displacement."},
    {NULL, NULL, 0, NULL},
};

static PyModuleDef_Slot slots[] = {{0, NULL}};

static struct PyModuleDef definition = {
    PyModuleDef_HEAD_INIT,
    "_compiled",
    "The layered solver, forward kinematics and smoothing in C.",
    0,
    methods,
    slots,
    NULL,
    NULL,
    NULL,
};

PyMODINIT_FUNC PyInit__compiled(void)
{
    return PyModuleDef_Init(&definition);
}
