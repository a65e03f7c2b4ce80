/* The numbers of a BVH file's rows: from text, and to it. */

#ifndef MOTIONEDIT_TEXT_H
#define MOTIONEDIT_TEXT_H

#include <stdint.h>

/* What was found among the rows of a block: how many rows, and the largest number of decimals. */
typedef struct {
    int64_t rows, decimals;
} RowsFound;

enum { LONGEST_WORD = 63 };

/* Read a number of any form, correctly rounded; returns 0 where it is not finite. */
typedef int ReadDouble(const char *word, int64_t length, double *value);

/* Read whole rows of `columns` numbers from `length` characters: their values, where each row begins, and where
   it ends. Returns 0 where anything else stands there, or more rows than there is room for. */
int read_rows(const char *text, int64_t length, int64_t columns, int64_t room, ReadDouble *read, double *values,
    int64_t *starts, int64_t *stops, RowsFound *found);

/* The most characters that a number of so many decimals takes. */
int64_t longest_number(int decimals);

/* Write N rows of `columns` numbers with a fixed number of decimals, never as -0, a blank between two and `ending` after
   each row, in N * columns * `longest_number` bytes and those of the endings; returns the length of the text, or -1 where a number is too large. */
int64_t write_rows(
    const double *values, int64_t rows, int64_t columns, int decimals, const char *ending, int64_t after, char *out);

/* Return whether a text's blanks are `count` single ones, a blank or a line feed each, given that it has that many gaps. */
int has_plain_gaps(const char *text, int64_t length, int64_t count);

/* Copy text with `count` words, those of the touched cells replaced by numbers; returns the length of the new text, or -1
   where a number is too large, or the words are not as many. */
int64_t splice_words(const char *text, int64_t length, const uint8_t *cells, const double *values, int64_t count,
    int decimals, char *out);

#endif
