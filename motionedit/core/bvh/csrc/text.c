/* The numbers of a BVH file's rows: from text, and to it. What is no number is left to the caller.

   A number of at most 15 digits is an integer below 2^53 over a power of ten that a double holds exactly, so that one
   division rounds it correctly; others are read by `read`. */

#include "text.h"

#include <math.h>
#include <string.h>

enum { MOST_DIGITS = 15, MOST_DECIMALS = 17 };

static const double POWERS[MOST_DECIMALS + 1] = {
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17};

static int is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* Tab, line feed, vertical tab, form feed, carriage return. */
static int is_blank(char c)
{
    return c == ' ' || (c >= '\t' && c <= '\r');
}

/* Read a number: a sign, digits and a point among them, an exponent. Returns the character after it; NULL where that is
   no blank, or where it is too long, or not finite. */
static const char *read_number(const char *at, const char *end, ReadDouble *read, double *value, int64_t *decimals)
{
    const char *const word = at;
    int64_t mantissa = 0, digits = 0, fraction = 0, exponent = 0;
    const int minus = *at == '-';
    if (minus || *at == '+')
        at++;
    for (; at < end && is_digit(*at); at++, digits++)
        mantissa = digits < MOST_DIGITS ? 10 * mantissa + (*at - '0') : 0;
    if (at < end && *at == '.')
        for (at++; at < end && is_digit(*at); at++, digits++, fraction++)
            mantissa = digits < MOST_DIGITS ? 10 * mantissa + (*at - '0') : 0;
    const int is_plain = digits <= MOST_DIGITS && (at == end || is_blank(*at));
    if (digits > 0 && !is_plain && at < end && (*at == 'e' || *at == 'E')) {
        const int shrinks = at + 1 < end && at[1] == '-';
        at += at + 1 < end && (shrinks || at[1] == '+') ? 2 : 1;
        const char *const first = at;
        for (; at < end && is_digit(*at) && at - first < 4; at++)
            exponent = 10 * exponent + (*at - '0');
        exponent = shrinks ? -exponent : exponent;
        digits = at > first ? digits : 0;
    }
    if (digits == 0 || at - word > LONGEST_WORD || (at < end && !is_blank(*at)))
        return NULL;
    if (is_plain) {
        const double size = (double)mantissa / POWERS[fraction];
        *value = minus ? -size : size;
    } else if (!read(word, at - word, value))
        return NULL;
    if (fraction - exponent > *decimals)
        *decimals = fraction - exponent;
    return at;
}

int read_rows(const char *text, int64_t length, int64_t columns, int64_t room, ReadDouble *read, double *values,
    int64_t *starts, int64_t *stops, RowsFound *found)
{
    const char *at = text, *const end = text + length;
    int64_t rows = 0, column = 0;
    found->decimals = 0;
    for (; at < end;) {
        if (*at == '\n' || *at == '\r') {
            if (column > 0 && column < columns)
                return 0;
            rows += column > 0, column = 0, at++;
        } else if (is_blank(*at))
            at++;
        else {
            if (rows == room || column == columns)
                return 0;
            if (column == 0)
                starts[rows] = at - text;
            at = read_number(at, end, read, values + rows * columns + column, &found->decimals);
            if (at == NULL)
                return 0;
            if (++column == columns)
                stops[rows] = at - text;
        }
    }
    if (column > 0 && column < columns)
        return 0;
    found->rows = rows + (column > 0);
    return 1;
}

int64_t longest_number(int decimals)
{
    return MOST_DIGITS + decimals + 4;
}

int write_number(double value, int decimals, char *out)
{
    const double size = fabs(value);
    char digits[MOST_DIGITS + 1];
    int count = 0, length = 0;
    if (!(size < 1e15))
        return -1;
    int64_t whole = (int64_t)size, power = (int64_t)POWERS[decimals];
    int64_t fraction = (int64_t)rint((size - (double)whole) * POWERS[decimals]);
    if (fraction >= power)
        whole++, fraction = 0;
    if (value < 0.0 && (whole > 0 || fraction > 0))
        out[length++] = '-';
    do
        digits[count++] = (char)('0' + whole % 10), whole /= 10;
    while (whole > 0);
    while (count > 0)
        out[length++] = digits[--count];
    out[length] = '.';
    for (int i = decimals; i > 0; i--)
        out[length + i] = (char)('0' + fraction % 10), fraction /= 10;
    return length + 1 + decimals;
}

int64_t write_rows(
    const double *values, int64_t rows, int64_t columns, int decimals, const char *ending, int64_t after, char *out)
{
    char *at = out;
    for (int64_t row = 0; row < rows; row++) {
        for (int64_t column = 0; column < columns; column++) {
            const int length = write_number(values[row * columns + column], decimals, at);
            if (length < 0)
                return -1;
            at += length;
            *at++ = ' ';
        }
        memcpy(--at, ending, after);
        at += after;
    }
    return at - out;
}

int64_t splice_words(const char *text, int64_t length, const uint8_t *cells, const double *values, int64_t count,
    int decimals, char *out)
{
    const char *at = text, *const end = text + length;
    char *to = out;
    int64_t word = 0;
    while (at < end) {
        if (is_blank(*at)) {
            *to++ = *at++;
            continue;
        }
        const char *const first = at;
        while (at < end && !is_blank(*at))
            at++;
        if (word == count)
            return -1;
        if (cells[word]) {
            const int written = write_number(values[word], decimals, to);
            if (written < 0)
                return -1;
            to += written;
        } else {
            memcpy(to, first, at - first);
            to += at - first;
        }
        word++;
    }
    return word == count ? to - out : -1;
}
