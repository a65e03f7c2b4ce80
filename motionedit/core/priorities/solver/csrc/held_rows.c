/* The rows around joints that are held, X, formed: without hinges on their limits, orthonormal above, and without the
   unknowns that are held below. Part of solver.c. */

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
