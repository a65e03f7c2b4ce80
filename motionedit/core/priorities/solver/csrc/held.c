/* Layers that hold joints: the rows of a posture are its own unknowns, and leave the system with them. Part of solver.c.

   With the orthonormal rows Q of the layers above, the unknowns U that are held, of scale D, and F, the others, the step
   of such a layer is

       w_U least in |D w_U - b|^2 + lambda^2 |w|^2 with Q w = 0, and w_F = -Q_F^+ Q_U w_U, the least that makes up for it

   Q_F = M B^-1 is factored as a layer's rows are: B Q_F is orthonormal. Rows of Q that get a direction there cost |B Q_U
   w_U|^2, those that get none, Pi Q, may not be moved at all. L has both, sqrt(lambda^2) B and Pi, and with K = D^2 + lambda^2

       w_U = K^-1 (D b - Q_U^T L^T v),    (1 or 0 + L Q_U K^-1 Q_U^T L^T) v = L Q_U K^-1 D b

   as many unknowns as there are rows above. The layers below see F alone, and those above there as one layer. Its rows are
   formed: X. */

/* Y = XU diag(weight) XU^T, whole. */
static void weighted_gram(const Hold *hold, const V *weight, V *Y)
{
    const int k = hold->k, m = hold->m;
    for (int r = 0; r < k; r++) {
        for (int i = 0; i < m; i++)
            hold->W[i] = weight[i] * hold->XU[r * m + i];
        for (int s = 0; s <= r; s++)
            Y[r * k + s] = Y[s * k + r] = dot_product(hold->W, hold->XU + s * m, m);
    }
}

/* out = A B^T, k x k: many rows are nothing in any lane. */
static void times_rows(const Hold *hold, const V *A, const V *B, V *out)
{
    const int k = hold->k;
    int *some = hold->some, count = 0;
    for (int i = 0; i < k * k; i++)
        out[i] = all(0.0);
    for (int j = 0; j < k; j++)
        if (!is_nothing(B + j * k, k))
            some[count++] = j;
    for (int i = 0; i < k; i++) {
        const int many = is_nothing(A + i * k, k) ? 0 : count;
        for (int j = 0; j < many; j++)
            out[i * k + some[j]] = dot_product(A + i * k, B + some[j] * k, k);
    }
}

/* |A~^+|^2 without damping, from weight = D^-2 and Y: of w_U and w_F,

   tr(D^-2 P) + tr(B Q_U D^-1 P D^-1 Q_U^T B^T),    P = 1 - D^-1 Q_U^T Pi^T (Pi Y Pi^T)^+ Pi Q_U D^-1 */
static V inverse_of_held(const Layer *above, Hold *hold, V whole)
{
    const int k = hold->k;
    for (int i = 0; i < hold->m; i++)
        hold->w[i] = hold->weight[i] * hold->weight[i];
    weighted_gram(hold, hold->w, hold->Y4);
    times_rows(hold, hold->Pi, hold->Y, hold->T);
    times_rows(hold, hold->T, hold->Pi, hold->K);
    times_rows(hold, hold->T, above->B, hold->L); /* Pi Y B^T */
    cholesky_of_rank(hold->K, k);
    times_rows(hold, hold->Pi, hold->Y4, hold->T);
    times_rows(hold, hold->T, hold->Pi, hold->Y4); /* Pi Y4 Pi^T, symmetric */
    for (int j = 0; j < k; j++) {
        for (int i = 0; i < k; i++)
            hold->v[i] = hold->Y4[j * k + i], hold->t[i] = hold->p[i] = hold->L[i * k + j];
        if (!is_nothing(hold->v, k)) {
            cholesky_solve(hold->K, k, hold->v);
            whole -= hold->v[j];
        }
        if (!is_nothing(hold->t, k)) {
            cholesky_solve(hold->K, k, hold->t);
            whole -= dot_product(hold->p, hold->t, k);
        }
    }
    return whole;
}

/* Damping lambda of the layer, d being |b| over b_max as in factor_layer. */
static V held_damping(const Layer *above, Hold *hold, V d)
{
    const int k = hold->k;
    V whole = all(0.0);
    for (int i = 0; i < hold->m; i++) {
        const Mask none = is_zero(hold->squares[i]);
        hold->weight[i] = only(~none, 1.0 / choose(none, all(1.0), hold->squares[i]));
        whole += hold->weight[i];
    }
    weighted_gram(hold, hold->weight, hold->Y);
    times_rows(hold, above->B, hold->Y, hold->T);
    whole += trace_of(hold->T, above->B, k);
    const Mask near = ~less(d * d * whole, all(1.0));
    if (!any(near))
        return all(0.0);
    const V inverse = inverse_of_held(above, hold, whole);
    const Mask some = less(all(0.0), inverse);
    return only(near, damping(only(some, 1.0 / root_of(choose(some, inverse, all(1.0)))), d));
}

