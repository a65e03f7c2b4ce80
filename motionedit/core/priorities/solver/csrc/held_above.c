/* The rows above joints that are held, factored in the unknowns that are left; and Pi, what gets no direction there. Part
   of solver.c. */

/* A lane's numbers where the rank of the rows above is in doubt: u, s and the rows that had a direction, r of them. */
typedef struct {
    int r, lane;
    int *row;              /* shape (r,) */
    double *S, *V, *basis; /* shapes (r, r), (r, r), (k, k): orthonormal rows, from the first on */
} Doubt;

/* B and the columns of M of the i-th singular triple, in the place of the row that had a direction. */
static void put_triple(Batch *batch, Layer *above, const Doubt *doubt, int i, double s, const double *u)
{
    const int k = above->rows, R = batch->rows, row = doubt->row[i], lane = doubt->lane;
    for (int r = 0; r < k; r++) {
        LANE(batch->M[r * R + row], lane) = s * u[r];
        LANE(above->B[row * k + r], lane) = s > 0.0 ? u[r] / s : 0.0;
    }
    for (int below = k; below < R; below++) {
        double sum = 0.0;
        for (int r = 0; r < k; r++)
            sum += LANE(above->B[row * k + r], lane) * LANE(batch->G_free[below * R + r], lane);
        LANE(batch->M[below * R + row], lane) = sum;
    }
}

/* What the unit vectors have inside a basis, shape (k,), with one more row of it. */
static void add_inside(const double *row, int k, double *inside)
{
    for (int j = 0; j < k; j++)
        inside[j] += row[j] * row[j];
}

/* One more row of an orthonormal basis of `count`: the unit vector that lies furthest off, made square to the others. */
static void complete(double *basis, int count, int k, double *inside)
{
    int furthest = 0;
    double size = 0.0, *next = basis + count * k;
    for (int j = 1; j < k; j++)
        furthest = inside[j] < inside[furthest] ? j : furthest;
    for (int j = 0; j < k; j++)
        next[j] = j == furthest ? 1.0 : 0.0;
    for (int p = 0; p < count; p++) {
        const double along = basis[p * k + furthest];
        for (int j = 0; j < k && along != 0.0; j++)
            next[j] -= along * basis[p * k + j];
    }
    for (int j = 0; j < k; j++)
        size += next[j] * next[j];
    for (int j = 0; j < k; j++)
        next[j] /= sqrt(size);
    add_inside(next, k, inside);
}

/* Give each row without a direction one of those that are square to the `kept` rows of the basis. */
static void put_rest(const Layer *above, const Hold *hold, const Doubt *doubt, int kept)
{
    const int k = hold->k, lane = doubt->lane;
    double *inside = doubt->S; /* not wanted any more: k of 2 k^2 */
    memset(inside, 0, sizeof *inside * k);
    for (int i = 0; i < kept; i++)
        add_inside(doubt->basis + i * k, k, inside);
    for (int i = 0, next = kept; i < k; i++) {
        double size = 0.0;
        for (int q = 0; q < k; q++)
            size += fabs(LANE(above->B[i * k + q], lane));
        if (size > 0.0)
            continue;
        complete(doubt->basis, next, k, inside);
        for (int q = 0; q < k; q++)
            LANE(hold->Pi[i * k + q], lane) = doubt->basis[next * k + q];
        next++;
    }
}

/* The singular triples of what Cholesky has left, a few columns: those that are kept, and Pi square to them. */
static void factor_in_doubt(Batch *batch, Layer *above, Hold *hold, Doubt *doubt)
{
    const int k = hold->k, R = batch->rows, r = doubt->r, lane = doubt->lane;
    const Constants *constants = &batch->problem->constants;
    double most = 0.0, *u = doubt->basis;
    double *M = doubt->basis + k * k;
    for (int q = 0; q < k; q++)
        for (int i = 0; i < r; i++)
            M[q * r + i] = q < doubt->row[i] ? 0.0 : LANE(batch->M[q * R + doubt->row[i]], lane);
    for (int i = 0; i < r * r; i++)
        doubt->S[i] = 0.0;
    for (int q = 0; q < k; q++)
        for (int i = 0; i < r; i++)
            for (int j = 0; j < r; j++)
                doubt->S[i * r + j] += M[q * r + i] * M[q * r + j];
    jacobi(doubt->S, r, doubt->V);
    for (int i = 0; i < r; i++)
        most = fmax(most, sqrt(fmax(doubt->S[i * r + i], 0.0)));
    const double tolerance = constants->rank_tolerance * fmax(most, constants->least_scale);
    int kept = 0;
    for (int i = 0; i < r; i++) {
        const double s = sqrt(fmax(doubt->S[i * r + i], 0.0));
        for (int q = 0; q < k; q++) {
            u[q] = 0.0;
            for (int j = 0; j < r; j++)
                u[q] += M[q * r + j] * doubt->V[j * r + i] / fmax(s, DBL_MIN);
            LANE(hold->Pi[doubt->row[i] * k + q], lane) = 0.0;
        }
        put_triple(batch, above, doubt, i, s > tolerance ? s : 0.0, u);
        if (s > tolerance)
            kept++, u += k;
    }
    above->full = 1;
    LANE(above->rank, lane) = kept;
    put_rest(above, hold, doubt, kept);
}

/* Factor the rows above in the unknowns that are left; Pi, the rows that get no direction there. */
static void factor_above(Batch *batch, Layer *above, Hold *hold)
{
    const int k = hold->k, R = batch->rows;
    const Constants *constants = &batch->problem->constants;
    Mask *dependent = batch->dependent;
    const V trace = remaining_trace(batch, above), inverse = eliminate(batch, above, trace, dependent);
    const V bound = 1.0 / root_of(choose(less(all(0.0), inverse), inverse, all(1.0)));
    const V least = constants->rank_tolerance * larger(root_of(trace), all(constants->least_scale));
    const Mask doubtful = less(all(0.0), inverse) & ~less(least, bound);
    for (int i = 0; i < k; i++) {
        V *row = hold->Pi + i * k;
        for (int r = 0; r < k; r++)
            row[r] = only(dependent[i], all(r == i ? 1.0 : 0.0));
        for (int q = 0; q < i; q++)
            add_multiple(row, -only(dependent[i], batch->M[i * R + q]), above->B + q * k, q + 1);
    }
    for (int lane = 0; lane < LANES && any(doubtful); lane++) {
        if (!MASK_LANE(doubtful, lane))
            continue;
        double *plain = (double *)hold->Y; /* 4 k^2 of 5 k^2 */
        Doubt doubt = {.lane = lane, .row = batch->dependent_row, .basis = plain};
        for (int i = 0; i < k; i++)
            if (!MASK_LANE(dependent[i], lane))
                doubt.row[doubt.r++] = i;
        doubt.S = plain + 2 * k * k, doubt.V = doubt.S + doubt.r * doubt.r;
        factor_in_doubt(batch, above, hold, &doubt);
    }
}
