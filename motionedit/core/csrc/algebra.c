/* A layer's step and basis from its Gram matrix S = M M^T: what _damped_step of layers.py gets from eigenvectors. */

#include "layered.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* As in layers.py: singular values below this share of the largest (or of LEAST_SCALE) are no freedom. */
#define RANK_TOLERANCE 1e-4
#define LEAST_SCALE 1e-3
/* A pivot below this share of the trace is rounding. */
#define ROUNDING 1e-13
#define SWEEPS 30

/* L, the diagonal, and the most that any of the three solutions takes. */
size_t factor_scratch(int k) { return (size_t)(3 * k * k + 5 * k); }

/* out += factor a */
static void add_multiple(double *restrict out, double factor, const double *restrict a, int n)
{
    for (int i = 0; i < n; i++)
        out[i] += factor * a[i];
}

/* lambda by the smallest kept singular value s and the length d of b over b_max: none where the step is safe. */
static double damping(double s, double d)
{
    if (s <= 0.5 * d)
        return 0.5 * d;
    return s <= d ? sqrt(s * (d - s)) : 0.0;
}

/* A = L L^T in the lower triangle, in place; A is k x k, positive definite. */
static void cholesky(double *A, int k)
{
    for (int j = 0; j < k; j++) {
        for (int i = j; i < k; i++) {
            double sum = A[i * k + j];
            for (int p = 0; p < j; p++)
                sum -= A[i * k + p] * A[j * k + p];
            A[i * k + j] = i == j ? sqrt(fmax(sum, DBL_MIN)) : sum / A[j * k + j];
        }
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

/* The least eigenvalue of a symmetric k x k matrix, which is destroyed: Householder, then implicit QL, without vectors. */
static double least_eigenvalue(double *A, int k, double *d, double *e)
{
    for (int i = k - 1; i > 0; i--) {
        const int l = i - 1;
        double h = 0.0, scale = 0.0;
        if (l > 0) {
            for (int m = 0; m <= l; m++)
                scale += fabs(A[i * k + m]);
            if (scale == 0.0)
                e[i] = A[i * k + l];
            else {
                for (int m = 0; m <= l; m++) {
                    A[i * k + m] /= scale;
                    h += A[i * k + m] * A[i * k + m];
                }
                double f = A[i * k + l];
                double g = f >= 0.0 ? -sqrt(h) : sqrt(h);
                e[i] = scale * g;
                h -= f * g;
                A[i * k + l] = f - g;
                f = 0.0;
                for (int j = 0; j <= l; j++) {
                    g = 0.0;
                    for (int m = 0; m <= j; m++)
                        g += A[j * k + m] * A[i * k + m];
                    for (int m = j + 1; m <= l; m++)
                        g += A[m * k + j] * A[i * k + m];
                    e[j] = g / h;
                    f += e[j] * A[i * k + j];
                }
                const double hh = f / (h + h);
                for (int j = 0; j <= l; j++) {
                    f = A[i * k + j];
                    e[j] = g = e[j] - hh * f;
                    for (int m = 0; m <= j; m++)
                        A[j * k + m] -= f * e[m] + g * A[i * k + m];
                }
            }
        } else
            e[i] = A[i * k + l];
    }
    for (int i = 0; i < k; i++)
        d[i] = A[i * k + i];
    for (int i = 1; i < k; i++)
        e[i - 1] = e[i];
    e[k - 1] = 0.0;
    for (int l = 0; l < k; l++) {
        for (int round = 0; round < SWEEPS; round++) {
            int m = l;
            for (; m < k - 1; m++) {
                const double size = fabs(d[m]) + fabs(d[m + 1]);
                if (fabs(e[m]) <= DBL_EPSILON * size)
                    break;
            }
            if (m == l)
                break;
            double g = (d[l + 1] - d[l]) / (2.0 * e[l]), r = hypot(g, 1.0);
            g = d[m] - d[l] + e[l] / (g + copysign(r, g));
            double s = 1.0, c = 1.0, p = 0.0;
            int i = m - 1;
            for (; i >= l; i--) {
                double f = s * e[i];
                const double b = c * e[i];
                e[i + 1] = r = hypot(f, g);
                if (r == 0.0) {
                    d[i + 1] -= p;
                    e[m] = 0.0;
                    break;
                }
                s = f / r, c = g / r;
                g = d[i + 1] - p;
                r = (d[i] - g) * s + 2.0 * c * b;
                p = s * r;
                d[i + 1] = g + p;
                g = c * r - b;
            }
            if (r == 0.0 && i >= l)
                continue;
            d[l] -= p, e[l] = g, e[m] = 0.0;
        }
    }
    double least = d[0];
    for (int i = 1; i < k; i++)
        least = fmin(least, d[i]);
    return least;
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
    double largest = 0.0, least = INFINITY;
    jacobi(S, k, U);
    for (int i = 0; i < k; i++)
        largest = fmax(largest, sqrt(fmax(S[i * k + i], 0.0)));
    const double tolerance = RANK_TOLERANCE * fmax(largest, LEAST_SCALE);
    for (int i = 0; i < k; i++) {
        const double s = sqrt(fmax(S[i * k + i], 0.0));
        if (s > tolerance)
            least = fmin(least, s);
        layer->order[i] = i;
    }
    const double lambda = damping(least, d);
    layer->rank = layer->triangular = 0;
    for (int i = 0; i < k; i++) {
        const double s = sqrt(fmax(S[i * k + i], 0.0));
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

/* c = M^+ b without damping. Rows that are no pivots are W times the pivots' rows, and least squares asks for
   (I + W^T W)^-1 (b_1 + W^T b_2) there: a system of as many unknowns as there are such rows. */
static void solve_undamped(
    const double *L, const double *B, int k, int rank, const int *order, const double *b, double *c, double *scratch)
{
    const int rest = k - rank;
    double *W = scratch, *N = W + rest * rank, *t = N + rest * rest, *y = t + rest;
    for (int q = 0; q < rank; q++)
        y[q] = b[order[q]];
    for (int i = 0; i < rest; i++) {
        double *w = W + i * rank;
        memset(w, 0, sizeof *w * rank);
        for (int q = 0; q < rank; q++)
            add_multiple(w, L[q * k + order[rank + i]], B + q * k, q + 1);
        add_multiple(y, b[order[rank + i]], w, rank);
    }
    if (rest > 0) {
        for (int i = 0; i < rest; i++) {
            for (int j = 0; j <= i; j++)
                N[i * rest + j] = dot_product(W + i * rank, W + j * rank, rank);
            N[i * rest + i] += 1.0;
            t[i] = dot_product(W + i * rank, y, rank);
        }
        cholesky(N, rest);
        cholesky_solve(N, rest, t);
        for (int i = 0; i < rest; i++)
            add_multiple(y, -t[i], W + i * rank, rank);
    }
    for (int q = 0; q < rank; q++)
        c[q] = dot_product(B + q * k, y, q + 1);
}

/* c = (M^T M + lambda^2)^-1 M^T b, with lambda by the least singular value. */
static void solve_damped(const double *L, int k, int rank, const double *b, double d, double *c, double *scratch)
{
    double *N = scratch, *copy = scratch + rank * rank, *diagonal = copy + rank * rank, *off = diagonal + rank;
    for (int i = 0; i < rank; i++) {
        for (int j = 0; j <= i; j++)
            N[i * rank + j] = N[j * rank + i] = dot_product(L + i * k, L + j * k, k);
        c[i] = dot_product(L + i * k, b, k);
    }
    memcpy(copy, N, sizeof *N * rank * rank);
    const double lambda = damping(sqrt(fmax(least_eigenvalue(copy, rank, diagonal, off), 0.0)), d);
    for (int i = 0; i < rank; i++)
        N[i * rank + i] += lambda * lambda;
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
    const int rank = pivoted_cholesky(S, k, ROUNDING * trace, L, layer->B, layer->order, diagonal, &inverse);
    /* 1 / |B| is a lower bound of the least singular value, the root of the trace an upper one of the largest. */
    const double bound = inverse > 0.0 ? 1.0 / sqrt(inverse) : 0.0;
    if (bound <= RANK_TOLERANCE * fmax(sqrt(trace), LEAST_SCALE)) {
        factor_by_eigenvectors(layer, S, b, d, c, rest);
        return;
    }
    layer->rank = rank, layer->triangular = 1;
    if (bound > d)
        solve_undamped(L, layer->B, k, rank, layer->order, b, c, rest);
    else
        solve_damped(L, k, rank, b, d, c, rest);
}
