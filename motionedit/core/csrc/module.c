/* The Python module `_compiled`: buffers in, work without the interpreter's lock, results in buffers that came in.

   Sizes are checked in the files *_module.c, so that a slip in Python is an error and not a crash. */

#include "module.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif
#ifdef __linux__
#include <sys/mman.h>
#endif
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

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

/* The module, or None where a variable of the environment has a value. To ask `os.environ` takes fifteen times as long,
   and whoever changes that changes this. */
static PyObject *unless_set(PyObject *self, PyObject *arguments)
{
    const char *name, *value, *found;
    if (!PyArg_ParseTuple(arguments, "ss", &name, &value))
        return NULL;
    found = getenv(name);
    return Py_NewRef(found != NULL && strcmp(found, value) == 0 ? Py_None : self);
}

static PyMethodDef methods[] = {
    {"keep_memory", keep_memory, METH_VARARGS, "Keep memory that was let go of, but for large arrays (glibc alone)."},
    {"room", room, METH_VARARGS, "Return so many bytes that are not yet written, for a stream."},
    {"unless_set", unless_set, METH_VARARGS,
        "Return the module; None where a variable of the environment has a value."},
    {NULL, NULL, 0, NULL},
};

static int add_all(PyObject *module)
{
    PyMethodDef *const added[] = {array_methods, body_methods, change_methods, feet_methods, motion_methods,
        phase_methods, sample_methods, solver_methods, spline_methods, text_methods};
    for (size_t i = 0; i < sizeof added / sizeof *added; i++)
        if (PyModule_AddFunctions(module, added[i]) < 0)
            return -1;
    return add_solver_tables(module);
}

static PyModuleDef_Slot slots[] = {{Py_mod_exec, (void *)add_all}, {0, NULL}};

static struct PyModuleDef definition = {
    PyModuleDef_HEAD_INIT,
    "_compiled",
    "The layered solver, kinematics, measures of bodies and feet, and the text of BVH files in C.",
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
