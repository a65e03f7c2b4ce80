/* The Python module `_compiled`: buffers in, work without the interpreter's lock, results in buffers that came in.

   compiled_solver.py lays out the buffers of `solve`, core/kinematics.py, rotations.py, euler.py and continuity.py those of the others; sizes are
   checked here, so that a slip there is an error and not a crash. */

#define PY_SSIZE_T_CLEAN
#define Py_LIMITED_API 0x030B0000
#include <Python.h>

#include "../../body/csrc/module.h"
#include "../../bvh/csrc/text.h"
#include "arrays.h"
#include "layered.h"
#include "wide.h"

#include <math.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif
#ifdef __linux__
#include <sys/mman.h>
#endif
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* How a structure lies in memory: what Python makes a record of, so that the order of its fields stands here alone. */
typedef struct {
    const char *name, *format; /* as numpy has formats */
    size_t offset;
} Field;

#define FIELD(structure, name, format) {#name, format, offsetof(structure, name)}
#define INTEGER(structure, name) FIELD(structure, name, "i8")
#define NUMBER(structure, name) FIELD(structure, name, "f8")

static const Field SETTINGS_FIELDS[] = {INTEGER(Settings, nodes), INTEGER(Settings, columns), INTEGER(Settings, tasks),
    INTEGER(Settings, hinges), INTEGER(Settings, limits), INTEGER(Settings, layers), INTEGER(Settings, joints),
    INTEGER(Settings, translated), INTEGER(Settings, rows), INTEGER(Settings, targets), INTEGER(Settings, root),
    INTEGER(Settings, moves_root), INTEGER(Settings, max_iterations), INTEGER(Settings, ends_early),
    NUMBER(Settings, attraction), {0}};
static const Field CONSTANTS_FIELDS[] = {NUMBER(Constants, largest_error), NUMBER(Constants, largest_soft_error),
    NUMBER(Constants, largest_turn), NUMBER(Constants, stop_step), NUMBER(Constants, stop_left),
    NUMBER(Constants, stop_error), NUMBER(Constants, largest_ratio), NUMBER(Constants, gain_decay),
    NUMBER(Constants, on_limit), NUMBER(Constants, rank_tolerance), NUMBER(Constants, least_scale),
    NUMBER(Constants, limb), NUMBER(Constants, largest_task_share), NUMBER(Constants, largest_factor),
    NUMBER(Constants, no_change), NUMBER(Constants, no_direction), NUMBER(Constants, beyond_limit),
    NUMBER(Constants, met_without_limits), NUMBER(Constants, metres_per_radian), NUMBER(Constants, on_side),
    INTEGER(Constants, full_gain_iterations), INTEGER(Constants, hasty_iterations),
    INTEGER(Constants, stale_iterations), NUMBER(Constants, same_error), NUMBER(Constants, far_error),
    INTEGER(Constants, annealed_iterations), INTEGER(Constants, limit_rounds), INTEGER(Constants, sided_rounds), {0}};
static const Field NODE_FIELDS[] = {INTEGER(Node, joint), INTEGER(Node, parent), INTEGER(Node, translation),
    INTEGER(Node, column), FIELD(Node, offset, "3f8"), NUMBER(Node, share), FIELD(Node, center, "3f8"), {0}};
static const Field TASK_FIELDS[] = {INTEGER(Task, kind), INTEGER(Task, layer), INTEGER(Task, rows), INTEGER(Task, node),
    INTEGER(Task, base), INTEGER(Task, root), INTEGER(Task, base_root), INTEGER(Task, one_sided),
    FIELD(Task, axes, "3i8"), INTEGER(Task, width), INTEGER(Task, targets), NUMBER(Task, weight),
    FIELD(Task, offset, "3f8"), FIELD(Task, base_offset, "3f8"), FIELD(Task, measure, "(3,3)f8"),
    FIELD(Task, axis, "3f8"), {0}};
static const Field HINGE_FIELDS[] = {INTEGER(Hinge, column), INTEGER(Hinge, second), FIELD(Hinge, axis, "3f8"),
    FIELD(Hinge, upper, "3f8"), FIELD(Hinge, lower, "3f8"), FIELD(Hinge, limits, "2f8"), {0}};
static const Field LIMIT_FIELDS[] = {INTEGER(Limit, column), FIELD(Limit, center, "4f8"), FIELD(Limit, along, "3f8"),
    FIELD(Limit, middle, "3f8"), FIELD(Limit, halves, "2f8"), NUMBER(Limit, least), {0}};

static const struct {
    const char *name;
    size_t bytes;
    const Field *fields;
} RECORDS[] = {
    {"settings", sizeof(Settings), SETTINGS_FIELDS},
    {"constants", sizeof(Constants), CONSTANTS_FIELDS},
    {"nodes", sizeof(Node), NODE_FIELDS},
    {"tasks", sizeof(Task), TASK_FIELDS},
    {"hinges", sizeof(Hinge), HINGE_FIELDS},
    {"limits", sizeof(Limit), LIMIT_FIELDS},
};

