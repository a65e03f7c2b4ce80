/* The numbers of a BVH file's rows, from text. What is no number is left to the caller.

   A number of at most 15 digits is an integer below 2^53 over a power of ten that a double holds exactly, so that one
   division rounds it correctly; others are read by `read`. */

#include "digits.h"
#include "text.h"

#include <string.h>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

static int is_digit(char c)
{
    return c >= '0' && c <= '9';
}

#ifdef LOW_BYTE_FIRST
/* Add the digits that eight characters begin with to a number; returns how many these are. The first character is the
   lowest byte: digits are moved up until zeros stand before them, and added by pairs, fours and eights. */
static int add_digits(const char *at, uint64_t *number)
{
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

#ifdef __SSE2__
/* Bytes of a line that are looked at for blanks at once, and those that a number may have. */
enum { AT_ONCE = 64, MOST_LENGTH = 16, MOST_WHOLE = 4, MOST_FRACTION = 8 };

/* By what a number is divided, by its minus and its decimals: so that of zero, too, the sign is right. */
static const double SIGNED_POWERS[2][MOST_FRACTION + 1] = {
    {1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8}, {-1e0, -1e1, -1e2, -1e3, -1e4, -1e5, -1e6, -1e7, -1e8}};

/* Which of 64 characters end a word: blanks and control characters. */
static uint64_t ends_of_words(const char *at)
{
    uint64_t ends = 0;
    for (int i = 0; i < AT_ONCE; i += 16) {
        const __m128i text = _mm_loadu_si128((const __m128i *)(at + i));
        const __m128i is_end = _mm_cmpeq_epi8(_mm_min_epu8(text, _mm_set1_epi8(' ')), text);
        ends |= (uint64_t)(unsigned)_mm_movemask_epi8(is_end) << i;
    }
    return ends;
}

/* Read a word that is a number as most are: a minus or none, digits, a point, digits. Without a branch that depends on
   how many digits there are, or on the sign: these cannot be foretold. Returns 0 where it is none. */
static inline int read_plain(const char *at, int64_t length, double *value, int64_t *decimals)
{
    const __m128i text = _mm_loadu_si128((const __m128i *)at), digit = _mm_sub_epi8(text, _mm_set1_epi8('0'));
    const unsigned points = (unsigned)_mm_movemask_epi8(_mm_cmpeq_epi8(text, _mm_set1_epi8('.')));
    const unsigned digits = (unsigned)_mm_movemask_epi8(_mm_cmpeq_epi8(_mm_min_epu8(digit, _mm_set1_epi8(9)), digit));
    const unsigned minus = *at == '-', point = (unsigned)__builtin_ctz(points | 1u << MOST_LENGTH);
    /* Below zero they wrap around. */
    const unsigned whole = point - minus, fraction = (unsigned)length - point - 1;
    if (length > MOST_LENGTH || whole > MOST_WHOLE || fraction > MOST_FRACTION || whole + fraction == 0 ||
        (~(digits | 1u << point | minus) & ((1u << length) - 1)) != 0)
        return 0;
    uint32_t upper;
    uint64_t lower;
    memcpy(&upper, at + minus, sizeof upper);
    memcpy(&lower, at + point + 1, sizeof lower);
    /* Zeros before the digits, by two shifts: one by all bits is none. Then by pairs, fours and eights. */
    upper = (upper & 0x0F0F0F0F) << 4 * (4 - whole) << 4 * (4 - whole);
    lower = (lower & 0x0F0F0F0F0F0F0F0F) << 4 * (8 - fraction) << 4 * (8 - fraction);
    upper = (upper * 2561 >> 8 & 0x00FF00FF) * 6553601 >> 16;
    lower = (lower * 2561 >> 8 & 0x00FF00FF00FF00FF) * 6553601 >> 16;
    lower = (lower & 0x0000FFFF0000FFFF) * 42949672960001 >> 32;
    *value = (double)(int64_t)(upper * LARGER[fraction] + lower) / SIGNED_POWERS[minus][fraction];
    *decimals = fraction > *decimals ? fraction : *decimals;
    return 1;
}

/* Read a line's numbers as long as they are as most are, and followed by one blank. Where the next one begins is known
   before one is read: the processor need not wait for it. Returns how many there were; *at goes to what follows. */
static int64_t read_plains(const char **at, const char *end, int64_t count, double *values, int64_t *decimals)
{
    const char *from = *at;
    uint64_t ends = 0;
    int64_t read = 0;
    for (const char *block = from - AT_ONCE; read < count; read++) {
        while (ends == 0) {
            block += AT_ONCE;
            /* A word that ends here may be looked at as far beyond. */
            if (end - block < 2 * AT_ONCE)
                return *at = from, read;
            ends = ends_of_words(block);
        }
        const char *const stop = block + __builtin_ctzll(ends);
        if (*stop != ' ' || !read_plain(from, stop - from, values + read, decimals))
            break;
        ends &= ends - 1;
        from = stop + 1;
    }
    return *at = from, read;
}
#else
static int64_t read_plains(const char **at, const char *end, int64_t count, double *values, int64_t *decimals)
{
    (void)at, (void)end, (void)count, (void)values, (void)decimals;
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

/* Pass over the blanks within a line. */
static const char *after_blanks(const char *at, const char *end)
{
    while (at < end && is_blank(*at) && *at != '\n' && *at != '\r')
        at++;
    return at;
}

int read_rows(const char *text, int64_t length, int64_t columns, int64_t room, ReadDouble *read, double *values,
    int64_t *starts, int64_t *stops, RowsFound *found)
{
    const char *at = text, *const end = text + length;
    int64_t rows = 0, decimals = 0;
    for (;; rows++) {
        while (at < end && is_blank(*at))
            at++;
        if (at == end)
            break;
        if (rows == room)
            return 0;
        starts[rows] = at - text;
        for (int64_t column = read_plains(&at, end, columns - 1, values, &decimals); column < columns; column++) {
            at = after_blanks(at, end);
            if (at == end || (at = read_number(at, end, read, values + column, &decimals)) == NULL)
                return 0;
        }
        stops[rows] = at - text;
        values += columns;
        at = after_blanks(at, end);
        if (at < end && !is_blank(*at))
            return 0;
    }
    found->rows = rows, found->decimals = decimals;
    return 1;
}
