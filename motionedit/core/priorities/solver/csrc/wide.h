/* Compiling a piece of C for processors with wider vectors: WIDE, where that can be done. Not with gcc on Windows, whose
   stack is not aligned for such vectors. System headers are there before, for what every processor has. */

#ifndef MOTIONEDIT_WIDE_H
#define MOTIONEDIT_WIDE_H

#if defined(__GNUC__) && defined(__x86_64__) && (defined(__clang__) || !defined(_WIN32))
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define WIDE
#define PRAGMA(words) _Pragma(#words)
#ifdef __clang__
#define BEGIN_WIDE(features) PRAGMA(clang attribute push(__attribute__((target(features))), apply_to = function))
#define END_WIDE PRAGMA(clang attribute pop)
#else
#define BEGIN_WIDE(features) PRAGMA(GCC push_options) PRAGMA(GCC target(features))
#define END_WIDE PRAGMA(GCC pop_options)
#endif
#endif

#endif
