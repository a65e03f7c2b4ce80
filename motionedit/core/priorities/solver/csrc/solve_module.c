/* Buffers from Python for the layered solver, which compiled_solver.py lays out: sizes are checked here. */

#include "../../../csrc/module.h"

#include "../../../csrc/held.h"
#include "layered.h"
#include "wide.h"

#include <stddef.h>
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
    NUMBER(Constants, largest_way_back), NUMBER(Constants, largest_turn), NUMBER(Constants, stop_step),
    NUMBER(Constants, stop_left), NUMBER(Constants, stop_error), NUMBER(Constants, largest_ratio),
    NUMBER(Constants, gain_decay), NUMBER(Constants, on_limit), NUMBER(Constants, rank_tolerance),
    NUMBER(Constants, least_scale), NUMBER(Constants, limb), NUMBER(Constants, largest_task_share),
    NUMBER(Constants, largest_factor), NUMBER(Constants, no_change), NUMBER(Constants, no_direction),
    NUMBER(Constants, beyond_limit), NUMBER(Constants, met_without_limits), NUMBER(Constants, metres_per_radian),
    NUMBER(Constants, on_side), INTEGER(Constants, full_gain_iterations), INTEGER(Constants, hasty_iterations),
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

/* Whether the buffer `name` of a dictionary has `count` items of so many bytes; `place` is then where they are. */
static int take(Held *held, PyObject *given, const char *name, int64_t count, size_t bytes, int writable, void *place)
{
    PyObject *buffer = PyDict_GetItemString(given, name);
    if (buffer == NULL) {
        PyErr_Format(PyExc_ValueError, "%s is missing", name);
        return 0;
    }
    void *items = items_of(held, buffer, count, bytes, writable, name);
    memcpy(place, &items, sizeof items);
    return !PyErr_Occurred();
}

/* How many items of so many bytes the buffer `name` has, 0 where there is none: `take` then says so. */
static int64_t count_of(PyObject *given, const char *name, size_t bytes)
{
    PyObject *buffer = PyDict_GetItemString(given, name);
    Py_buffer seen;
    if (buffer == NULL || PyObject_GetBuffer(buffer, &seen, PyBUF_SIMPLE) < 0) {
        PyErr_Clear();
        return 0;
    }
    const int64_t items = (int64_t)(seen.len / (Py_ssize_t)bytes);
    PyBuffer_Release(&seen);
    return items;
}

/* Read the problem out of the buffers. */
static int read_problem(Problem *problem, Held *held, PyObject *given)
{
    const Settings *of;
    const Constants *constants;
    enum { READ, WRITE };
    if (!take(held, given, "settings", 1, sizeof *of, READ, &of) ||
        !take(held, given, "constants", 1, sizeof *constants, READ, &constants))
        return 0;
    problem->of = *of, problem->constants = *constants;
    if (settings_fault(of) != NULL) {
        PyErr_SetString(PyExc_ValueError, settings_fault(of));
        return 0;
    }
    const size_t integer = sizeof(int64_t), number = sizeof(double);
    const int64_t N = count_of(given, "frames", integer), pulls = count_of(given, "reference_root", number);
    const int64_t F = of->joints == 0 ? 0 : count_of(given, "rotations", number) / (4 * of->joints);
    const int64_t levels = F == 0 ? of->layers : count_of(given, "ranks", integer) / F;
    problem->count = N, problem->motion_frames = F, problem->levels = levels, problem->pulls_root = pulls > 0;
    if (!(take(held, given, "nodes", of->nodes, sizeof(Node), READ, &problem->node) &&
            take(held, given, "column_nodes", of->columns, integer, READ, &problem->column_node) &&
            take(held, given, "mobility", of->columns + 1, number, READ, &problem->mobility) &&
            take(held, given, "tasks", of->tasks, sizeof(Task), READ, &problem->task) &&
            take(held, given, "hinges", of->hinges, sizeof(Hinge), READ, &problem->hinge) &&
            take(held, given, "limits", of->limits, sizeof(Limit), READ, &problem->limit) &&
            take(held, given, "recruited", of->tasks * of->columns, 1, READ, &problem->recruited) &&
            take(held, given, "targets", of->targets, number, READ, &problem->targets) &&
            take(held, given, "frames", N, integer, READ, &problem->frames) &&
            take(held, given, "reference_rotations", 4 * F * of->joints, number, READ, &problem->reference_rotations) &&
            take(held, given, "reference_root", pulls > 0 ? 3 * F : 0, number, READ, &problem->reference_root) &&
            take(held, given, "softness", N * of->layers, number, READ, &problem->softness) &&
            take(held, given, "rotations", 4 * F * of->joints, number, WRITE, &problem->rotations) &&
            take(held, given, "translations", 3 * F * of->translated, number, WRITE, &problem->translations) &&
            take(held, given, "levels", of->layers, integer, READ, &problem->level) &&
            take(held, given, "iterations", F, integer, WRITE, &problem->iterations) &&
            take(held, given, "converged", F, 1, WRITE, &problem->converged) &&
            take(held, given, "ranks", F * levels, integer, WRITE, &problem->ranks) &&
            take(held, given, "left", F * levels, number, WRITE, &problem->left)))
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
    Held held = {.count = 0};
    PyObject *given;
    Problem problem = {0};
    long long begin, end;
    const char *name = NULL;
    int status = -2;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "OLLp|z", &given, &begin, &end, &problem.in_order, &name))
        return NULL;
    const Solver solver = solver_of(name);
    if (solver == NULL)
        return NULL;
    if (!PyDict_Check(given))
        PyErr_SetString(PyExc_TypeError, "buffers come in a dictionary");
    else if (read_problem(&problem, &held, given)) {
        if (0 <= begin && begin <= end && end <= problem.count) {
            Py_BEGIN_ALLOW_THREADS status = solver(&problem, begin, end);
            Py_END_ALLOW_THREADS if (status < 0) PyErr_NoMemory();
        } else
            PyErr_SetString(PyExc_ValueError, "no such frames");
    }
    return let_go_none_if(status >= 0, &held);
}

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

/* `records`: how its structures lie, by their buffers' names; `row_kinds`: the rows that it knows; `solvers`: those that the
   processor has, the narrowest first. */
int add_solver_tables(PyObject *module)
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
    fits = fits && PyModule_AddObjectRef(module, "records", records) == 0 &&
           PyModule_AddObjectRef(module, "row_kinds", kinds) == 0 &&
           PyModule_AddObjectRef(module, "solvers", solvers) == 0;
    Py_XDECREF(records);
    Py_XDECREF(kinds);
    Py_XDECREF(solvers);
    return fits ? 0 : -1;
}

PyMethodDef solver_methods[] = {
    {"solve", solve, METH_VARARGS,
        "Solve frames begin to end - 1 in place, perhaps in order, given buffers by their names; perhaps by one of "
        "`solvers`, which are the same to the bit."},
    {NULL, NULL, 0, NULL},
};
