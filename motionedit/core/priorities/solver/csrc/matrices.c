/* Small matrices, k x k, one a lane: Cholesky's factors, products. Part of solver.c. */

/* A pivot below this share of the trace is rounding: what is left of a row on a rigid part that has enough rows. */
#define ROUNDING 1e-13

/* A = L L^T in the lower triangle, in place; A is k x k, positive definite. The diagonal comes out inverted. */
static void cholesky(V *A, int k)
{
    for (int j = 0; j < k; j++) {
        const V pivot = A[j * k + j] - dot_in_order(A + j * k, A + j * k, j);
        A[j * k + j] = 1.0 / root_of(larger(pivot, all(DBL_MIN)));
        for (int i = j + 1; i < k; i++)
            A[i * k + j] = (A[i * k + j] - dot_in_order(A + i * k, A + j * k, j)) * A[j * k + j];
    }
}

/* x <- (L L^T)^-1 x */
static void cholesky_solve(const V *L, int k, V *x)
{
    for (int i = 0; i < k; i++)
        x[i] = (x[i] - dot_in_order(L + i * k, x, i)) * L[i * k + i];
    for (int i = k - 1; i >= 0; i--) {
        x[i] *= L[i * k + i];
        for (int p = 0; p < i; p++)
            x[p] -= L[i * k + p] * x[i];
    }
}

/* As cholesky, of what is positive semidefinite: a pivot that is rounding comes out as 0. Returns how many are none. */
static V cholesky_of_rank(V *A, int k)
{
    V trace = all(0.0), rank = trace;
    for (int j = 0; j < k; j++)
        trace += A[j * k + j];
    for (int j = 0; j < k; j++) {
        const V pivot = A[j * k + j] - dot_in_order(A + j * k, A + j * k, j);
        const Mask kept = less(ROUNDING * trace, pivot);
        A[j * k + j] = only(kept, 1.0 / root_of(choose(kept, pivot, all(1.0))));
        rank += only(kept, all(1.0));
        for (int i = j + 1; i < k; i++)
            A[i * k + j] = (A[i * k + j] - dot_in_order(A + i * k, A + j * k, j)) * A[j * k + j];
    }
    return rank;
}

static int is_nothing(const V *row, int k)
{
    return !any(~is_zero(dot_product(row, row, k)));
}

/* tr(A B^T), k x k */
static V trace_of(const V *A, const V *B, int k)
{
    return dot_product(A, B, k * k);
}

/* out = A v, and out = A^T v; k x k */
static void matrix_times(const V *A, const V *v, int k, V *out)
{
    for (int i = 0; i < k; i++)
        out[i] = dot_product(A + i * k, v, k);
}

static void transposed_times(const V *A, const V *v, int k, V *out)
{
    for (int i = 0; i < k; i++)
        out[i] = all(0.0);
    for (int i = 0; i < k; i++)
        add_multiple(out, v[i], A + i * k, k);
}
