/* A layer's rows of M, B and its step from G = J J^T: what _damped_step of layers.py gets from eigenvectors. Part of
   solver.c. */

/* What factoring a layer of k rows takes at most: a damped step, W and N, y and t. */
static size_t factor_scratch(int k)
{
    return (size_t)(k + k * k + k * k + k + k);
}

/* lambda by s = 1 / |A~^+|_F, which the smallest kept singular value exceeds, and the length d of b over b_max. */
static V damping(V s, V d)
{
    const V near = root_of(larger(s * (d - s), all(0.0)));
    return choose(less(0.5 * d, s), only(~less(d, s), near), 0.5 * d);
}

/* The trace of a layer's S = A~ A~^T. */
static V remaining_trace(const Batch *batch, const Layer *layer)
{
    const int64_t R = batch->rows;
    V trace = all(0.0);
    for (int r = layer->first; r < layer->first + layer->rows; r++) {
        const V *row = batch->M + r * R;
        trace += batch->G_free[r * R + r] - dot_product(row, row, layer->first);
    }
    return larger(trace, all(0.0));
}

/* Cholesky of G, column by column of M, down to the last row of all. A row that is a combination of those before gets
   no direction: a column of zeros; one that takes no part in any lane is passed over.

   Out: columns of M; B, lower triangular, the inverse of the layer's triangle: Q = B A~ is orthonormal; the layer's rank;
   dependent, shape (k,): which rows got none. Returns |B|^2. */
static V eliminate(Batch *batch, Layer *layer, V trace, Mask *dependent)
{
    const int k = layer->rows, first = layer->first, R = (int)batch->rows;
    const V *G = batch->G_free;
    V *M = batch->M, inverse = all(0.0);
    layer->rank = all(0.0), layer->full = 0;
    for (int i = 0; i < k; i++) {
        const int c = first + i;
        V *row = M + c * R, *own = layer->B + i * k;
        for (int q = 0; q < k; q++)
            own[q] = all(0.0);
        if (!any(batch->active[c])) {
            dependent[i] = everywhere();
            for (int r = c; r < R; r++)
                M[r * R + c] = all(0.0);
            continue;
        }
        const V pivot = G[c * R + c] - dot_product(row, row, c);
        dependent[i] = ~less(ROUNDING * trace, pivot);
        const V scale = only(~dependent[i], 1.0 / root_of(choose(dependent[i], all(1.0), pivot)));
        row[c] = pivot * scale;
        for (int r = c + 1; r < R; r++)
            M[r * R + c] = (G[r * R + c] - dot_product(M + r * R, row, c)) * scale;
        layer->rank += only(~dependent[i], all(1.0));
        own[i] = scale;
        for (int p = 0; p < i; p++) {
            const V factor = -scale * row[first + p];
            for (int q = 0; q <= p; q++)
                own[q] += factor * layer->B[p * k + q];
        }
        inverse += dot_product(own, own, i + 1);
    }
    return inverse;
}

/* Where the rank is in doubt: the singular triples one by one, as the reference has them. For one lane: a column of M is
   s u, a row of B u / s; scratch: 2 k^2 plain numbers. */
