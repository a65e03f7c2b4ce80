/* To rank space and back, and the rows that it is made of: batch.h. Part of solver.c. */

/* Numbers of a layer's rows less what the layers above account for: rows - M_l q_above. */
static void less_above(const Batch *batch, const Layer *layer, const V *rows, const V *above, V *rest)
{
    const int64_t R = batch->rows;
    for (int r = 0; r < layer->rows; r++)
        rest[r] = rows[r] - dot_product(batch->M + (layer->first + r) * R, above, layer->first);
}

/* A layer's part of Q v from what is left of J v below the layers above. */
static void own_rank_space(const Layer *layer, const V *rest, V *Qv)
{
    const int k = layer->rows;
    for (int q = 0; q < k; q++)
        Qv[layer->first + q] = dot_product(layer->B + q * k, rest, layer->full ? k : q + 1);
}

/* Q v from J v; shapes (R,). */
static void into_rank_space(const Batch *batch, const V *Jv, V *Qv)
{
    V *rest = batch->scratch_rows;
    for (int l = 0; l < batch->chain_count; l++) {
        const Layer *layer = batch->chain[l];
        less_above(batch, layer, Jv + layer->first, Qv, rest);
        own_rank_space(layer, rest, Qv);
    }
}

/* y with J^T y = Q^T q; shapes (R,). q is used up. */
static void out_of_rank_space(const Batch *batch, V *q, V *y)
{
    const int64_t R = batch->rows;
    for (int l = batch->chain_count - 1; l >= 0; l--) {
        const Layer *layer = batch->chain[l];
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
