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

/* Numbers that are written together, as whole parts and decimals, both integers. */
enum { TOGETHER = 64 };
typedef struct {
    uint32_t whole[TOGETHER], fraction[TOGETHER];
} Split;

#ifdef LOW_BYTE_FIRST
enum { MOST_SHORT = 999, MOST_SHORT_DECIMALS = 6 };

/* Every three digits, the first one in the lowest byte, and as whole parts: without zeros before them, a point after them,
   and in the upper half how many characters these are. */
#define DIGITS(n) (('0' + (n) / 100) | ('0' + (n) / 10 % 10) << 8 | ('0' + (n) % 10) << 16)
#define SPARE(n) (((n) < 10) + ((n) < 100))
#define WHOLE(n) ((DIGITS(n) | '.' << 24) >> 8 * SPARE(n) | (uint64_t)(4 - SPARE(n)) << 32)
#define TEN(of, n)                                                                                                     \
    of(n), of(n + 1), of(n + 2), of(n + 3), of(n + 4), of(n + 5), of(n + 6), of(n + 7), of(n + 8), of(n + 9)
#define HUNDRED(of, n)                                                                                                 \
    TEN(of, n), TEN(of, n + 10), TEN(of, n + 20), TEN(of, n + 30), TEN(of, n + 40), TEN(of, n + 50), TEN(of, n + 60),  \
        TEN(of, n + 70), TEN(of, n + 80), TEN(of, n + 90)
#define THOUSAND(of)                                                                                                   \
    {HUNDRED(of, 0), HUNDRED(of, 100), HUNDRED(of, 200), HUNDRED(of, 300), HUNDRED(of, 400), HUNDRED(of, 500),         \
        HUNDRED(of, 600), HUNDRED(of, 700), HUNDRED(of, 800), HUNDRED(of, 900)}
static const uint32_t THREES[1000] = THOUSAND(DIGITS);
static const uint64_t WHOLES[1000] = THOUSAND(WHOLE);

/* Split numbers into whole parts and so many decimals, several at once. Beside 2^52 a double has no bits for parts: what is
   added to it is rounded as by `lrint`, and stands in its lowest bits. Of a number that is not below MOST_SHORT that is
   the whole part. */
static void split_numbers(const double *values, int64_t count, int decimals, Split *split)
{
    const double power = POWERS[decimals], large = 4503599627370496.0;
    for (int64_t i = 0; i < count; i++) {
        const double size = fabs(values[i]) < MOST_SHORT ? fabs(values[i]) : MOST_SHORT;
        const int32_t whole = (int32_t)size;
        const double rounded = (size - (double)whole) * power + large;
        uint64_t bits;
        memcpy(&bits, &rounded, sizeof bits);
        split->whole[i] = (uint32_t)whole, split->fraction[i] = (uint32_t)bits;
    }
}

/* Write a number, split as it is, as `write_number` does, and perhaps more bytes after it, but without a branch: neither
   signs nor how many digits there are can be foretold. Returns 0 where it is not below MOST_SHORT. */
static inline int write_short(double value, uint32_t whole, uint32_t fraction, int decimals, char *out)
{
    const uint32_t carry = fraction >= (uint32_t)LARGER[decimals];
    whole += carry;
    fraction = carry ? 0 : fraction;
    if (whole >= MOST_SHORT)
        return 0;
    /* A minus or none, the digits and a point, the decimals. */
    const int minus = (value < 0.0) & ((whole | fraction) != 0), length = (int)(WHOLES[whole] >> 32) + minus;
    const uint32_t first = (uint32_t)WHOLES[whole];
    *out = '-';
    memcpy(out + minus, &first, sizeof first);
    fraction *= (uint32_t)LARGER[MOST_SHORT_DECIMALS - decimals];
    const uint64_t rest = THREES[fraction / 1000] | (uint64_t)THREES[fraction % 1000] << 24;
    memcpy(out + length, &rest, sizeof rest);
    return length + decimals;
}
#else
enum { MOST_SHORT_DECIMALS = 0 };

static void split_numbers(const double *values, int64_t count, int decimals, Split *split)
{
    (void)values, (void)count, (void)decimals, (void)split;
}

static int write_short(double value, uint32_t whole, uint32_t fraction, int decimals, char *out)
{
    (void)value, (void)whole, (void)fraction, (void)decimals, (void)out;
    return 0;
}
#endif

/* Write numbers as `write_number` does, a blank after each; returns the end, or NULL where one is too large. */
static char *write_numbers(const double *values, int64_t count, int decimals, char *out)
{
    const int is_short = decimals <= MOST_SHORT_DECIMALS;
    Split split;
    for (int64_t start = 0; start < count; start += TOGETHER, values += TOGETHER) {
        const int64_t many = count - start < TOGETHER ? count - start : TOGETHER;
        if (is_short)
            split_numbers(values, many, decimals, &split);
        for (int64_t i = 0; i < many; i++) {
            int length = is_short ? write_short(values[i], split.whole[i], split.fraction[i], decimals, out) : 0;
            if (length == 0 && (length = write_number(values[i], decimals, out)) < 0)
                return NULL;
            out += length;
            *out++ = ' ';
        }
    }
    return out;
}

int64_t write_rows(
    const double *values, int64_t rows, int64_t columns, int decimals, const char *ending, int64_t after, char *out)
{
    char *at = out;
    for (int64_t row = 0; row < rows; row++) {
        if ((at = write_numbers(values + row * columns, columns, decimals, at)) == NULL)
            return -1;
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

enum { USUAL_WORD = 16 }; /* characters that are copied at once, less than the longest number of one decimal */

/* Where a word ends that begins at `at`. */
static inline const char *end_of_word(const char *at, const char *end)
{
#ifdef LOW_BYTE_FIRST
    /* Of eight characters the highest bit of each that is a blank or a control, of the first of them for sure: how long
       numbers are cannot be foretold. */
    for (uint64_t eight, blanks; end - at >= 8; at += 8) {
        memcpy(&eight, at, sizeof eight);
        blanks = (eight - 0x2121212121212121u) & ~eight & 0x8080808080808080u;
        if (blanks != 0) {
            at += __builtin_ctzll(blanks) / 8;
            break;
        }
    }
#endif
    while (at < end && !is_blank(*at))
        at++;
    return at;
}

int64_t splice_words(const char *text, int64_t length, const uint8_t *cells, const double *values, int64_t count,
    int decimals, char *out)
{
    const char *at = text, *const end = text + length;
    const int is_short = decimals <= MOST_SHORT_DECIMALS;
    Split split;
    char *to = out;
    int64_t word = 0;
    while (at < end) {
        if (is_blank(*at)) {
            *to++ = *at++;
            continue;
        }
        const char *const stop = end_of_word(at, end);
        const int64_t place = word % TOGETHER;
        if (word == count)
            return -1;
        if (place == 0 && is_short)
            split_numbers(values + word, count - word < TOGETHER ? count - word : TOGETHER, decimals, &split);
        if (cells[word]) {
            int written = 0;
            if (is_short)
                written = write_short(values[word], split.whole[place], split.fraction[place], decimals, to);
            if (written == 0 && (written = write_number(values[word], decimals, to)) < 0)
                return -1;
            to += written;
        } else {
            /* There is room for the longest number in its place. */
            if (stop - at <= USUAL_WORD && end - at >= USUAL_WORD)
                memcpy(to, at, USUAL_WORD);
            else
                memcpy(to, at, stop - at);
            to += stop - at;
        }
        at = stop;
        word++;
    }
    return word == count ? to - out : -1;
}
