/* The numbers of a BVH file's rows: from text, and to it. What is no number is left to the caller.

   A number of at most 15 digits is an integer below 2^53 over a power of ten that a double holds exactly, so that one
   division rounds it correctly; others are read by `read`. */

#include "text.h"

#include <math.h>
#include <string.h>

enum { MOST_DIGITS = 15, MOST_DECIMALS = 17 };

static const double POWERS[MOST_DECIMALS + 1] = {
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17};

/* Every two digits. */
static const char PAIRS[] = "00010203040506070809101112131415161718192021222324"
                            "25262728293031323334353637383940414243444546474849"
                            "50515253545556575859606162636465666768697071727374"
                            "75767778798081828384858687888990919293949596979899";

static int is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* Tab, line feed, vertical tab, form feed, carriage return. */
static int is_blank(char c)
{
    return c == ' ' || (c >= '\t' && c <= '\r');
}

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
/* Add the digits that eight characters begin with to a number; returns how many these are. The first character is the
   lowest byte: digits are moved up until zeros stand before them, and added by pairs, fours and eights. */
static int add_digits(const char *at, uint64_t *number)
{
    static const uint64_t LARGER[] = {1, 10, 100, 1000, 10000, 100000, 1000000, 10000000, 100000000};
    uint64_t word;
    memcpy(&word, at, sizeof word);
    word ^= 0x3030303030303030;
    const uint64_t others = ((word + 0x0606060606060606) | word) & 0xF0F0F0F0F0F0F0F0;
    const int count = others == 0 ? 8 : __builtin_ctzll(others) / 8;
    if (count == 0)
        return 0;
    word <<= 8 * (8 - count);
    word = word * 10 + (word >> 8);
    word =
        ((word & 0x000000FF000000FF) * 0x000F424000000064 + (word >> 16 & 0x000000FF000000FF) * 0x0000271000000001) >>
        32;
    *number = *number * LARGER[count] + word;
    return count;
}
#else
static int add_digits(const char *at, uint64_t *number)
{
    (void)at, (void)number;
    return 0;
}
#endif

/* Read a number: a sign, digits and a point among them, an exponent. Returns the character after it; NULL where that is
   no blank, or where it is too long, or not finite. */
static const char *read_number(const char *at, const char *end, ReadDouble *read, double *value, int64_t *decimals)
{
    const char *const word = at;
    uint64_t mantissa = 0; /* of too many digits it is not used */
    int64_t fraction = 0, exponent = 0;
    const int minus = *at == '-';
    if (minus || *at == '+')
        at++;
    const char *first = at;
    for (; at < end && is_digit(*at); at++)
        mantissa = 10 * mantissa + (uint64_t)(*at - '0');
    int64_t digits = at - first;
    if (at < end && *at == '.') {
        first = ++at;
        if (end - at >= 8)
            at += add_digits(at, &mantissa);
        for (; at < end && is_digit(*at); at++)
            mantissa = 10 * mantissa + (uint64_t)(*at - '0');
        fraction = at - first;
        digits += fraction;
    }
    const int is_plain = digits <= MOST_DIGITS && (at == end || is_blank(*at));
    if (digits > 0 && !is_plain && at < end && (*at == 'e' || *at == 'E')) {
        const int shrinks = at + 1 < end && at[1] == '-';
        at += at + 1 < end && (shrinks || at[1] == '+') ? 2 : 1;
        first = at;
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

/* Write the last `count` digits of a number, two by two, before `stop`. */
static void write_digits(uint64_t number, int count, char *stop)
{
    for (; count > 1; count -= 2, number /= 100)
        memcpy(stop -= 2, PAIRS + 2 * (number % 100), 2);
    if (count > 0)
        *--stop = (char)('0' + number % 10);
}

int write_number(double value, int decimals, char *out)
{
    const double size = fabs(value);
    int places = 1, length = 0;
    if (!(size < 1e15))
        return -1;
    const uint64_t power = (uint64_t)POWERS[decimals];
    uint64_t whole = (uint64_t)size;
    uint64_t fraction = (uint64_t)llrint((size - (double)whole) * POWERS[decimals]);
    if (fraction >= power)
        whole++, fraction = 0;
    if (value < 0.0 && (whole > 0 || fraction > 0))
        out[length++] = '-';
    while (places <= MOST_DIGITS && whole >= (uint64_t)POWERS[places])
        places++;
    length += places;
    write_digits(whole, places, out + length);
    out[length++] = '.';
    write_digits(fraction, decimals, out + length + decimals);
    return length + decimals;
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

int has_plain_gaps(const char *text, int64_t length, int64_t count)
{
    int64_t found = 0, odd = 0;
    /* Counts of a few bytes fit a byte: such a loop is done many at a time. */
    for (int64_t start = 0; start < length; start += UINT8_MAX) {
        const int64_t stop = start + UINT8_MAX < length ? start + UINT8_MAX : length;
        uint8_t blanks = 0, others = 0;
        for (int64_t i = start; i < stop; i++) {
            const uint8_t c = (uint8_t)text[i];
            blanks += c <= ' ';
            others += c < ' ' && c != '\n';
        }
        found += blanks, odd += others;
    }
    return found == count && odd == 0;
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
