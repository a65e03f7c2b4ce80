/* The natural cubic spline of timeline/interpolation.py: its system of equations, solved for all columns at once. */

#include "../../csrc/module.h"

#include "../../csrc/held.h"

#include <stdlib.h>

/* M[i-1] + 4 M[i] + M[i+1] = rows[i], with nothing beyond both ends, solved in place of rows (count, width) by
   elimination. -1 where memory ran out. */
static int solve_spline(double *rows, int64_t count, int64_t width)
{
    double *pivots = malloc(sizeof *pivots * (size_t)(count > 0 ? count : 1));
    if (pivots == NULL)
        return -1;
    for (int64_t i = 0; i < count; i++) {
        double *row = rows + i * width;
        pivots[i] = i == 0 ? 4.0 : 4.0 - 1.0 / pivots[i - 1];
        if (i > 0)
            for (int64_t k = 0; k < width; k++)
                row[k] -= row[k - width] / pivots[i - 1];
    }
    for (int64_t i = count - 1; i >= 0; i--) {
        double *row = rows + i * width;
        if (i + 1 < count)
            for (int64_t k = 0; k < width; k++)
                row[k] -= row[k + width];
        for (int64_t k = 0; k < width; k++)
            row[k] /= pivots[i];
    }
    free(pivots);
    return 0;
}

static PyObject *second_derivatives(PyObject *self, PyObject *arguments)
{
    PyObject *rows;
    Held held = {.count = 0};
    long long count, width;
    int status = -2;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "OLL", &rows, &count, &width))
        return NULL;
    if (count < 0 || width < 0)
        return PyErr_Format(PyExc_ValueError, "no such rows");
    double *const given = items_of(&held, rows, count * width, sizeof *given, 1, "rows");
    if (given != NULL) {
        Py_BEGIN_ALLOW_THREADS status = solve_spline(given, count, width);
        Py_END_ALLOW_THREADS if (status < 0) PyErr_NoMemory();
    }
    return let_go_none_if(status == 0, &held);
}

PyMethodDef spline_methods[] = {
    {"second_derivatives", second_derivatives, METH_VARARGS, "Solve the natural spline's equations in place."},
    {NULL, NULL, 0, NULL},
};
