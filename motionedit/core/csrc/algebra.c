/* A layer's step and basis from its Gram matrix S = M M^T: what _damped_step of layers.py gets from eigenvectors. */

#include "layered.h"
#include "rotations.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* As in layers.py: singular values below this share of the largest (or of LEAST_SCALE) are no freedom. */
#define RANK_TOLERANCE 1e-4
#define LEAST_SCALE 1e-3
/* A pivot below this share of the trace is rounding. */
#define ROUNDING 1e-13
#define SWEEPS 30

/* L, the diagonal, and the most that any of the solutions takes. */
size_t factor_scratch(int k)
{
    return (size_t)(3 * k * k + 3 * k);
}

/* lambda by s = 1 / |A~^+|_F, which the smallest kept singular value exceeds, and the length d of b over b_max. */
static double damping(double s, double d)
{
    if (s <= 0.5 * d)
        return 0.5 * d;
    return s <= d ? sqrt(s * (d - s)) : 0.0;
}

/* A = L L^T in the lower triangle, in place; A is k x k, positive definite. */
static void cholesky(double *A, int k)
{
    for (int i = 0; i < k; i++) {
        for (int j = 0; j < i; j++)
            A[i * k + j] = (A[i * k + j] - dot_product(A + i * k, A + j * k, j)) / A[j * k + j];
        A[i * k + i] = sqrt(larger(A[i * k + i] - dot_product(A + i * k, A + i * k, i), DBL_MIN));
    }
}

/* x <- (L L^T)^-1 x */
static void cholesky_solve(const double *L, int k, double *x)
{
    for (int i = 0; i < k; i++) {
        for (int p = 0; p < i; p++)
            x[i] -= L[i * k + p] * x[p];
        x[i] /= L[i * k + i];
    }
    for (int i = k - 1; i >= 0; i--) {
        for (int p = i + 1; p < k; p++)
            x[i] -= L[p * k + i] * x[p];
        x[i] /= L[i * k + i];
    }
}

/* Cholesky with pivots, a column of M = L^T at a time, and the inverse of the pivots' triangle beside it.

   S: shape (k, k), full. Out: L, shape (rank, k), with S = L^T L on what is kept; B, shape (rank, k), lower triangular,
   with Q = B A~ orthonormal, the rows of A~ in the order of pivots; order: the pivots, then the other rows; inverse:
   |B|^2. Returns the rank: pivots up to `least` are 0. */
static int pivoted_cholesky(
    const double *S, int k, double least, double *L, double *B, int *order, double *diagonal, double *inverse)
{
    for (int i = 0; i < k; i++)
        order[i] = i, diagonal[i] = S[i * k + i];
    *inverse = 0.0;
    for (int c = 0; c < k; c++) {
        int best = c;
        for (int i = c + 1; i < k; i++)
            if (diagonal[order[i]] > diagonal[order[best]])
                best = i;
        const int row = order[best];
        order[best] = order[c], order[c] = row;
        double *l = L + c * k, *own = B + c * k;
        memcpy(l, S + row * k, sizeof *l * k);
        memset(own, 0, sizeof *own * c);
        for (int p = 0; p < c; p++) {
            const double factor = L[p * k + row];
            add_multiple(l, -factor, L + p * k, k);
            add_multiple(own, -factor, B + p * k, p + 1);
        }
        if (l[row] <= least)
            return c;
        const double pivot = sqrt(l[row]), scale = 1.0 / pivot;
        own[c] = 1.0;
        for (int i = 0; i <= c; i++) {
            own[i] *= scale;
            *inverse += own[i] * own[i];
        }
        for (int i = 0; i < k; i++) {
            l[i] *= scale;
            diagonal[i] -= l[i] * l[i];
        }
        for (int p = 0; p < c; p++)
            l[order[p]] = 0.0;
    }
    return k;
}

