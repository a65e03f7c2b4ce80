/* The pass down the layers among the rows of one frame: layers.py's `descend`, in rank space. */

#include "layered.h"

#include <math.h>
#include <string.h>

/* Metres: a layer's error is clamped to this much, all its rows by one factor. */
#define LARGEST_ERROR 0.6

/* C_l, shape (rows, first_rank): what the rows of a layer have along the orthonormal rows Q of those above. */
static void against_layers_above(Frame *frame, int l)
{
    const int64_t R = frame->problem->rows;
    const Layer *layer = frame->layers + l;
    for (int r = layer->first_row; r < layer->first_row + layer->rows; r++) {
        double *C = frame->C + r * R;
        for (int m = 0; m < l; m++) {
            const Layer *above = frame->layers + m;
            double *rest = frame->scratch_rows;
            for (int s = 0; s < above->rows; s++) {
                const double *theirs = frame->C + (above->first_row + s) * R;
                double sum = frame->G_free[r * R + above->first_row + s];
                for (int q = 0; q < above->first_rank; q++)
                    sum -= C[q] * theirs[q];
                rest[s] = sum;
            }
            for (int q = 0; q < above->rank; q++) {
                double sum = 0.0;
                for (int s = 0; s < above->rows; s++)
                    sum += above->B[q * above->rows + s] * rest[s];
                C[above->first_rank + q] = sum;
            }
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
    for (int r = 0; r < layer->rows; r++) {
        const double *C = frame->C + (layer->first_row + r) * problem->rows;
        b[r] = factor * e[r];
        for (int q = 0; q < layer->first_rank; q++)
            b[r] -= C[q] * frame->c[q];
        for (int64_t h = 0; h < problem->hinges; h++)
            if (!frame->hinge_free[h])
                b[r] -= frame->hinge_rows[h * problem->rows + layer->first_row + r] * frame->hinge_fixed[h];
    }
}

/* S = A~ A~^T = G_ll - C_l C_l^T, shape (rows, rows). */
static void layer_gram(const Frame *frame, const Layer *layer, double *S)
{
    const int64_t R = frame->problem->rows;
    for (int r = 0; r < layer->rows; r++)
        for (int s = 0; s <= r; s++) {
            const double *mine = frame->C + (layer->first_row + r) * R, *theirs = frame->C + (layer->first_row + s) * R;
            double sum = frame->G_free[(layer->first_row + r) * R + layer->first_row + s];
            for (int q = 0; q < layer->first_rank; q++)
                sum -= mine[q] * theirs[q];
            S[r * layer->rows + s] = S[s * layer->rows + r] = sum;
        }
}

/* G without the hinges that are on their limits: a rank-one part less for each. */
static void free_gram(Frame *frame)
{
    const Problem *problem = frame->problem;
    const int64_t R = problem->rows;
    memcpy(frame->G_free, frame->G, sizeof *frame->G * R * R);
    for (int64_t h = 0; h < problem->hinges; h++) {
        if (frame->hinge_free[h])
            continue;
        const double *rows = frame->hinge_rows + h * R;
        for (int64_t r = 0; r < R; r++)
            for (int64_t q = 0; q <= r; q++)
                frame->G_free[r * R + q] -= rows[r] * rows[q];
    }
}

/* One pass: c, the steps of all layers in rank space, and for each layer its rank, M and B. */
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
        layer->rank = damped_factor(S, layer->rows, b, largest, layer->M, layer->B, frame->c + rank, scratch);
        rank += layer->rank;
    }
}

/* Q v from J v: shapes (R,) and (ranks,). */
void into_rank_space(const Frame *frame, const double *Jv, double *Qv)
{
    for (int l = 0; l < frame->problem->layers; l++) {
        const Layer *layer = frame->layers + l;
        double *rest = frame->scratch_rows;
        for (int s = 0; s < layer->rows; s++) {
            const double *C = frame->C + (layer->first_row + s) * frame->problem->rows;
            rest[s] = Jv[layer->first_row + s];
            for (int q = 0; q < layer->first_rank; q++)
                rest[s] -= C[q] * Qv[q];
        }
        for (int q = 0; q < layer->rank; q++) {
            double sum = 0.0;
            for (int s = 0; s < layer->rows; s++)
                sum += layer->B[q * layer->rows + s] * rest[s];
            Qv[layer->first_rank + q] = sum;
        }
    }
}

/* y with J^T y = Q^T q; q, shape (ranks,), is used up. */
void out_of_rank_space(const Frame *frame, double *q, double *y)
{
    for (int l = (int)frame->problem->layers - 1; l >= 0; l--) {
        const Layer *layer = frame->layers + l;
        for (int s = 0; s < layer->rows; s++) {
            const double *C = frame->C + (layer->first_row + s) * frame->problem->rows;
            double sum = 0.0;
            for (int p = 0; p < layer->rank; p++)
                sum += layer->B[p * layer->rows + s] * q[layer->first_rank + p];
            y[layer->first_row + s] = sum;
            for (int p = 0; p < layer->first_rank; p++)
                q[p] -= C[p] * sum;
        }
    }
}
