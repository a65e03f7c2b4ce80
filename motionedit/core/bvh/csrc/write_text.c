/* The numbers of a BVH file's rows, to text. */

#include "digits.h"
#include "text.h"

#include <math.h>
#include <string.h>

/* Every two digits. */
static const char PAIRS[] = "00010203040506070809101112131415161718192021222324"
                            "25262728293031323334353637383940414243444546474849"
                            "50515253545556575859606162636465666768697071727374"
                            "75767778798081828384858687888990919293949596979899";

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

/* Write a number with a fixed number of decimals, never as -0; returns its length, or -1 where it is too large. */
static int write_number(double value, int decimals, char *out)
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

#ifdef LOW_BYTE_FIRST
enum { MOST_SHORT = 999, MOST_SHORT_DECIMALS = 6 };

/* Every three digits, and a point. */
#define THREE(n) (('0' + (n) / 100) | ('0' + (n) / 10 % 10) << 8 | ('0' + (n) % 10) << 16 | '.' << 24)
#define TEN(n)                                                                                                         \
    THREE(n), THREE(n + 1), THREE(n + 2), THREE(n + 3), THREE(n + 4), THREE(n + 5), THREE(n + 6), THREE(n + 7),        \
        THREE(n + 8), THREE(n + 9)
#define HUNDRED(n)                                                                                                     \
    TEN(n), TEN(n + 10), TEN(n + 20), TEN(n + 30), TEN(n + 40), TEN(n + 50), TEN(n + 60), TEN(n + 70), TEN(n + 80),    \
        TEN(n + 90)
static const uint32_t THREES[1000] = {HUNDRED(0), HUNDRED(100), HUNDRED(200), HUNDRED(300), HUNDRED(400), HUNDRED(500),
    HUNDRED(600), HUNDRED(700), HUNDRED(800), HUNDRED(900)};

/* Write a number as `write_number` does, with at most MOST_SHORT_DECIMALS, and perhaps more bytes after them, but without
   a branch: neither signs nor how many digits there are can be foretold. Returns 0 where the number is not below
   MOST_SHORT, so that with a carry, too, it has three digits. */
static inline int write_short(double value, int decimals, char *out)
{
    const double size = fabs(value);
    if (!(size < MOST_SHORT))
        return 0;
    uint32_t whole = (uint32_t)(int32_t)size;
    uint32_t fraction = (uint32_t)lrint((size - (double)(int32_t)whole) * POWERS[decimals]);
    const uint32_t carry = fraction >= (uint32_t)LARGER[decimals];
    whole += carry;
    fraction = carry ? 0 : fraction;
    /* A minus or none, the digits, a point. */
    const unsigned minus = (value < 0.0) & ((whole | fraction) != 0), spare = (whole < 10) + (whole < 100);
    const uint32_t digits = THREES[whole] >> 8 * spare;
    *out = '-';
    out += minus;
    memcpy(out, &digits, sizeof digits);
    out += 4 - spare;
    fraction *= (uint32_t)LARGER[MOST_SHORT_DECIMALS - decimals];
    memcpy(out, &THREES[fraction / 1000], sizeof *THREES);
    memcpy(out + 3, &THREES[fraction % 1000], sizeof *THREES);
    return (int)(4 - spare + minus) + decimals;
}
#else
enum { MOST_SHORT_DECIMALS = 0 };

static int write_short(double value, int decimals, char *out)
{
    (void)value, (void)decimals, (void)out;
    return 0;
}
#endif

/* As `write_number`. */
static inline int write_any(double value, int decimals, char *out)
{
    const int length = decimals <= MOST_SHORT_DECIMALS ? write_short(value, decimals, out) : 0;
    return length > 0 ? length : write_number(value, decimals, out);
}

int64_t write_rows(
    const double *values, int64_t rows, int64_t columns, int decimals, const char *ending, int64_t after, char *out)
{
    char *at = out;
    for (int64_t row = 0; row < rows; row++) {
        for (int64_t column = 0; column < columns; column++) {
            const int length = write_any(values[row * columns + column], decimals, at);
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
            const int written = write_any(values[word], decimals, to);
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