static void factor_by_eigenvectors(
    Batch *batch, Layer *layer, int lane, const V *b, const V *pull, V d, V *c, double *S)
{
    const int k = layer->rows, first = layer->first, R = (int)batch->rows;
    const V *G = batch->G_free;
    V *M = batch->M;
    double *U = S + k * k, most = 0.0, inverse = 0.0;
    for (int r = 0; r < k; r++)
        for (int s = 0; s <= r; s++) {
            const V *mine = M + (first + r) * R, *other = M + (first + s) * R;
            double sum = LANE(G[(first + r) * R + first + s], lane);
            for (int p = 0; p < first; p++)
                sum -= LANE(mine[p], lane) * LANE(other[p], lane);
            S[r * k + s] = S[s * k + r] = sum;
        }
    jacobi(S, k, U);
    for (int i = 0; i < k; i++) {
        S[i] = sqrt(fmax(S[i * k + i], 0.0)); /* from here on the singular values, in the first row */
        most = fmax(most, S[i]);
    }
    const Constants *constants = &batch->problem->constants;
    const double tolerance = constants->rank_tolerance * fmax(most, constants->least_scale);
    for (int i = 0; i < k; i++)
        inverse += S[i] > tolerance ? 1.0 / (S[i] * S[i]) : 0.0;
    const V damped = damping(all(inverse > 0.0 ? 1.0 / sqrt(inverse) : INFINITY), d);
    const double soft = LANE(layer->soft, lane), square = fmax(LANE(damped, lane) * LANE(damped, lane), soft);
    layer->full = 1;
    LANE(layer->rank, lane) = 0.0;
    for (int i = 0; i < k; i++) {
        const double s = S[i];
        const int kept = s > tolerance;
        double towards = 0.0, back = 0.0;
        for (int r = 0; r < k; r++) {
            towards += U[r * k + i] * LANE(b[r], lane), back += U[r * k + i] * LANE(pull[r], lane);
            LANE(M[(first + r) * R + first + i], lane) = kept ? s * U[r * k + i] : 0.0;
            LANE(layer->B[i * k + r], lane) = kept ? U[r * k + i] / s : 0.0;
        }
        LANE(c[i], lane) = kept ? (towards * s + soft * back / s) / (s * s + square) : 0.0;
        LANE(layer->rank, lane) += kept;
    }
    for (int below = first + k; below < R; below++) { /* J_below Q */
        for (int i = 0; i < k; i++)
            LANE(M[below * R + first + i], lane) = 0.0;
        for (int r = 0; r < k; r++) {
            double rest = LANE(G[below * R + first + r], lane);
            for (int p = 0; p < first; p++)
                rest -= LANE(M[below * R + p], lane) * LANE(M[(first + r) * R + p], lane);
            for (int i = 0; i < k; i++)
                LANE(M[below * R + first + i], lane) += LANE(layer->B[i * k + r], lane) * rest;
        }
    }
}

/* Rows that got no direction, in some lane, as W times those that did: W, shape (rest, k), and I + W W^T = N N^T. In lanes
   where such a row has its own direction W is 0. */
typedef struct {
    int rest;
    const int *row;
    V *W, *N, *scratch;
} Dependent;

static Dependent dependent_rows(const Batch *batch, const Layer *layer, const Mask *dependent, V *scratch)
{
    const int k = layer->rows, R = (int)batch->rows;
    Dependent found = {.row = batch->dependent_row, .W = scratch};
    for (int r = 0; r < k; r++) {
        if (!any(dependent[r] & batch->active[layer->first + r]))
            continue;
        V *w = found.W + found.rest * k;
        const V *M = batch->M + (layer->first + r) * R + layer->first;
        for (int q = 0; q < k; q++)
            w[q] = all(0.0);
        for (int q = 0; q < r; q++) {
            const V factor = only(dependent[r], M[q]);
            for (int m = 0; m <= q; m++)
                w[m] += factor * layer->B[q * k + m];
        }
        batch->dependent_row[found.rest++] = r;
    }
    const int rest = found.rest;
    found.N = found.W + rest * k, found.scratch = found.N + rest * rest;
    for (int i = 0; i < rest; i++)
        for (int j = 0; j <= i; j++)
            found.N[i * rest + j] = dot_product(found.W + i * k, found.W + j * k, k) + (i == j ? 1.0 : 0.0);
    cholesky(found.N, rest);
    return found;
}

/* |M^+|_F^2 = |B|_F^2 - tr((I + W W^T)^-1 V V^T), V = W B^T: 1 / s^2 of the damping. */
static V squared_inverse(const Dependent *rows, const Layer *layer, V inverse)
{
    const int k = layer->rows, rest = rows->rest;
    V *column = rows->scratch, *solved = column + rest;
    for (int q = 0; q < k && rest > 0; q++) {
        for (int i = 0; i < rest; i++)
            column[i] = solved[i] = dot_product(rows->W + i * k, layer->B + q * k, q + 1);
        cholesky_solve(rows->N, rest, solved);
        inverse -= dot_in_order(column, solved, rest);
    }
    return inverse;
}