static int has_size(const Py_buffer *buffer, int64_t count, size_t bytes, const char *name)
{
    if (count >= 0 && buffer->len % (Py_ssize_t)bytes == 0 && buffer->len / (Py_ssize_t)bytes == count)
        return 1;
    PyErr_Format(
        PyExc_ValueError, "%s has %zd bytes instead of %zd", name, buffer->len, (Py_ssize_t)((size_t)count * bytes));
    return 0;
}

/* The buffers of `solve`, by their names, held as long as it runs. */
enum { MOST_BUFFERS = 24 };
typedef struct {
    PyObject *given; /* a dictionary */
    Py_buffer held[MOST_BUFFERS];
    int count;
} Buffers;

/* Whether the buffer `name` has `count` items of so many bytes; `place` is then where they are. */
static int take_buffer(Buffers *buffers, const char *name, int64_t count, size_t bytes, int writable, void *place)
{
    PyObject *given = PyDict_GetItemString(buffers->given, name);
    Py_buffer *held = buffers->held + buffers->count;
    if (given == NULL) {
        PyErr_Format(PyExc_ValueError, "%s is missing", name);
        return 0;
    }
    if (PyObject_GetBuffer(given, held, writable ? PyBUF_WRITABLE : PyBUF_SIMPLE) < 0)
        return 0;
    buffers->count++;
    memcpy(place, &held->buf, sizeof held->buf);
    return has_size(held, count, bytes, name);
}

/* How many items of so many bytes the buffer `name` has, 0 where there is none: `take_buffer` then says so. */
static int64_t items_of(const Buffers *buffers, const char *name, size_t bytes)
{
    PyObject *given = PyDict_GetItemString(buffers->given, name);
    Py_buffer seen;
    if (given == NULL || PyObject_GetBuffer(given, &seen, PyBUF_SIMPLE) < 0) {
        PyErr_Clear();
        return 0;
    }
    const int64_t items = (int64_t)(seen.len / (Py_ssize_t)bytes);
    PyBuffer_Release(&seen);
    return items;
}

/* Read the problem out of the buffers. */
static int read_problem(Problem *problem, Buffers *buffers)
{
    const Settings *of;
    const Constants *constants;
    enum { READ, WRITE };
    if (!take_buffer(buffers, "settings", 1, sizeof *of, READ, &of) ||
        !take_buffer(buffers, "constants", 1, sizeof *constants, READ, &constants))
        return 0;
    problem->of = *of, problem->constants = *constants;
    if (settings_fault(of) != NULL) {
        PyErr_SetString(PyExc_ValueError, settings_fault(of));
        return 0;
    }
    const size_t integer = sizeof(int64_t), number = sizeof(double);
    const int64_t N = items_of(buffers, "frames", integer), pulls = items_of(buffers, "reference_root", number);
    const int64_t F = of->joints == 0 ? 0 : items_of(buffers, "rotations", number) / (4 * of->joints);
    problem->count = N, problem->motion_frames = F, problem->pulls_root = pulls > 0;
    if (!(take_buffer(buffers, "nodes", of->nodes, sizeof(Node), READ, &problem->node) &&
            take_buffer(buffers, "column_nodes", of->columns, integer, READ, &problem->column_node) &&
            take_buffer(buffers, "mobility", of->columns + 1, number, READ, &problem->mobility) &&
            take_buffer(buffers, "tasks", of->tasks, sizeof(Task), READ, &problem->task) &&
            take_buffer(buffers, "hinges", of->hinges, sizeof(Hinge), READ, &problem->hinge) &&
            take_buffer(buffers, "limits", of->limits, sizeof(Limit), READ, &problem->limit) &&
            take_buffer(buffers, "recruited", of->tasks * of->columns, 1, READ, &problem->recruited) &&
            take_buffer(buffers, "targets", of->targets, number, READ, &problem->targets) &&
            take_buffer(buffers, "frames", N, integer, READ, &problem->frames) &&
            take_buffer(
                buffers, "reference_rotations", 4 * F * of->joints, number, READ, &problem->reference_rotations) &&
            take_buffer(buffers, "reference_root", pulls > 0 ? 3 * F : 0, number, READ, &problem->reference_root) &&
            take_buffer(buffers, "softness", N * of->layers, number, READ, &problem->softness) &&
            take_buffer(buffers, "rotations", 4 * F * of->joints, number, WRITE, &problem->rotations) &&
            take_buffer(buffers, "translations", 3 * F * of->translated, number, WRITE, &problem->translations) &&
            take_buffer(buffers, "iterations", N, integer, WRITE, &problem->iterations) &&
            take_buffer(buffers, "converged", N, 1, WRITE, &problem->converged) &&
            take_buffer(buffers, "ranks", N * of->layers, integer, WRITE, &problem->ranks) &&
            take_buffer(buffers, "left", N * of->layers, number, WRITE, &problem->left)))
        return 0;
    if (problem_fault(problem) != NULL)
        PyErr_SetString(PyExc_ValueError, problem_fault(problem));
    return problem_fault(problem) == NULL;
}

typedef int (*Solver)(const Problem *, int64_t, int64_t);

