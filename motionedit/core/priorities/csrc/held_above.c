/* Layers that hold joints: the rows of a posture are its own unknowns, and leave the system with them. Part of solver.c.

   With the orthonormal rows Q of the layers above, the unknowns U that are held, of scale D, and F, the others, the step
   of such a layer is

       w_U least in |D w_U - b|^2 + lambda^2 |w|^2 with Q w = 0, and w_F = -Q_F^+ Q_U w_U, the least that makes up for it

   Q_F = M B^-1 is factored as a layer's rows are: B Q_F is orthonormal. Rows of Q that get a direction there cost |B Q_U
   w_U|^2, those that get none, Pi Q, may not be moved at all. L has both, sqrt(lambda^2) B and Pi, and with K = D^2 + lambda^2

       w_U = K^-1 (D b - Q_U^T L^T v),    (1 or 0 + L Q_U K^-1 Q_U^T L^T) v = L Q_U K^-1 D b

   as many unknowns as there are rows above. The layers below see F alone, and those above there as one layer. Its rows are
   formed: X. */

/* What a layer is held by: k rows above, m unknowns in U. */
typedef struct {
    int k, m, n;
    int *unknown;                /* shape (m,) */
    int *some;                   /* shape (k,): rows that are something */
    V *XU, *W;                   /* shape (k, m): the rows' part in U; the same, weighted */
    V *Y, *Y4, *Pi, *L, *T, *K;  /* shape (k, k) */
    V *squares, *g, *w, *weight; /* shape (m,): D^2, 0 where it is a hinge on its limit; D b; w_U; K^-1 */
    V *v, *t, *p;                /* shape (k,) */
    V *b;                        /* shape (held, 3) */
} Hold;

static size_t held_scratch(int R, int n, int held)
{
    return (size_t)(2 * R * n + 6 * R * R + 4 * n + 3 * R + 3 * held);
}

static void out_of_rank_space(const Batch *batch, V *q, V *y);
static void own_rank_space(const Layer *layer, const V *rest, V *Qv);

static Hold work_of(const Batch *batch, const Layer *layer)
{
    const int k = layer->first, n = batch->unknowns;
    V *at = batch->held_scratch;
    Hold hold = {.k = k, .n = n, .unknown = batch->held_unknown, .some = batch->dependent_row};
    hold.XU = at, at += k * n, hold.W = at, at += k * n;
    hold.Pi = at, at += k * k, hold.Y = at, at += k * k, hold.Y4 = at, at += k * k;
    hold.L = at, at += k * k, hold.T = at, at += k * k, hold.K = at, at += k * k;
    hold.squares = at, at += n, hold.g = at, at += n, hold.w = at, at += n, hold.weight = at, at += n;
    hold.v = at, at += k, hold.t = at, at += k, hold.p = at, at += k, hold.b = at;
    return hold;
}

/* J itself, shape (R, n). */
static void form_rows(Batch *batch)
{
    const Problem *problem = batch->problem;
    const int n = batch->unknowns;
    for (int i = 0; i < batch->rows * n; i++)
        batch->J[i] = all(0.0);
    for (int64_t t = 0; t < problem->of.tasks; t++) {
        const Pull *pull = batch->pulls + t;
        for (int p = 0; p < pull->parts; p++) {
            const Part *part = pull->part + p;
            for (int r = 0; r < pull->rows; r++) {
                V *row = batch->J + (pull->first_row + r) * n;
                for (int i = 0; i < part->count; i++) {
                    const int column = part->columns[i], h = batch->column_hinge[column];
                    V turn[3], *to = row + batch->column_unknown[column];
                    cross(part->levers + 3 * i, part->force[r], turn);
                    add_scaled(turn, all(problem->mobility[column]), part->torque[r]);
                    if (h < 0)
                        add(to, turn);
                    for (int j = 0; j < batch->column_hinges[column]; j++)
                        to[j] += dot(batch->hinge_axes + 3 * (h + j), turn);
                }
                if (part->root)
                    add_scaled(row + n - 3, all(problem->mobility[problem->of.columns]), part->force[r]);
            }
        }
    }
}

/* X = J without hinges on their limits and rows that take no part. */
static void take_rows(Batch *batch)
{
    const int n = batch->unknowns;
    memcpy(batch->X, batch->J, sizeof *batch->X * batch->rows * n);
    for (int64_t h = 0; h < batch->problem->of.hinges; h++)
        for (int r = 0; r < batch->rows && any(~batch->hinge_free[h]); r++) {
            V *turn = hinge_turn(batch, batch->X + r * n, h);
            *turn = only(batch->hinge_free[h], *turn);
        }
    for (int i = 0; i < batch->sided; i++)
        for (int j = 0; j < n; j++) {
            V *of = batch->X + batch->sided_row[i] * n + j;
            *of = only(batch->active[batch->sided_row[i]], *of);
        }
    batch->is_explicit = 1;
}

