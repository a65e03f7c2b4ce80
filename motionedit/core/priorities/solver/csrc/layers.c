/* The pass down the layers among the rows of J: layers.py's `descend`, in rank space. Part of solver.c. */

/* b = clamped e - A dm, dm being what the layers above and the hinges on their limits do: these turn by `fixed`, (R,).
   Rows that take no part have none. */
static void remaining_error(const Batch *batch, const Layer *layer, const V *fixed, V largest, V *b)
{
    const Mask *active = batch->active + layer->first;
    for (int r = 0; r < layer->rows; r++)
        b[r] = only(active[r], batch->errors[layer->first + r]);
    const V factor = largest / larger(root_of(dot_product(b, b, layer->rows)), largest);
    for (int r = 0; r < layer->rows; r++)
        b[r] = only(active[r], factor * b[r] - fixed[layer->first + r]);
    less_above(batch, layer, b, batch->c, b);
}

/* Take the rows out of G that take no part: what is 0 is as if it were not there. */
static void without_inactive_rows(Batch *batch)
{
    const int64_t R = batch->rows;
    if (batch->sided > 0 && batch->G_free == batch->G)
        batch->G_free = memcpy(batch->G_frozen, batch->G, sizeof *batch->G * R * R);
    for (int i = 0; i < batch->sided; i++) {
        const int r = batch->sided_row[i];
        for (int64_t s = 0; s < R; s++) {
            V *row = batch->G_frozen + r * R + s, *column = batch->G_frozen + s * R + r;
            *row = only(batch->active[r], *row), *column = only(batch->active[r], *column);
        }
    }
}

/* G without the hinges that are on their limits, a rank-one part less for each, and without rows that take no part. */
static void free_gram(Batch *batch)
{
    const int64_t R = batch->rows;
    batch->G_free = batch->G;
    for (int64_t h = 0; h < batch->problem->of.hinges; h++) {
        if (!any(~batch->hinge_free[h]))
            continue;
        if (batch->G_free == batch->G)
            batch->G_free = memcpy(batch->G_frozen, batch->G, sizeof *batch->G * R * R);
        add_hinge(batch, h, only(~batch->hinge_free[h], all(-1.0)), batch->G_frozen);
    }
    for (int64_t cone = 0; cone < cones(batch); cone++) {
        if (!any(batch->cone_on[cone]))
            continue;
        if (batch->G_free == batch->G)
            batch->G_free = memcpy(batch->G_frozen, batch->G, sizeof *batch->G * R * R);
        take_cone(batch, cone, batch->G_frozen);
    }
    without_inactive_rows(batch);
}

/* J times what is done already: the steps of joints that are held and all above them, hinges on their limits. */
static void rows_of_fixed(Batch *batch, V *fixed)
{
    for (int64_t r = 0; r < batch->rows; r++)
        fixed[r] = all(0.0);
    if (batch->is_explicit)
        rows_times(batch, batch->base, fixed);
    for (int64_t h = 0; h < batch->problem->of.hinges; h++)
        if (any(~batch->hinge_free[h]))
            add_hinge_row(batch, h, batch->hinge_fixed[h], fixed);
    for (int64_t cone = 0; cone < cones(batch); cone++)
        if (any(batch->cone_on[cone]))
            add_cone_row(batch, cone, batch->cone_fixed[cone], fixed);
}

/* One pass: c, the steps of all layers in rank space, Q z from J z of the hinges that are free, and for each layer its
   rank, B and columns of M. Layers that hold joints leave what they do in the base. */
static void descend(Batch *batch, const V *Jz)
{
    const int64_t R = batch->rows;
    const double clamp = batch->problem->constants.largest_error;
    const double soft_clamp = batch->problem->constants.largest_soft_error;
    V *fixed = batch->scratch_rows, *b = fixed + R, *rest = fixed + 3 * R;
    batch->chain_count = batch->is_explicit = 0;
    for (int i = 0; i < batch->unknowns && batch->holds; i++)
        batch->base[i] = all(0.0);
    free_gram(batch);
    rows_of_fixed(batch, fixed);
    for (int l = 0; l < batch->problem->of.layers; l++) {
        Layer *layer = batch->layers + l;
        const V met = l == 0 ? all(clamp) : clamp * batch->anneal;
        const V largest = choose(less(all(0.0), layer->soft), all(soft_clamp), met);
        if (layer->held > 0) {
            hold_joints(batch, l, largest);
            rows_of_fixed(batch, fixed);
            Jz = batch->held_pull;
            continue;
        }
        batch->chain[batch->chain_count++] = layer;
        remaining_error(batch, layer, fixed, largest, b);
        less_above(batch, layer, Jz + layer->first, batch->Qz, rest);
        factor_layer(batch, layer, b, rest, largest, batch->c + layer->first);
        own_rank_space(layer, rest, batch->Qz);
    }
}