/* The narrowest first. */
static const struct {
    const char *name;
    int (*is_there)(void); /* NULL: on every processor */
    Solver solve;
} SOLVERS[] = {
    {"plain", NULL, solve_frames},
#ifdef WIDE
    {"avx2", has_avx2, solve_frames_avx2},
    {"avx512", has_avx512, solve_frames_avx512},
#endif
};
enum { MOST_SOLVERS = sizeof SOLVERS / sizeof *SOLVERS };

static int has_solver(int i)
{
    return SOLVERS[i].is_there == NULL || SOLVERS[i].is_there();
}

/* The widest that the processor has, or the one of a name; NULL, with what is said of it, where there is none. */
static Solver solver_of(const char *name)
{
    for (int i = MOST_SOLVERS - 1; i >= 0; i--)
        if ((name == NULL || strcmp(name, SOLVERS[i].name) == 0) && has_solver(i))
            return SOLVERS[i].solve;
    PyErr_Format(PyExc_ValueError, "this processor has no solver '%s'", name);
    return NULL;
}

static PyObject *solve(PyObject *self, PyObject *arguments)
{
    Buffers buffers = {0};
    Problem problem = {0};
    long long begin, end;
    const char *name = NULL;
    int status = -2;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "OLLp|z", &buffers.given, &begin, &end, &problem.in_order, &name))
        return NULL;
    const Solver solver = solver_of(name);
    if (solver == NULL)
        return NULL;
    if (!PyDict_Check(buffers.given))
        PyErr_SetString(PyExc_TypeError, "buffers come in a dictionary");
    else if (read_problem(&problem, &buffers)) {
        if (0 <= begin && begin <= end && end <= problem.count) {
            Py_BEGIN_ALLOW_THREADS status = solver(&problem, begin, end);
            Py_END_ALLOW_THREADS if (status < 0) PyErr_NoMemory();
        } else
            PyErr_SetString(PyExc_ValueError, "no such frames");
    }
    for (int i = 0; i < buffers.count; i++)
        PyBuffer_Release(buffers.held + i);
    if (status < 0)
        return NULL;
    Py_RETURN_NONE;
}

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
    for (int i = 0; i < COUNT; i++)
        PyBuffer_Release(b + i);
    if (!fits)
        return NULL;
    Py_RETURN_NONE;
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
    for (int i = 0; i < COUNT; i++)
        PyBuffer_Release(b + i);
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
    for (int i = 0; i < COUNT; i++)
        PyBuffer_Release(b + i);
    if (status < 0)
        return NULL;
    Py_RETURN_NONE;
}

/* What is done to rows of numbers, two and two: how many numbers a row of each has, and how many axes a row of results
   adds; `planes` are of results, one after the other. */
typedef struct {
    RowWork *work;
    int64_t one, other, result, planes;
} OnRows;

enum { MOST_AXES = 8, MANY_ROWS = 1 << 12 };

/* Rows that are gone through together with others: so many numbers from row to row along each axis. */
typedef struct {
    const double *first;
    int64_t steps[MOST_AXES];
} Rows;

/* Whether the buffer is rows of `width` numbers that stand for `axes` axes of so many rows, the last axes of them or
   one row again and again; else it is to be copied, or an error is set. */
static int are_rows(const Py_buffer *buffer, int64_t width, int axes, const int64_t *counts, Rows *rows)
{
    const int own = buffer->ndim - 1, number = (int)sizeof(double);
    if (own < 0 || own > axes || buffer->shape[own] != width) {
        PyErr_Format(PyExc_ValueError, "not rows of %lld numbers", (long long)width);
        return 0;
    }
    if (buffer->format == NULL || strcmp(buffer->format, "d") != 0 || buffer->strides[own] != number)
        return 0;
    rows->first = buffer->buf;
    for (int axis = 0; axis < axes; axis++) {
        const int place = axis - (axes - own);
        rows->steps[axis] = 0;
        if (place < 0 || buffer->shape[place] == 1)
            continue;
        if (buffer->shape[place] != counts[axis]) {
            PyErr_SetString(PyExc_ValueError, "rows and results differ in number");
            return 0;
        }
        if (buffer->strides[place] % number != 0)
            return 0;
        rows->steps[axis] = buffer->strides[place] / number;
    }
    return 1;
}

/* Do it to all rows, along the last axis at once; axes that lie as one are taken as one. */
static void do_rows(const OnRows *of, Rows *one, Rows *other, int axes, int64_t *counts, double *out, int64_t apart)
{
    int64_t at[MOST_AXES] = {0};
    int last = axes - 1;
    while (last > 0 && one->steps[last - 1] == one->steps[last] * counts[last] &&
           other->steps[last - 1] == other->steps[last] * counts[last]) {
        counts[last - 1] *= counts[last];
        one->steps[last - 1] = one->steps[last], other->steps[last - 1] = other->steps[last];
        last--;
    }
    for (;;) {
        const double *a = one->first, *b = other->first;
        for (int axis = 0; axis < last; axis++)
            a += at[axis] * one->steps[axis], b += at[axis] * other->steps[axis];
        of->work(a, one->steps[last], b, other->steps[last], counts[last], out, apart);
        out += counts[last] * of->result;
        int axis = last - 1;
        while (axis >= 0 && ++at[axis] == counts[axis])
            at[axis--] = 0;
        if (axis < 0)
            return;
    }
}

