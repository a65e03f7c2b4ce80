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
/* A layer of more rows is always factored by eigenvectors. */
#define MOST_ROWS 256

size_t factor_scratch(int k) { return (size_t)(3 * k * k + 4 * k); }

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

/* Cholesky with pivots: rows order[0..k) of S are L L^T, L k x rank, lower; returns the rank. */
static int pivoted_cholesky(double *S, int k, double least, int *order)
{
    for (int i = 0; i < k; i++)
        order[i] = i;
    for (int c = 0; c < k; c++) {
        int best = c;
        for (int i = c + 1; i < k; i++)
            if (S[i * k + i] > S[best * k + best])
                best = i;
        if (S[best * k + best] <= least)
            return c;
        if (best != c) {
            const int other = order[c];
            order[c] = order[best], order[best] = other;
            for (int p = 0; p < k; p++) {
                const double t = S[c * k + p];
                S[c * k + p] = S[best * k + p], S[best * k + p] = t;
            }
            for (int p = 0; p < k; p++) {
                const double t = S[p * k + c];
                S[p * k + c] = S[p * k + best], S[p * k + best] = t;
            }
        }
        const double pivot = sqrt(S[c * k + c]), inverse = 1.0 / pivot;
        S[c * k + c] = pivot;
        for (int i = c + 1; i < k; i++)
            S[i * k + c] *= inverse;
        for (int i = c + 1; i < k; i++) {
            const double l = S[i * k + c];
            for (int j = c + 1; j <= i; j++) {
                S[i * k + j] -= l * S[j * k + c];
                S[j * k + i] = S[i * k + j];
            }
        }
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
static int factor_by_eigenvectors(
    double *S, int k, const double *b, double d, double *M, double *B, double *c, double *U)
{
    double largest = 0.0, least = INFINITY;
    int rank = 0;
    jacobi(S, k, U);
    for (int i = 0; i < k; i++)
        largest = fmax(largest, sqrt(fmax(S[i * k + i], 0.0)));
    for (int i = 0; i < k; i++) {
        const double s = sqrt(fmax(S[i * k + i], 0.0));
        if (s > RANK_TOLERANCE * fmax(largest, LEAST_SCALE)) {
            least = fmin(least, s);
            rank++;
        }
    }
    const double lambda = damping(least, d);
    for (int i = 0, q = 0; i < k; i++) {
        const double s = sqrt(fmax(S[i * k + i], 0.0));
        if (!(s > RANK_TOLERANCE * fmax(largest, LEAST_SCALE)))
            continue;
        double along = 0.0;
        for (int r = 0; r < k; r++) {
            M[r * rank + q] = U[r * k + i] * s;
            B[q * k + r] = U[r * k + i] / s;
            along += U[r * k + i] * b[r];
        }
        c[q++] = along * s / (s * s + lambda * lambda);
    }
    return rank;
}

/* c <- (M^T M + lambda^2)^-1 M^T b, with the least singular value found first where `wants` says that it may matter. */
static void damped_solve(
    const double *M, int k, int rank, const double *b, double d, int wants, double *c, double *scratch)
{
    double *N = scratch, *copy = scratch + rank * rank, *diagonal = copy + rank * rank, *off = diagonal + rank;
    for (int i = 0; i < rank; i++) {
        for (int j = 0; j <= i; j++) {
            double sum = 0.0;
            for (int r = 0; r < k; r++)
                sum += M[r * rank + i] * M[r * rank + j];
            N[i * rank + j] = N[j * rank + i] = sum;
        }
        c[i] = 0.0;
        for (int r = 0; r < k; r++)
            c[i] += M[r * rank + i] * b[r];
    }
    if (wants) {
        memcpy(copy, N, sizeof(double) * rank * rank);
        const double lambda = damping(sqrt(fmax(least_eigenvalue(copy, rank, diagonal, off), 0.0)), d);
        for (int i = 0; i < rank; i++)
            N[i * rank + i] += lambda * lambda;
    }
    cholesky(N, rank);
    cholesky_solve(N, rank, c);
}

/* Factor a layer; returns its rank.

   S: shape (k, k), A~ A~^T, destroyed. b: shape (k,). largest: b_max. Out: M (k, rank) with S = M M^T on what is kept,
   B (rank, k) with Q = B A~ orthonormal, and c (rank,), the layer's step dm = Q^T c in rank space. */
int damped_factor(
    double *S, int k, const double *b, double largest, double *M, double *B, double *c, double *scratch)
{
    double *original = scratch, trace = 0.0, length = 0.0, inverse = 0.0;
    double *rest = scratch + k * k;
    int order[MOST_ROWS];
    for (int i = 0; i < k; i++)
        trace += S[i * k + i], length += b[i] * b[i];
    length = sqrt(length);
    const double d = length / largest, tolerance = RANK_TOLERANCE * fmax(sqrt(trace), LEAST_SCALE);
    if (k > MOST_ROWS)
        return factor_by_eigenvectors(S, k, b, d, M, B, c, rest);
    memcpy(original, S, sizeof(double) * k * k);
    const int rank = pivoted_cholesky(S, k, ROUNDING * trace, order);
    /* B: the inverse of the pivots' triangle; 1 / |B| is a lower bound of the least singular value. */
    memset(B, 0, sizeof(double) * rank * k);
    for (int q = 0; q < rank; q++) {
        const double pivot = 1.0 / S[q * k + q];
        for (int p = 0; p < q; p++) {
            double sum = 0.0;
            for (int i = p; i < q; i++)
                sum += S[q * k + i] * B[i * k + order[p]];
            B[q * k + order[p]] = -pivot * sum;
            inverse += B[q * k + order[p]] * B[q * k + order[p]];
        }
        B[q * k + order[q]] = pivot;
        inverse += pivot * pivot;
    }
    const double bound = inverse > 0.0 ? 1.0 / sqrt(inverse) : 0.0;
    if (rank == 0 || bound <= tolerance)
        return factor_by_eigenvectors(original, k, b, d, M, B, c, rest);
    for (int i = 0; i < k; i++)
        for (int q = 0; q < rank; q++)
            M[order[i] * rank + q] = q <= i ? S[i * k + q] : 0.0;
    if (length == 0.0)
        memset(c, 0, sizeof(double) * rank);
    else if (rank == k && bound > d)
        for (int q = 0; q < rank; q++) {
            c[q] = 0.0;
            for (int r = 0; r < k; r++)
                c[q] += B[q * k + r] * b[r];
        }
    else
        damped_solve(M, k, rank, b, d, bound <= d, c, rest);
    return rank;
}
