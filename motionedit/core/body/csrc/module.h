/* What motionedit/core/priorities/csrc/module.c adds to the Python module of what is in this folder. */

#ifndef MOTIONEDIT_BODY_MODULE_H
#define MOTIONEDIT_BODY_MODULE_H

#define PY_SSIZE_T_CLEAN
#define Py_LIMITED_API 0x030B0000
#include <Python.h>

extern PyMethodDef body_methods[], change_methods[], feet_methods[];

#endif