/* True where it was done, False where the rows do not lie in memory as they have to. */
static PyObject *on_rows(const OnRows *of, PyObject *arguments)
{
    PyObject *given[3];
    Py_buffer b[3];
    int held = 0, done = -1;
    if (!PyArg_ParseTuple(arguments, "OOO", given, given + 1, given + 2))
        return NULL;
    while (held < 3 && PyObject_GetBuffer(given[held], b + held,
                           held == 2 ? PyBUF_WRITABLE | PyBUF_ND | PyBUF_FORMAT : PyBUF_RECORDS_RO) == 0)
        held++;
    if (held == 3) {
        /* An axis of one row stands for results that have no axes but their own. */
        int64_t counts[MOST_AXES] = {1}, rows = 1;
        const int before = of->planes > 1, axes = b[2].ndim - before - (of->result > 1);
        Rows one, other;
        int fits = axes >= 0 && axes <= MOST_AXES && (!before || b[2].shape[0] == of->planes) &&
                   (of->result == 1 || b[2].shape[b[2].ndim - 1] == of->result);
        for (int axis = 0; fits && axis < axes; axis++)
            rows *= counts[axis] = b[2].shape[axis + before];
        one.steps[0] = other.steps[0] = 0;
        if (!fits || !has_size(b + 2, rows * of->result * of->planes, sizeof(double), "results")) {
            if (!PyErr_Occurred())
                PyErr_SetString(PyExc_ValueError, "results have another shape");
        } else if (!are_rows(b, of->one, axes, counts, &one) || !are_rows(b + 1, of->other, axes, counts, &other))
            done = PyErr_Occurred() ? -1 : 0;
        else {
            PyThreadState *state = rows > MANY_ROWS ? PyEval_SaveThread() : NULL;
            if (rows > 0)
                do_rows(of, &one, &other, axes > 0 ? axes : 1, counts, b[2].buf, rows);
            if (state != NULL)
                PyEval_RestoreThread(state);
            done = 1;
        }
    }
    while (held > 0)
        PyBuffer_Release(b + --held);
    return done < 0 ? NULL : PyBool_FromLong(done);
}

/* A method that does some work to rows of so many numbers each: of one, of the other, of the results, and planes of
   these. */
#define ON_ROWS(method, ...)                                                                                           \
    static PyObject *method(PyObject *self, PyObject *arguments)                                                       \
    {                                                                                                                  \
        (void)self;                                                                                                    \
        return on_rows(&(const OnRows){__VA_ARGS__}, arguments);                                                       \
    }
ON_ROWS(multiply, multiply_all, 4, 4, 4, 1)
ON_ROWS(between, between_all, 4, 4, 4, 1)
ON_ROWS(rotate, rotate_all, 4, 3, 3, 1)
ON_ROWS(unrotate, unrotate_all, 4, 3, 3, 1)
ON_ROWS(cross_rows, cross_all, 3, 3, 3, 1)
ON_ROWS(dot_rows, dot_all, 3, 3, 1, 1)
ON_ROWS(length, length_all, 3, 3, 1, 1)
ON_ROWS(half_cosine, half_cosine_all, 4, 4, 1, 1)
ON_ROWS(turn, turn_all, 4, 4, 1, 2)

static int are_three_axes(const int *axes)
{
    for (int i = 0; i < 3; i++)
        if (axes[i] < 0 || axes[i] > 2 || axes[i] == axes[(i + 1) % 3]) {
            PyErr_SetString(PyExc_ValueError, "three different axes are 0, 1 and 2 in some order");
            return 0;
        }
    return 1;
}

static PyObject *turns_from_tangents(PyObject *self, PyObject *arguments)
{
    Py_buffer b[2] = {{0}};
    int axes[3];
    (void)self;
    if (!PyArg_ParseTuple(arguments, "y*iiiw*", b, axes, axes + 1, axes + 2, b + 1))
        return NULL;
    const int64_t count = b[1].len / (Py_ssize_t)(4 * sizeof(double));
    int fits =
        has_size(b, 3 * count, sizeof(double), "tangents") && has_size(b + 1, 4 * count, sizeof(double), "turns");
    fits = fits && are_three_axes(axes);
    if (fits) {
        Py_BEGIN_ALLOW_THREADS from_tangents(b[0].buf, axes, count, b[1].buf);
        Py_END_ALLOW_THREADS
    }
    PyBuffer_Release(b);
    PyBuffer_Release(b + 1);
    if (!fits)
        return NULL;
    Py_RETURN_NONE;
}

/* Whether `count` frames are among so many. */
static int are_frames(const int64_t *at, int64_t count, int64_t frames)
{
    for (int64_t i = 0; i < count; i++)
        if (at[i] < 0 || at[i] >= frames) {
            PyErr_Format(PyExc_ValueError, "there are %lld frames", (long long)frames);
            return 0;
        }
    return 1;
}