/* Eigenvalues on the diagonal of S and eigenvectors in the columns of U, by cyclic Jacobi rotations. */
static void jacobi(double *S, int k, double *U)
{
    memset(U, 0, sizeof(double) * k * k);
    for (int i = 0; i < k; i++)
        U[i * k + i] = 1.0;
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        double off = 0.0, all = 0.0;
        for (int i = 0; i < k; i++)
            for (int j = 0; j < k; j++)
                all += S[i * k + j] * S[i * k + j], off += i == j ? 0.0 : S[i * k + j] * S[i * k + j];
        if (off <= 1e-32 * all)
            return;
        for (int p = 0; p < k; p++)
            for (int q = p + 1; q < k; q++) {
                const double apq = S[p * k + q];
                if (apq == 0.0)
                    continue;
                const double theta = (S[q * k + q] - S[p * k + p]) / (2.0 * apq);
                const double t = copysign(1.0, theta) / (fabs(theta) + sqrt(theta * theta + 1.0));
                const double c = 1.0 / sqrt(t * t + 1.0), s = t * c;
                for (int i = 0; i < k; i++) {
                    const double a = S[i * k + p], b = S[i * k + q];
                    S[i * k + p] = c * a - s * b, S[i * k + q] = s * a + c * b;
                }
                for (int i = 0; i < k; i++) {
                    const double a = S[p * k + i], b = S[q * k + i];
                    S[p * k + i] = c * a - s * b, S[q * k + i] = s * a + c * b;
                }
                for (int i = 0; i < k; i++) {
                    const double a = U[i * k + p], b = U[i * k + q];
                    U[i * k + p] = c * a - s * b, U[i * k + q] = s * a + c * b;
                }
            }
    }
}

/* Where the rank is in doubt: the singular triples one by one, as the reference has them. */
static void factor_by_eigenvectors(Layer *layer, double *S, const double *b, double d, double *c, double *U)
{
    const int k = layer->rows;
    double largest = 0.0, inverse = 0.0;
    jacobi(S, k, U);
    for (int i = 0; i < k; i++)
        largest = larger(largest, sqrt(larger(S[i * k + i], 0.0)));
    const double tolerance = RANK_TOLERANCE * larger(largest, LEAST_SCALE);
    for (int i = 0; i < k; i++) {
        const double s = sqrt(larger(S[i * k + i], 0.0));
        if (s > tolerance)
            inverse += 1.0 / (s * s);
        layer->order[i] = i;
    }
    const double lambda = inverse > 0.0 ? damping(1.0 / sqrt(inverse), d) : 0.0;
    layer->rank = layer->triangular = 0;
    for (int i = 0; i < k; i++) {
        const double s = sqrt(larger(S[i * k + i], 0.0));
        if (!(s > tolerance))
            continue;
        double along = 0.0;
        for (int r = 0; r < k; r++) {
            layer->B[layer->rank * k + r] = U[r * k + i] / s;
            along += U[r * k + i] * b[r];
        }
        c[layer->rank++] = along * s / (s * s + lambda * lambda);
    }
}

/* Rows that are no pivots, as W times the pivots' rows: W, shape (rest, rank), and I + W W^T = N N^T. */
typedef struct {
    int rest;
    double *W, *N, *scratch;
} Dependent;

static Dependent dependent_rows(const double *L, const Layer *layer, double *scratch)
{
    const int k = layer->rows, rank = layer->rank, rest = k - rank;
    Dependent found = {rest, scratch, scratch + rest * rank, scratch + rest * (rank + rest)};
    for (int i = 0; i < rest; i++) {
        double *w = found.W + i * rank;
        memset(w, 0, sizeof *w * rank);
        for (int q = 0; q < rank; q++)
            add_multiple(w, L[q * k + layer->order[rank + i]], layer->B + q * k, q + 1);
        for (int j = 0; j <= i; j++)
            found.N[i * rest + j] = dot_product(w, found.W + j * rank, rank) + (i == j ? 1.0 : 0.0);
    }
    cholesky(found.N, rest);
    return found;
}