/* out = XU v; out = XU^T v is subtracted. */
static void held_times(const Hold *hold, const V *v, V *out)
{
    for (int r = 0; r < hold->k; r++)
        out[r] = dot_product(hold->XU + r * hold->m, v, hold->m);
}

static void subtract_held_transposed(const Hold *hold, const V *v, V *out)
{
    for (int r = 0; r < hold->k; r++)
        add_multiple(out, -v[r], hold->XU + r * hold->m, hold->m);
}

/* D b + soft times what w_U has of the pull z, itself and by w_F. */
static void pull_held(const Batch *batch, const Layer *layer, Hold *hold)
{
    const int k = hold->k;
    for (int r = 0; r < k; r++)
        hold->v[r] = layer->soft * dot_product(batch->X + r * hold->n, batch->z, hold->n);
    matrix_times(layer->above->B, hold->v, k, hold->t);
    transposed_times(layer->above->B, hold->t, k, hold->v);
    subtract_held_transposed(hold, hold->v, hold->g);
    for (int i = 0; i < hold->m; i++)
        hold->g[i] += only(~is_zero(hold->squares[i]), layer->soft * batch->z[hold->unknown[i]]);
}

/* w_U and w_F into the base, given lambda^2. */
static void step_held(Batch *batch, Layer *layer, Hold *hold, V square)
{
    const int k = hold->k, m = hold->m;
    const V *B = layer->above->B, scale = root_of(square);
    const int damps = any(less(all(0.0), square)); /* else K^-1 and Y are those of `held_damping` */
    V unknowns = all(0.0);
    for (int i = 0; i < m; i++) {
        const Mask none = is_zero(hold->squares[i]);
        if (damps)
            hold->weight[i] = only(~none, 1.0 / choose(none, all(1.0), hold->squares[i] + square));
        hold->w[i] = hold->weight[i] * hold->g[i];
        unknowns += only(~none, all(1.0));
    }
    if (damps)
        weighted_gram(hold, hold->weight, hold->Y);
    for (int i = 0; i < k * k; i++)
        hold->L[i] = scale * B[i] + hold->Pi[i];
    times_rows(hold, hold->L, hold->Y, hold->T);
    times_rows(hold, hold->T, hold->L, hold->K);
    for (int i = 0; i < k; i++) { /* the rows that have a direction */
        const Mask kept = less(all(0.0), dot_product(B + i * k, B + i * k, k));
        hold->K[i * k + i] += only(kept, all(1.0));
    }
    held_times(hold, hold->w, hold->p);
    matrix_times(hold->L, hold->p, k, hold->v);
    const V kept = cholesky_of_rank(hold->K, k);
    cholesky_solve(hold->K, k, hold->v);
    layer->rank = unknowns - (kept - layer->above->rank);
    transposed_times(hold->L, hold->v, k, hold->t);
    subtract_held_transposed(hold, hold->t, hold->g);
    for (int i = 0; i < m; i++) {
        hold->w[i] = hold->weight[i] * hold->g[i];
        batch->base[hold->unknown[i]] += hold->w[i];
    }
    held_times(hold, hold->w, hold->p);
    matrix_times(B, hold->p, k, hold->v);
    transposed_times(B, hold->v, k, hold->t);
    for (int r = 0; r < k; r++)
        add_multiple(batch->base, -hold->t[r], batch->X + r * hold->n, hold->n);
}

/* Hold the joints of layer l, those above it being factored; those below it see the unknowns that are left. */
static void hold_joints(Batch *batch, int l, V largest)
{
    Layer *layer = batch->layers + l, *above = layer->above;
    settle(batch, layer->first);
    if (!batch->is_explicit)
        take_rows(batch);
    make_orthonormal(batch);
    Hold hold = work_of(batch, layer);
    const V size = held_errors(batch, layer, largest, &hold);
    part_rows(batch, &hold);
    gram_below(batch, l);
    above->soft = all(0.0);
    factor_above(batch, above, &hold);
    const V limb = 2.0 * batch->problem->constants.limb * size;
    const V lambda = held_damping(above, &hold, larger(size / largest, only(batch->steady, root_of(limb))));
    if (any(less(all(0.0), layer->soft)))
        pull_held(batch, layer, &hold);
    step_held(batch, layer, &hold, larger(lambda * lambda, layer->soft));
    batch->chain[0] = above, batch->chain_count = 1;
    chain_times(batch, batch->z, batch->held_pull);
    own_rank_space(above, batch->held_pull, batch->Qz);
}
