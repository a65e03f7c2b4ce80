/* The pass down the layers among the rows of one frame: layers.py's `descend`, in rank space. */

#include "layered.h"

#include <math.h>
#include <string.h>

/* Metres: a layer's error is clamped to this much, all its rows by one factor. */
#define LARGEST_ERROR 0.6

/* q = B_l times numbers of the layer's rows, which are put into B's order first. */
static void times_B(const Layer *layer, const double *rows, double *ordered, double *q)
{
    for (int s = 0; s < layer->rows; s++)
        ordered[s] = rows[layer->order[s]];
    for (int p = 0; p < layer->rank; p++)
        q[p] = dot_product(layer->B + p * layer->rows, ordered, layer->triangular ? p + 1 : layer->rows);
}

/* Numbers of the layer's rows less what the layers above account for: rows - C_l q_above, in `rest` if it differs. */
static const double *less_above(
    const Frame *frame, const Layer *layer, const double *rows, const double *above, double *rest)
{
    const double *C = frame->C + layer->first_row * frame->problem->rows;
    if (layer->first_rank == 0)
        return rows;
    for (int s = 0; s < layer->rows; s++, C += frame->problem->rows)
        rest[s] = rows[s] - dot_product(C, above, layer->first_rank);
    return rest;
}

/* C_l, shape (rows, first_rank): what the rows of a layer have along the orthonormal rows Q of those above. */
static void against_layers_above(Frame *frame, int l)
{
    const int64_t R = frame->problem->rows;
    const Layer *layer = frame->layers + l;
    for (int r = layer->first_row; r < layer->first_row + layer->rows; r++) {
        double *C = frame->C + r * R, *rest = frame->scratch_rows;
        for (int m = 0; m < l; m++) {
            const Layer *above = frame->layers + m;
            const double *own = less_above(frame, above, frame->G_free + r * R + above->first_row, C, rest);
            times_B(above, own, rest + R, C + above->first_rank);
        }
    }
}

/* b = clamped e - A dm, dm being what the layers above and the hinges on their limits do. */
static void remaining_error(Frame *frame, const Layer *layer, double largest, double *b)
{
    const Problem *problem = frame->problem;
    const double *e = frame->errors + layer->first_row;
    double size = 0.0;
    for (int r = 0; r < layer->rows; r++)
        size += e[r] * e[r];
    size = sqrt(size);
    const double factor = size > largest ? largest / size : 1.0;
    for (int r = 0; r < layer->rows; r++)
        b[r] = factor * e[r];
    less_above(frame, layer, b, frame->c, b);
    for (int64_t h = 0; h < problem->hinges; h++)
        for (int r = 0; r < layer->rows && !frame->hinge_free[h]; r++)
            b[r] -= frame->hinge_rows[h * problem->rows + layer->first_row + r] * frame->hinge_fixed[h];
}

/* S = A~ A~^T = G_ll - C_l C_l^T, shape (rows, rows). */
static void layer_gram(const Frame *frame, const Layer *layer, double *S)
{
    const int64_t R = frame->problem->rows;
    for (int r = 0; r < layer->rows; r++)
        for (int s = 0; s <= r; s++) {
            const double *mine = frame->C + (layer->first_row + r) * R, *theirs = frame->C + (layer->first_row + s) * R;
            double sum = frame->G_free[(layer->first_row + r) * R + layer->first_row + s];
            if (layer->first_rank > 0)
                sum -= dot_product(mine, theirs, layer->first_rank);
            S[r * layer->rows + s] = S[s * layer->rows + r] = sum;
        }
}

/* G without the hinges that are on their limits: a rank-one part less for each. */
static void free_gram(Frame *frame)
{
    const int64_t R = frame->problem->rows;
    frame->G_free = frame->G;
    for (int64_t h = 0; h < frame->problem->hinges; h++) {
        if (frame->hinge_free[h])
            continue;
        if (frame->G_free == frame->G)
            frame->G_free = memcpy(frame->G_frozen, frame->G, sizeof *frame->G * R * R);
        add_hinge(frame, h, -1.0, frame->G_frozen);
    }
}

/* One pass: c, the steps of all layers in rank space, and for each layer its rank and B. */
void descend(Frame *frame, double anneal)
{
    double *S = frame->algebra, *b = S + frame->problem->rows * frame->problem->rows;
    double *scratch = b + frame->problem->rows;
    int rank = 0;
    free_gram(frame);
    for (int l = 0; l < frame->problem->layers; l++) {
        Layer *layer = frame->layers + l;
        const double largest = l == 0 ? LARGEST_ERROR : LARGEST_ERROR * anneal;
        layer->first_rank = rank;
        against_layers_above(frame, l);
        remaining_error(frame, layer, largest, b);
        layer_gram(frame, layer, S);
        damped_factor(layer, S, b, largest, frame->c + rank, scratch);
        rank += layer->rank;
    }
}

/* Q v from J v: shapes (R,) and (ranks,). */
void into_rank_space(const Frame *frame, const double *Jv, double *Qv)
{
    for (int l = 0; l < frame->problem->layers; l++) {
        const Layer *layer = frame->layers + l;
        double *rest = frame->scratch_rows;
        const double *own = less_above(frame, layer, Jv + layer->first_row, Qv, rest);
        times_B(layer, own, rest + frame->problem->rows, Qv + layer->first_rank);
    }
}

/* y with J^T y = Q^T q; q, shape (ranks,), is used up. */
void out_of_rank_space(const Frame *frame, double *q, double *y)
{
    for (int l = (int)frame->problem->layers - 1; l >= 0; l--) {
        const Layer *layer = frame->layers + l;
        double *own = y + layer->first_row, *ordered = frame->scratch_rows;
        memset(ordered, 0, sizeof *ordered * layer->rows);
        for (int p = 0; p < layer->rank; p++)
            add_multiple(
                ordered, q[layer->first_rank + p], layer->B + p * layer->rows, layer->triangular ? p + 1 : layer->rows);
        for (int s = 0; s < layer->rows; s++)
            own[layer->order[s]] = ordered[s];
        for (int s = 0; s < layer->rows && layer->first_rank > 0; s++) {
            add_multiple(q, -own[s], frame->C + (layer->first_row + s) * frame->problem->rows, layer->first_rank);
        }
    }
}