/* What is given of rotations and frames: the arcs from these to the ones after. */
static int take_arcs(Py_buffer *rotations, Py_buffer *at, long long joints, Arcs *arcs)
{
    const Py_ssize_t number = sizeof(double);
    *arcs = (Arcs){.rotations = rotations->buf, .at = at->buf, .joints = joints};
    arcs->count = at->len / (Py_ssize_t)sizeof(int64_t);
    arcs->frames = joints > 0 ? rotations->len / number / 4 / joints : 0;
    return has_size(rotations, arcs->frames * joints * 4, sizeof(double), "rotations") &&
           has_size(at, arcs->count, sizeof(int64_t), "frames") && are_frames(arcs->at, arcs->count, arcs->frames);
}

static PyObject *cosines_of_arcs(PyObject *self, PyObject *arguments)
{
    Py_buffer b[3] = {{0}};
    long long joints;
    Arcs arcs;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "y*y*Lw*", b, b + 1, &joints, b + 2))
        return NULL;
    const int fits =
        take_arcs(b, b + 1, joints, &arcs) && has_size(b + 2, arcs.count * arcs.joints, sizeof(double), "cosines");
    if (fits) {
        Py_BEGIN_ALLOW_THREADS arc_cosines(arcs.rotations, arcs.frames, arcs.joints, arcs.at, arcs.count, b[2].buf);
        Py_END_ALLOW_THREADS
    }
    for (int i = 0; i < 3; i++)
        PyBuffer_Release(b + i);
    if (!fits)
        return NULL;
    Py_RETURN_NONE;
}

static PyObject *slerp(PyObject *self, PyObject *arguments)
{
    enum { ROTATIONS, AT, T, COSINES, TANGENTS, OUT, COUNT };
    Py_buffer b[COUNT] = {{0}};
    long long joints;
    double straight;
    Arcs arcs;
    (void)self;
    if (!PyArg_ParseTuple(
            arguments, "y*y*Ly*y*y*dw*", b, b + AT, &joints, b + T, b + COSINES, b + TANGENTS, &straight, b + OUT))
        return NULL;
    int fits = take_arcs(b, b + AT, joints, &arcs);
    const int64_t all = fits ? arcs.count * arcs.joints : 0;
    fits = fits && has_size(b + T, arcs.count, sizeof(double), "fractions") &&
           has_size(b + COSINES, all, sizeof(double), "cosines") &&
           has_size(b + TANGENTS, 3 * all, sizeof(double), "tangents") &&
           has_size(b + OUT, 4 * all, sizeof(double), "turns");
    if (fits) {
        arcs.t = b[T].buf, arcs.cosines = b[COSINES].buf, arcs.tangents = b[TANGENTS].buf, arcs.straight = straight;
        Py_BEGIN_ALLOW_THREADS slerp_all(&arcs, b[OUT].buf);
        Py_END_ALLOW_THREADS
    }
    for (int i = 0; i < COUNT; i++)
        PyBuffer_Release(b + i);
    if (!fits)
        return NULL;
    Py_RETURN_NONE;
}

static PyObject *sums_of_euler(PyObject *self, PyObject *arguments)
{
    enum { ROTATIONS, JOINTS, OUT, COUNT };
    Py_buffer b[COUNT] = {{0}};
    long long joints;
    int axes[3];
    (void)self;
    if (!PyArg_ParseTuple(arguments, "y*Ly*iiiw*", b, &joints, b + 1, axes, axes + 1, axes + 2, b + 2))
        return NULL;
    const Py_ssize_t number = sizeof(double);
    const int64_t count = b[JOINTS].len / (Py_ssize_t)sizeof(int64_t);
    const int64_t frames = joints > 0 ? b[ROTATIONS].len / number / 4 / joints : 0;
    int fits = are_three_axes(axes) && has_size(b + ROTATIONS, frames * joints * 4, sizeof(double), "rotations") &&
               has_size(b + JOINTS, count, sizeof(int64_t), "joints") &&
               has_size(b + OUT, 6 * count * frames, sizeof(double), "sums");
    for (int64_t i = 0; fits && i < count; i++)
        if (((const int64_t *)b[JOINTS].buf)[i] < 0 || ((const int64_t *)b[JOINTS].buf)[i] >= joints) {
            PyErr_Format(PyExc_ValueError, "there are %lld joints", joints);
            fits = 0;
        }
    if (fits) {
        Py_BEGIN_ALLOW_THREADS euler_sums(b[ROTATIONS].buf, 4 * joints, b[JOINTS].buf, count, frames, axes, b[OUT].buf);
        Py_END_ALLOW_THREADS
    }
    for (int i = 0; i < COUNT; i++)
        PyBuffer_Release(b + i);
    if (!fits)
        return NULL;
    Py_RETURN_NONE;
}