/* c = M^+ b without damping: least squares asks the other rows for (I + W^T W)^-1 (b_1 + W^T b_2). */
static void solve_undamped(const Dependent *rows, const Layer *layer, const V *b, V *c)
{
    const int k = layer->rows, rest = rows->rest;
    V *y = rows->scratch, *t = y + k;
    memcpy(y, b, sizeof *y * k);
    for (int i = 0; i < rest; i++)
        for (int q = 0; q < k; q++)
            y[q] += b[rows->row[i]] * rows->W[i * k + q];
    for (int i = 0; i < rest; i++)
        t[i] = dot_product(rows->W + i * k, y, k);
    cholesky_solve(rows->N, rest, t);
    for (int i = 0; i < rest; i++)
        for (int q = 0; q < k; q++)
            y[q] -= t[i] * rows->W[i * k + q];
    for (int q = 0; q < k; q++)
        c[q] = dot_product(layer->B + q * k, y, q + 1);
}

/* c = (M^T M + lambda^2)^-1 (M^T b + soft Q z), Q z being B times what is left of J z, `pull`; a column of zeros comes
   to 0. */
static void solve_damped(const Batch *batch, const Layer *layer, const V *b, const V *pull, V square, V *c, V *N)
{
    const int k = layer->rows, R = (int)batch->rows;
    const V *M = batch->M + layer->first * R + layer->first;
    for (int i = 0; i < k; i++) {
        c[i] = layer->soft * dot_product(layer->B + i * k, pull, i + 1);
        for (int r = i; r < k; r++)
            c[i] += M[r * R + i] * b[r];
        for (int j = 0; j <= i; j++) {
            V sum = all(0.0);
            for (int r = i; r < k; r++)
                sum += M[r * R + i] * M[r * R + j];
            N[i * k + j] = sum;
        }
        N[i * k + i] += square;
        N[i * k + i] = choose(is_zero(N[i * k + i]), all(1.0), N[i * k + i]);
    }
    cholesky(N, k);
    cholesky_solve(N, k, c);
}

/* Factor a layer, those above it being factored.

   b: shape (k,). pull: what the layers above leave of J z, (k,). largest: b_max. Out: the layer's rank, B and columns of M, and c, shape (k,): its step is dm = Q^T c.

   d is |b| / b_max, and in a steady lane at least such that lambda^2 >= |b| limb / 2: see layers.py. */
static void factor_layer(Batch *batch, Layer *layer, const V *b, const V *pull, V largest, V *c)
{
    const int k = layer->rows;
    const Constants *constants = &batch->problem->constants;
    V *damped = batch->algebra, *scratch = damped + k;
    Mask *dependent = batch->dependent;
    const V size = root_of(dot_product(b, b, k)), trace = remaining_trace(batch, layer);
    const V d = larger(size / largest, only(batch->steady, root_of(2.0 * constants->limb * size)));
    const V inverse = eliminate(batch, layer, trace, dependent);
    /* 1 / |B| is a lower bound of the least singular value, the root of the trace an upper one of the largest. */
    const V bound = only(less(all(0.0), inverse), 1.0 / root_of(inverse));
    const Mask doubtful = ~less(constants->rank_tolerance * larger(root_of(trace), all(constants->least_scale)), bound);
    const Dependent rows = dependent_rows(batch, layer, dependent, scratch);
    const Mask near = ~less(d, bound);
    V lambda = all(0.0);
    if (any(near))
        lambda = only(near, damping(1.0 / root_of(squared_inverse(&rows, layer, inverse)), d));
    solve_undamped(&rows, layer, b, c);
    const V square = larger(lambda * lambda, layer->soft);
    const Mask damps = less(all(0.0), square);
    if (any(damps)) {
        solve_damped(batch, layer, b, pull, square, damped, scratch);
        for (int i = 0; i < k; i++)
            c[i] = choose(damps, damped[i], c[i]);
    }
    for (int lane = 0; lane < LANES && any(doubtful); lane++)
        if (MASK_LANE(doubtful, lane))
            factor_by_eigenvectors(batch, layer, lane, b, pull, d, c, (double *)scratch);
}
