/* What the reading and the writing of numbers share: powers of ten, and which characters are blanks. */

#ifndef MOTIONEDIT_DIGITS_H
#define MOTIONEDIT_DIGITS_H

#include <stdint.h>

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
#define LOW_BYTE_FIRST
#endif

enum { MOST_DIGITS = 15, MOST_DECIMALS = 17 };

static const double POWERS[MOST_DECIMALS + 1] = {
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17};

static const uint64_t LARGER[] = {1, 10, 100, 1000, 10000, 100000, 1000000, 10000000, 100000000};

/* Tab, line feed, vertical tab, form feed, carriage return. */
static inline int is_blank(char c)
{
    return c == ' ' || (c >= '\t' && c <= '\r');
}

#endif