static PyObject *lay_rows(PyObject *self, PyObject *arguments)
{
    enum { TRACKS, COLUMNS, OUT, COUNT };
    Py_buffer b[COUNT] = {{0}};
    long long frames;
    double factor;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "y*y*Ldw*", b, b + 1, &frames, &factor, b + 2))
        return NULL;
    const int64_t count = b[COLUMNS].len / (Py_ssize_t)sizeof(int64_t), *columns = b[COLUMNS].buf;
    const int64_t width = frames > 0 ? b[OUT].len / (Py_ssize_t)sizeof(double) / frames : 0;
    int fits = has_size(b + TRACKS, count * frames, sizeof(double), "tracks") &&
               has_size(b + OUT, width * frames, sizeof(double), "rows");
    for (int64_t i = 0; fits && i < count; i++)
        if (columns[i] < 0 || columns[i] >= width) {
            PyErr_Format(PyExc_ValueError, "rows have %lld columns", (long long)width);
            fits = 0;
        }
    if (fits) {
        Py_BEGIN_ALLOW_THREADS rows_of_tracks(b[TRACKS].buf, columns, count, frames, factor, b[OUT].buf, width);
        Py_END_ALLOW_THREADS
    }
    for (int i = 0; i < COUNT; i++)
        PyBuffer_Release(b + i);
    if (!fits)
        return NULL;
    Py_RETURN_NONE;
}

/* Whether each run is of a joint that there is, and of frames that it has. */
static int are_runs(const int64_t *runs, int64_t count, int64_t joints, int64_t frames)
{
    for (int64_t i = 0; i < count; i++, runs += 3)
        if (runs[0] < 0 || runs[0] >= joints || runs[1] < 0 || runs[1] > runs[2] || runs[2] > frames) {
            PyErr_Format(PyExc_ValueError, "run %lld has no such joint, or no such frames", (long long)i);
            return 0;
        }
    return 1;
}

static PyObject *make_continuous(PyObject *self, PyObject *arguments)
{
    enum { ANGLES, RUNS, SEEDS, COUNT };
    Py_buffer b[COUNT] = {{0}};
    long long frames;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "w*y*y*L", b, b + 1, b + 2, &frames))
        return NULL;
    const Py_ssize_t number = sizeof(double);
    const int64_t count = b[RUNS].len / (Py_ssize_t)(3 * sizeof(int64_t));
    const int64_t axes = count > 0 ? b[SEEDS].len / number / count : 1;
    const int64_t joints = frames > 0 && axes > 0 ? b[ANGLES].len / number / axes / frames : 0;
    int fits = has_size(b + RUNS, 3 * count, sizeof(int64_t), "runs") &&
               has_size(b + SEEDS, axes * count, sizeof(double), "seeds");
    if (fits && (axes < 1 || axes > 3)) {
        PyErr_SetString(PyExc_ValueError, "a joint turns about one to three axes");
        fits = 0;
    }
    fits = fits && (count == 0 || has_size(b + ANGLES, joints * axes * frames, sizeof(double), "angles")) &&
           are_runs(b[RUNS].buf, count, joints, frames);
    for (int64_t i = 0; fits && i < count; i++) {
        const int64_t *run = (const int64_t *)b[RUNS].buf + 3 * i;
        double *angles = (double *)b[ANGLES].buf + run[0] * axes * frames + run[1];
        nearest_angles(angles, axes, frames, run[2] - run[1], (const double *)b[SEEDS].buf + i * axes);
    }
    for (int i = 0; i < COUNT; i++)
        PyBuffer_Release(b + i);
    if (!fits)
        return NULL;
    Py_RETURN_NONE;
}

static int read_double(const char *word, int64_t length, double *value)
{
    char text[LONGEST_WORD + 1];
    memcpy(text, word, length);
    text[length] = 0;
    *value = PyOS_string_to_double(text, NULL, NULL);
    if (PyErr_Occurred()) {
        PyErr_Clear();
        return 0;
    }
    return isfinite(*value);
}

static PyObject *rows_from_text(PyObject *self, PyObject *arguments)
{
    enum { TEXT, VALUES, STARTS, STOPS, COUNT };
    Py_buffer b[COUNT] = {{0}};
    RowsFound found = {0};
    long long columns;
    int status = -1;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "y*Lw*w*w*", b, &columns, b + 1, b + 2, b + 3))
        return NULL;
    const int64_t room = b[STARTS].len / (Py_ssize_t)sizeof(int64_t);
    if (columns < 1)
        PyErr_SetString(PyExc_ValueError, "rows have columns");
    else if (has_size(b + STOPS, room, sizeof(int64_t), "stops") &&
             has_size(b + VALUES, room * columns, sizeof(double), "values"))
        status = read_rows(
            b[TEXT].buf, b[TEXT].len, columns, room, read_double, b[VALUES].buf, b[STARTS].buf, b[STOPS].buf, &found);
    for (int i = 0; i < COUNT; i++)
        PyBuffer_Release(b + i);
    if (status < 0)
        return NULL;
    if (status == 0)
        Py_RETURN_NONE;
    return Py_BuildValue("LL", (long long)found.rows, (long long)found.decimals);
}

