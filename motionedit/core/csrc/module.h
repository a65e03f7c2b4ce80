/* The Python module `_compiled`: what the files *_module.c beside what they offer add to it. */

#ifndef MOTIONEDIT_MODULE_H
#define MOTIONEDIT_MODULE_H

#define PY_SSIZE_T_CLEAN
#define Py_LIMITED_API 0x030B0000
#include <Python.h>

extern PyMethodDef array_methods[], body_methods[], change_methods[], feet_methods[], motion_methods[], phase_methods[],
    sample_methods[], solver_methods[], spline_methods[], text_methods[];

/* Add the solver's tables to the module; 0, or -1 where memory ran out. */
int add_solver_tables(PyObject *module);

#endif
