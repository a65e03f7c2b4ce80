/* Buffers from Python: their sizes are checked as they are taken. */

#ifndef MOTIONEDIT_HELD_H
#define MOTIONEDIT_HELD_H

#include "module.h"

#include <stdint.h>

/* The buffers of a call, held as long as it runs. */
enum { MOST_HELD = 24 };
typedef struct {
    Py_buffer held[MOST_HELD];
    int count;
} Held;

/* Whether a buffer has `count` items of so many bytes; an error where it has not. */
static inline int has_size(const Py_buffer *buffer, int64_t count, size_t bytes, const char *name)
{
    if (count >= 0 && buffer->len % (Py_ssize_t)bytes == 0 && buffer->len / (Py_ssize_t)bytes == count)
        return 1;
    PyErr_Format(
        PyExc_ValueError, "%s has %zd bytes instead of %zd", name, buffer->len, (Py_ssize_t)((size_t)count * bytes));
    return 0;
}

/* Where `count` items of so many bytes are, one after the other; NULL, and an error, where they are not. */
static inline void *items_of(Held *held, PyObject *given, int64_t count, size_t bytes, int writable, const char *name)
{
    Py_buffer *buffer = held->held + held->count;
    if (PyObject_GetBuffer(given, buffer, writable ? PyBUF_WRITABLE : PyBUF_SIMPLE) < 0)
        return NULL;
    held->count++;
    return has_size(buffer, count, bytes, name) ? buffer->buf : NULL;
}

/* Where as many numbers are as are given, and how many; NULL, and an error, where they are no doubles. */
static inline const double *some_of(Held *held, PyObject *given, int64_t *count, const char *name)
{
    Py_buffer *buffer = held->held + held->count;
    if (PyObject_GetBuffer(given, buffer, PyBUF_SIMPLE) < 0)
        return NULL;
    held->count++;
    *count = buffer->len / (Py_ssize_t)sizeof(double);
    return has_size(buffer, *count, sizeof(double), name) ? buffer->buf : NULL;
}

/* Whether a joint turns about three different axes; an error where it does not. */
static inline int are_three_axes(const int *axes)
{
    for (int i = 0; i < 3; i++)
        if (axes[i] < 0 || axes[i] > 2 || axes[i] == axes[(i + 1) % 3]) {
            PyErr_SetString(PyExc_ValueError, "three different axes are 0, 1 and 2 in some order");
            return 0;
        }
    return 1;
}

static inline void release(Py_buffer *buffers, int count)
{
    for (int i = 0; i < count; i++)
        PyBuffer_Release(buffers + i);
}

/* What a call returns that has written what it was asked for: None, or an error where that does not fit. */
static inline PyObject *none_if(int fits, Py_buffer *buffers, int count)
{
    release(buffers, count);
    if (!fits)
        return NULL;
    Py_RETURN_NONE;
}

static inline void let_go(Held *held)
{
    release(held->held, held->count);
}

static inline PyObject *let_go_none_if(int fits, Held *held)
{
    return none_if(fits, held->held, held->count);
}

#endif