static PyObject *rows_to_text(PyObject *self, PyObject *arguments)
{
    enum { VALUES, ENDING, OUT, COUNT };
    Py_buffer b[COUNT] = {{0}};
    long long columns;
    int decimals;
    int64_t length = -2;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "y*Liy*w*", b, &columns, &decimals, b + 1, b + 2))
        return NULL;
    const int64_t count = b[VALUES].len / (Py_ssize_t)sizeof(double);
    if (columns < 1 || count % columns || decimals < 1 || decimals > 17)
        PyErr_SetString(PyExc_ValueError, "no such rows, or no such decimals");
    else if (has_size(b + OUT, count * longest_number(decimals) + count / columns * b[ENDING].len, 1, "text")) {
        Py_BEGIN_ALLOW_THREADS length =
            write_rows(b[VALUES].buf, count / columns, columns, decimals, b[ENDING].buf, b[ENDING].len, b[OUT].buf);
        Py_END_ALLOW_THREADS
    }
    for (int i = 0; i < COUNT; i++)
        PyBuffer_Release(b + i);
    return length < -1 ? NULL : PyLong_FromLongLong(length);
}

static PyObject *plain_gaps(PyObject *self, PyObject *arguments)
{
    Py_buffer text = {0};
    long long count;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "y*L", &text, &count))
        return NULL;
    const int are_plain = has_plain_gaps(text.buf, text.len, count);
    PyBuffer_Release(&text);
    return PyBool_FromLong(are_plain);
}

static PyObject *splice(PyObject *self, PyObject *arguments)
{
    enum { TEXT, CELLS, VALUES, OUT, COUNT };
    Py_buffer b[COUNT] = {{0}};
    int decimals;
    int64_t length = -2;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "y*y*y*iw*", b, b + 1, b + 2, &decimals, b + 3))
        return NULL;
    const int64_t words = b[CELLS].len;
    if (decimals < 1 || decimals > 17)
        PyErr_SetString(PyExc_ValueError, "no such decimals");
    else if (has_size(b + VALUES, words, sizeof(double), "values") &&
             has_size(b + OUT, b[TEXT].len + words * longest_number(decimals), 1, "text")) {
        Py_BEGIN_ALLOW_THREADS length =
            splice_words(b[TEXT].buf, b[TEXT].len, b[CELLS].buf, b[VALUES].buf, words, decimals, b[OUT].buf);
        Py_END_ALLOW_THREADS
    }
    for (int i = 0; i < COUNT; i++)
        PyBuffer_Release(b + i);
    return length < -1 ? NULL : PyLong_FromLongLong(length);
}

/* A system gives memory page by page, and slowly: what a clip let go of serves the next. Arrays beyond `largest` bytes
   still come from the system and go back to it. */
static PyObject *keep_memory(PyObject *self, PyObject *arguments)
{
    int largest;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "i", &largest))
        return NULL;
#ifdef __GLIBC__
    mallopt(M_MMAP_THRESHOLD, largest);
    mallopt(M_TRIM_THRESHOLD, largest);
#endif
    Py_RETURN_NONE;
}

/* Bytes that are not yet written, for a stream. Of many the system is asked for large pages, as numpy does for its arrays:
   to be given small ones, one by one, takes longer than to read or to write a file. */
static PyObject *room(PyObject *self, PyObject *arguments)
{
    Py_ssize_t count;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "n", &count))
        return NULL;
    PyObject *bytes = PyBytes_FromStringAndSize(NULL, count);
#ifdef MADV_HUGEPAGE
    enum { PAGE = 1 << 12, MANY = 1 << 22 };
    if (bytes != NULL && count >= MANY) {
        char *const start = PyBytes_AsString(bytes);
        const size_t before = (size_t)(PAGE - (uintptr_t)start % PAGE);
        (void)madvise(start + before, (size_t)count - before, MADV_HUGEPAGE);
    }
#endif
    return bytes;
}

/* To ask `os.environ` takes fifteen times as long, and whoever changes that changes this. */
static PyObject *is_set(PyObject *self, PyObject *arguments)
{
    const char *name, *value, *found;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "ss", &name, &value))
        return NULL;
    found = getenv(name);
    return PyBool_FromLong(found != NULL && strcmp(found, value) == 0);
}