/* The rows of rank space times v, and their transpose times y, which is added: J where it is whole, else X. */
static void chain_times(const Batch *batch, const V *v, V *out)
{
    if (!batch->is_explicit) {
        rows_times(batch, v, out);
        return;
    }
    for (int r = 0; r < batch->rows; r++)
        out[r] = dot_product(batch->X + r * batch->unknowns, v, batch->unknowns);
}

static void add_chain_transposed(const Batch *batch, const V *y, V *out)
{
    if (!batch->is_explicit) {
        add_rows_transposed(batch, y, out);
        return;
    }
    for (int r = 0; r < batch->rows; r++)
        for (int i = 0; i < batch->unknowns; i++)
            out[i] += y[r] * batch->X[r * batch->unknowns + i];
}

/* Q of the chain in place of its rows of X: Q_l = B_l (X_l - M_l Q_above). */
static void make_orthonormal(Batch *batch)
{
    const int n = batch->unknowns;
    V *X = batch->X, *rest = batch->held_scratch;
    for (int l = 0; l < batch->chain_count; l++) {
        const Layer *layer = batch->chain[l];
        const int k = layer->rows;
        V *own = X + layer->first * n;
        for (int r = 0; r < k; r++)
            for (int p = 0; p < layer->first; p++)
                add_multiple(own + r * n, -batch->M[(layer->first + r) * batch->rows + p], X + p * n, n);
        memcpy(rest, own, sizeof *own * k * n);
        for (int q = 0; q < k; q++) {
            for (int i = 0; i < n; i++)
                own[q * n + i] = all(0.0);
            for (int r = 0; r < (layer->full ? k : q + 1); r++)
                add_multiple(own + q * n, layer->B[q * k + r], rest + r * n, n);
        }
    }
}

/* Put the steps of the chain into the base. */
static void settle(Batch *batch, int k)
{
    V *q = batch->held_scratch, *y = q + batch->rows;
    memcpy(q, batch->c, sizeof *q * k);
    for (int r = 0; r < batch->rows; r++)
        y[r] = all(0.0);
    out_of_rank_space(batch, q, y);
    add_chain_transposed(batch, y, batch->base);
    for (int r = 0; r < k; r++)
        batch->c[r] = all(0.0);
}

/* The unknowns that are held, D^2 and D b; returns |b|, of all rows: b = clamped e - D w. */
static V held_errors(const Batch *batch, const Layer *layer, V largest, Hold *hold)
{
    const int errors = 3 * layer->held;
    const V *e = batch->held_errors + layer->joints[0].error;
    const V factor = largest / larger(root_of(dot_product(e, e, errors)), largest);
    for (int j = 0; j < layer->held; j++) {
        const Held *joint = layer->joints + j;
        const V *base = batch->base + joint->unknown, *axis = batch->hinge_axes + 3 * joint->hinge;
        const Mask is_free = joint->hinge < 0 ? everywhere() : batch->hinge_free[joint->hinge];
        V *b = hold->b + 3 * j;
        for (int a = 0; a < 3; a++) {
            const V turn = joint->hinge < 0 ? base[a] : axis[a] * (base[0] + batch->hinge_fixed[joint->hinge]);
            b[a] = factor * e[3 * j + a] - joint->scale * turn;
        }
        for (int a = 0; a < joint->count && !joint->again; a++) {
            hold->unknown[hold->m] = joint->unknown + a;
            hold->squares[hold->m] = only(is_free, all(joint->scale * joint->scale));
            hold->g[hold->m++] = only(is_free, joint->scale * (joint->hinge < 0 ? b[a] : dot(axis, b)));
        }
    }
    return root_of(dot_product(hold->b, hold->b, errors));
}

/* Take the unknowns that are held out of X; XU is what it had of them in the rows above. */
static void part_rows(Batch *batch, Hold *hold)
{
    for (int r = 0; r < batch->rows; r++) {
        V *row = batch->X + r * hold->n;
        for (int i = 0; i < hold->m; i++) {
            if (r < hold->k)
                hold->XU[r * hold->m + i] = row[hold->unknown[i]];
            row[hold->unknown[i]] = all(0.0);
        }
    }
}

/* X X^T of the unknowns that are left below layer l, lower triangle. */
static void gram_below(Batch *batch, int l)
{
    const int R = batch->rows, n = batch->unknowns;
    for (int i = 0; i < R * R; i++)
        batch->G_held[i] = all(0.0);
    for (int i = 0; i < n; i++) {
        if (batch->holder[i] >= 0 && batch->holder[i] <= l)
            continue;
        for (int r = 0; r < R; r++)
            for (int s = 0; s <= r; s++)
                batch->G_held[r * R + s] += batch->X[r * n + i] * batch->X[s * n + i];
    }
    batch->G_free = batch->G_held;
}

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