/* |M^+|_F^2 = |B|_F^2 - tr((I + W W^T)^-1 V V^T), V = W B^T: 1 / s^2 of the damping. */
static double squared_inverse(const Dependent *rows, const Layer *layer, double inverse)
{
    const int rank = layer->rank, rest = rows->rest;
    double *column = rows->scratch, *solved = column + rest;
    for (int q = 0; q < rank; q++) {
        for (int i = 0; i < rest; i++)
            column[i] = dot_product(rows->W + i * rank, layer->B + q * layer->rows, q + 1);
        memcpy(solved, column, sizeof *solved * rest);
        cholesky_solve(rows->N, rest, solved);
        inverse -= dot_product(column, solved, rest);
    }
    return inverse;
}

/* c = M^+ b without damping: least squares asks the pivots' rows for (I + W^T W)^-1 (b_1 + W^T b_2). */
static void solve_undamped(const Dependent *rows, const Layer *layer, const double *b, double *c)
{
    const int rank = layer->rank, rest = rows->rest;
    double *y = rows->scratch, *t = y + rank;
    for (int q = 0; q < rank; q++)
        y[q] = b[layer->order[q]];
    for (int i = 0; i < rest; i++)
        add_multiple(y, b[layer->order[rank + i]], rows->W + i * rank, rank);
    for (int i = 0; i < rest; i++)
        t[i] = dot_product(rows->W + i * rank, y, rank);
    cholesky_solve(rows->N, rest, t);
    for (int i = 0; i < rest; i++)
        add_multiple(y, -t[i], rows->W + i * rank, rank);
    for (int q = 0; q < rank; q++)
        c[q] = dot_product(layer->B + q * layer->rows, y, q + 1);
}

/* c = (M^T M + lambda^2)^-1 M^T b */
static void solve_damped(const double *L, int k, int rank, const double *b, double lambda, double *c, double *N)
{
    for (int i = 0; i < rank; i++) {
        for (int j = 0; j <= i; j++)
            N[i * rank + j] = dot_product(L + i * k, L + j * k, k);
        N[i * rank + i] += lambda * lambda;
        c[i] = dot_product(L + i * k, b, k);
    }
    cholesky(N, rank);
    cholesky_solve(N, rank, c);
}

/* Factor a layer.

   S: shape (k, k), A~ A~^T, destroyed. b: shape (k,). largest: b_max. Out: the layer's rank and B, with Q = B A~
   orthonormal, and c, shape (rank,): its step is dm = Q^T c. scratch: `factor_scratch(k)` numbers. */
void damped_factor(Layer *layer, double *S, const double *b, double largest, double *c, double *scratch)
{
    const int k = layer->rows;
    double *L = scratch, *diagonal = L + k * k, *rest = diagonal + k, trace = 0.0, inverse;
    for (int i = 0; i < k; i++)
        trace += S[i * k + i];
    const double d = sqrt(dot_product(b, b, k)) / largest;
    layer->rank = pivoted_cholesky(S, k, ROUNDING * trace, L, layer->B, layer->order, diagonal, &inverse);
    layer->triangular = 1;
    /* 1 / |B| is a lower bound of the least singular value, the root of the trace an upper one of the largest. */
    const double bound = inverse > 0.0 ? 1.0 / sqrt(inverse) : 0.0;
    if (bound <= RANK_TOLERANCE * larger(sqrt(trace), LEAST_SCALE)) {
        factor_by_eigenvectors(layer, S, b, d, c, rest);
        return;
    }
    if (d == 0.0) {
        memset(c, 0, sizeof *c * layer->rank);
        return;
    }
    const Dependent rows = dependent_rows(L, layer, rest);
    const double lambda = bound > d ? 0.0 : damping(1.0 / sqrt(squared_inverse(&rows, layer, inverse)), d);
    if (lambda > 0.0)
        solve_damped(L, k, layer->rank, b, lambda, c, rest);
    else
        solve_undamped(&rows, layer, b, c);
}
