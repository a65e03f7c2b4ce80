/* The pass down the layers among the rows of J: layers.py's `descend`, in rank space. Part of solver.c. */

/* Numbers of a layer's rows less what the layers above account for: rows - M_l q_above. */
static void less_above(const Batch *batch, const Layer *layer, const V *rows, const V *above, V *rest)
{
    const int64_t R = batch->problem->of.rows;
    for (int r = 0; r < layer->rows; r++)
        rest[r] = rows[r] - dot_product(batch->M + (layer->first + r) * R, above, layer->first);
}

/* b = clamped e - A dm, dm being what the layers above and the hinges on their limits do: these turn by `fixed`, (R,). */
static void remaining_error(const Batch *batch, const Layer *layer, const V *fixed, V largest, V *b)
{
    const V *e = batch->errors + layer->first;
    const V factor = largest / larger(root_of(dot_product(e, e, layer->rows)), largest);
    for (int r = 0; r < layer->rows; r++)
        b[r] = factor * e[r] - fixed[layer->first + r];
    less_above(batch, layer, b, batch->c, b);
}

/* G without the hinges that are on their limits: a rank-one part less for each. */
static void free_gram(Batch *batch)
{
    const int64_t R = batch->problem->of.rows;
    batch->G_free = batch->G;
    for (int64_t h = 0; h < batch->problem->of.hinges; h++) {
        if (!any(~batch->hinge_free[h]))
            continue;
        if (batch->G_free == batch->G)
            batch->G_free = memcpy(batch->G_frozen, batch->G, sizeof *batch->G * R * R);
        add_hinge(batch, h, only(~batch->hinge_free[h], all(-1.0)), batch->G_frozen);
    }
}

/* One pass: c, the steps of all layers in rank space, and for each layer its rank, B and columns of M. */
static void descend(Batch *batch)
{
    const int64_t R = batch->problem->of.rows;
    const double clamp = batch->problem->constants.largest_error;
    V *fixed = batch->scratch_rows, *b = fixed + R;
    free_gram(batch);
    for (int64_t r = 0; r < R; r++)
        fixed[r] = all(0.0);
    for (int64_t h = 0; h < batch->problem->of.hinges; h++)
        if (any(~batch->hinge_free[h]))
            add_hinge_row(batch, h, batch->hinge_fixed[h], fixed);
    for (int l = 0; l < batch->problem->of.layers; l++) {
        Layer *layer = batch->layers + l;
        const V largest = l == 0 ? all(clamp) : clamp * batch->anneal;
        remaining_error(batch, layer, fixed, largest, b);
        factor_layer(batch, layer, b, largest, batch->c + layer->first);
    }
}

/* Q v from J v; shapes (R,). */
static void into_rank_space(const Batch *batch, const V *Jv, V *Qv)
{
    V *rest = batch->scratch_rows;
    for (int l = 0; l < batch->problem->of.layers; l++) {
        const Layer *layer = batch->layers + l;
        const int k = layer->rows;
        less_above(batch, layer, Jv + layer->first, Qv, rest);
        for (int q = 0; q < k; q++)
            Qv[layer->first + q] = dot_product(layer->B + q * k, rest, layer->full ? k : q + 1);
    }
}

/* y with J^T y = Q^T q; shapes (R,). q is used up. */
static void out_of_rank_space(const Batch *batch, V *q, V *y)
{
    const int64_t R = batch->problem->of.rows;
    for (int l = (int)batch->problem->of.layers - 1; l >= 0; l--) {
        const Layer *layer = batch->layers + l;
        const int k = layer->rows;
        V *own = y + layer->first;
        for (int r = 0; r < k; r++)
            own[r] = all(0.0);
        for (int p = 0; p < k; p++)
            for (int r = 0; r < (layer->full ? k : p + 1); r++)
                own[r] += q[layer->first + p] * layer->B[p * k + r];
        for (int r = 0; r < k; r++) {
            const V *row = batch->M + (layer->first + r) * R;
            for (int p = 0; p < layer->first; p++)
                q[p] -= own[r] * row[p];
        }
    }
}