static PyMethodDef methods[] = {
    {"solve", solve, METH_VARARGS,
        "Solve frames begin to end - 1 in place, perhaps in order, given buffers by their names; perhaps by one of "
        "`solvers`, which are the same to the bit."},
    {"forward", forward_frames, METH_VARARGS, "Write the world transforms of all joints at all frames."},
    {"smooth", smooth, METH_VARARGS, "Write rotations plus their low-passed displacement."},
    {"low_pass", low_pass_rows, METH_VARARGS, "Write rows smoothed over frames."},
    {"keep_memory", keep_memory, METH_VARARGS, "Keep memory that was let go of, but for large arrays (glibc alone)."},
    {"room", room, METH_VARARGS, "Return so many bytes that are not yet written, for a stream."},
    {"is_set", is_set, METH_VARARGS, "Return whether a variable of the environment has a value."},
    {"multiply", multiply, METH_VARARGS,
        "Write the products of quaternions; False where they lie otherwise in memory."},
    {"between", between, METH_VARARGS, "Write a^-1 b of unit quaternions; False as `multiply`."},
    {"rotate", rotate, METH_VARARGS, "Write vectors turned by quaternions; False as `multiply`."},
    {"unrotate", unrotate, METH_VARARGS, "Write vectors turned back by quaternions; False as `multiply`."},
    {"cross", cross_rows, METH_VARARGS, "Write the cross products of vectors; False as `multiply`."},
    {"dot", dot_rows, METH_VARARGS, "Write the dot products of vectors; False as `multiply`."},
    {"length", length, METH_VARARGS, "Write the lengths of vectors, the second given; False as `multiply`."},
    {"half_cosine", half_cosine, METH_VARARGS, "Write |a . b| of quaternions; False as `multiply`."},
    {"turn", turn, METH_VARARGS, "Write sines and cosines of half the turns between rotations; False as `multiply`."},
    {"from_tangents", turns_from_tangents, METH_VARARGS,
        "Write the quaternions of three turns, given the tangents of half their angles."},
    {"euler_sums", sums_of_euler, METH_VARARGS,
        "Write the sines, cosines and lengths that the Euler angles of some joints are arc tangents of."},
    {"arc_cosines", cosines_of_arcs, METH_VARARGS,
        "Write the cosines between rotations of frames and of the ones after."},
    {"slerp", slerp, METH_VARARGS, "Write rotations at fractions of the ways from frames to the ones after."},
    {"rows_of_tracks", lay_rows, METH_VARARGS, "Write tracks, times a factor, as columns of rows."},
    {"nearest_angles", make_continuous, METH_VARARGS, "Make runs of Euler angles continuous, in place."},
    {"rows_from_text", rows_from_text, METH_VARARGS,
        "Read rows of numbers; return how many and the most decimals, or None where it is no such text."},
    {"rows_to_text", rows_to_text, METH_VARARGS,
        "Write rows of numbers; return the text's length, -1 where one is large."},
    {"plain_gaps", plain_gaps, METH_VARARGS, "Return whether a text's blanks are so many, single ones and line feeds."},
    {"splice", splice, METH_VARARGS,
        "Copy text with some words replaced by numbers; return its length, -1 where one is large."},
    {NULL, NULL, 0, NULL},
};

/* What a record's fields are called, and how and where they lie: what numpy.dtype takes. */
static PyObject *record_of(const Field *fields, size_t bytes)
{
    PyObject *names = PyList_New(0), *formats = PyList_New(0), *offsets = PyList_New(0), *record = NULL;
    int fits = names != NULL && formats != NULL && offsets != NULL;
    for (; fits && fields->name != NULL; fields++) {
        PyObject *name = PyUnicode_FromString(fields->name), *format = PyUnicode_FromString(fields->format);
        PyObject *offset = PyLong_FromSize_t(fields->offset);
        fits = name != NULL && format != NULL && offset != NULL && PyList_Append(names, name) == 0 &&
               PyList_Append(formats, format) == 0 && PyList_Append(offsets, offset) == 0;
        Py_XDECREF(name);
        Py_XDECREF(format);
        Py_XDECREF(offset);
    }
    if (fits)
        record = Py_BuildValue(
            "{sOsOsOsn}", "names", names, "formats", formats, "offsets", offsets, "itemsize", (Py_ssize_t)bytes);
    Py_XDECREF(names);
    Py_XDECREF(formats);
    Py_XDECREF(offsets);
    return record;
}

static int appends(PyObject *list, const char *name)
{
    PyObject *word = PyUnicode_FromString(name);
    const int fits = word != NULL && PyList_Append(list, word) == 0;
    Py_XDECREF(word);
    return fits;
}

/* Add to the module what measures bodies, `records`, how its structures lie, by their buffers' names, `row_kinds`, the
   rows that it knows, and `solvers`, those that the processor has, the narrowest first. */
static int add_tables(PyObject *module)
{
    PyObject *records = PyDict_New(), *kinds = PyList_New(0), *solvers = PyList_New(0);
    int fits = records != NULL && kinds != NULL && solvers != NULL;
    for (size_t i = 0; fits && i < sizeof RECORDS / sizeof *RECORDS; i++) {
        PyObject *record = record_of(RECORDS[i].fields, RECORDS[i].bytes);
        fits = record != NULL && PyDict_SetItemString(records, RECORDS[i].name, record) == 0;
        Py_XDECREF(record);
    }
    for (int i = 0; fits && row_kind(i) != NULL; i++)
        fits = appends(kinds, row_kind(i)->name);
    for (int i = 0; fits && i < MOST_SOLVERS; i++)
        fits = !has_solver(i) || appends(solvers, SOLVERS[i].name);
    fits = fits && PyModule_AddFunctions(module, body_methods) == 0 &&
           PyModule_AddFunctions(module, change_methods) == 0 && PyModule_AddFunctions(module, feet_methods) == 0 &&
           PyModule_AddObjectRef(module, "records", records) == 0 &&
           PyModule_AddObjectRef(module, "row_kinds", kinds) == 0 &&
           PyModule_AddObjectRef(module, "solvers", solvers) == 0;
    Py_XDECREF(records);
    Py_XDECREF(kinds);
    Py_XDECREF(solvers);
    return fits ? 0 : -1;
}

static PyModuleDef_Slot slots[] = {{Py_mod_exec, (void *)add_tables}, {0, NULL}};

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
