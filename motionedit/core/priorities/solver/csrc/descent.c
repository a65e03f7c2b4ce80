/* A step within limits: down the layers, again with hinges and cones set on their limits and with the one-sided rows that
   would be violated. hinged.py, cones.py, one_sided.py. Part of solver.c. */

/* Metres and radians: what is less is rounding. */
#define AT_REST 1e-13

static V length(const V *v, int n)
{
    return root_of(dot_product(v, v, n));
}

/* Scratch of R numbers; layers.c uses the first two. */
static V *scratch(const Batch *batch, int which)
{
    return batch->scratch_rows + (2 + which) * batch->rows;
}

/* Hinges and cones on their limits take no part, nor do unknowns that are held. */
static void without_fixed(const Batch *batch, V *v)
{
    for (int i = 0; i < batch->unknowns && batch->holds; i++)
        if (batch->holder[i] >= 0)
            v[i] = all(0.0);
    for (int64_t h = 0; h < batch->problem->of.hinges; h++) {
        V *turn = hinge_turn(batch, v, h);
        *turn = only(batch->hinge_free[h], *turn);
    }
    if (keeps_limits(batch))
        off_cones(batch, v);
}

/* v <- v - Q^T q; q is used up. */
static void subtract_rank_space(const Batch *batch, V *q, V *v)
{
    V *y = scratch(batch, 0);
    out_of_rank_space(batch, q, y);
    for (int64_t r = 0; r < batch->rows; r++)
        y[r] = -y[r];
    add_chain_transposed(batch, y, v);
}

/* v <- v P, what no layer sees: v - Q^T (Q v). Hinges on their limits take no part. */
static void off_layers(const Batch *batch, V *v)
{
    V *Jv = scratch(batch, 0), *q = scratch(batch, 1);
    without_fixed(batch, v);
    chain_times(batch, v, Jv);
    into_rank_space(batch, Jv, q);
    subtract_rank_space(batch, q, v);
}

/* J z of the hinges that are free, from J z of all of them: a hinge's part is its row times its turn. */
static void free_pull(const Batch *batch, const V *Jz, V *free)
{
    memcpy(free, Jz, sizeof *free * batch->rows);
    for (int64_t h = 0; h < batch->problem->of.hinges; h++)
        if (any(~batch->hinge_free[h]))
            add_hinge_row(batch, h, only(~batch->hinge_free[h], -*hinge_turn(batch, batch->z, h)), free);
    for (int64_t cone = 0; cone < cones(batch); cone++)
        if (any(batch->cone_on[cone]))
            add_cone_row(batch, cone, only(batch->cone_on[cone], -cone_turn(batch, batch->z, cone)), free);
}

/* Where a turn over its mobility takes a hinge (rad), and whether that is beyond its limits. */
static Mask beyond(const Batch *batch, int64_t h, V turn, V *limited)
{
    const Constants *constants = &batch->problem->constants;
    const Hinge *hinge = batch->problem->hinge + h;
    const V after = batch->hinge_angles[h] + hinge_mobility(batch, h) * turn;
    *limited = smaller(larger(after, all(hinge->limits[0])), all(hinge->limits[1]));
    return less(all(constants->on_limit), size_of(after - *limited)) & batch->hinge_free[h];
}

/* Set on their limits the hinges that the step, gain z + J^T y, would take beyond them; returns whether there were any. */
static int set_on_limits(Batch *batch, const V *y)
{
    const Problem *problem = batch->problem;
    int out = 0;
    for (int64_t h = 0; h < problem->of.hinges; h++) {
        V turn = batch->gain * *hinge_turn(batch, batch->z, h), limited;
        if (batch->holds)
            turn = *hinge_turn(batch, batch->step, h);
        for (int i = 0; i < batch->hinge_felt_count[h] && !batch->holds; i++) {
            const int r = batch->hinge_felt[h * batch->rows + i];
            turn += batch->hinge_rows[h * batch->rows + r] * y[r];
        }
        const Mask leaves = beyond(batch, h, turn, &limited);
        const V onto = (limited - batch->hinge_angles[h]) / hinge_mobility(batch, h);
        batch->hinge_fixed[h] = choose(leaves, onto, batch->hinge_fixed[h]);
        batch->hinge_free[h] &= ~leaves;
        out |= any(leaves);
    }
    return out;
}

/* step = base + fixed hinges + gain z + Q^T (c - gain Q z) = base + fixed hinges + gain z + J^T y */
static void make_step(Batch *batch, const V *y)
{
    for (int i = 0; i < batch->unknowns; i++)
        batch->step[i] = batch->gain * batch->z[i];
    without_fixed(batch, batch->step);
    add_chain_transposed(batch, y, batch->step);
    for (int i = 0; i < batch->unknowns && batch->holds; i++)
        batch->step[i] += batch->base[i];
    for (int64_t h = 0; h < batch->problem->of.hinges; h++)
        *hinge_turn(batch, batch->step, h) += batch->hinge_fixed[h];
    if (keeps_limits(batch))
        add_cones(batch, batch->step);
}

/* By how much a step violates the i-th of the one-sided rows, where that takes no part, given J step; 0 where it does
   not. */
static V lack(const Batch *batch, int i, const V *Jstep)
{
    const int r = batch->sided_row[i];
    const V lacks = batch->errors[r] - Jstep[r];
    return only(~batch->active[r] & less(all(batch->problem->constants.on_side), lacks), lacks);
}

/* one_sided.py: let rows take part that the step violates, the worst of each lane or `every` one; returns whether there
   were any. */
static int take_in(Batch *batch, int every)
{
    V *Jstep = scratch(batch, 3), most = all(0.0);
    int found = 0;
    rows_times(batch, batch->step, Jstep);
    for (int i = 0; i < batch->sided && !every; i++)
        most = larger(most, lack(batch, i, Jstep));
    for (int i = 0; i < batch->sided; i++) {
        const V lacks = lack(batch, i, Jstep);
        const Mask new = less(all(0.0), lacks) & ~less(lacks, most);
        batch->active[batch->sided_row[i]] |= new;
        found |= any(new);
    }
    return found;
}

/* Descend, and again with hinges that would leave their limits set on them, and with the one-sided rows that would be
   violated; Q z and the step come out. */
static void descend_within_limits(Batch *batch)
{
    const Constants *constants = &batch->problem->constants;
    const Problem *problem = batch->problem;
    const int needs_step = batch->sided > 0 || batch->holds || keeps_limits(batch);
    const int rounds = (int)(batch->sided > 0 ? constants->sided_rounds : constants->limit_rounds);
    V *y = scratch(batch, 0), *q = scratch(batch, 1), *Jz = scratch(batch, 2);
    for (int64_t h = 0; h < problem->of.hinges; h++)
        batch->hinge_free[h] = everywhere(), batch->hinge_fixed[h] = all(0.0);
    no_cones_on(batch);
    rows_times(batch, batch->z, Jz);
    for (int round = 0;; round++) {
        free_pull(batch, Jz, y);
        descend(batch, y);
        for (int64_t p = 0; p < batch->rows; p++)
            q[p] = batch->c[p] - batch->gain * batch->Qz[p];
        out_of_rank_space(batch, q, y);
        if (needs_step || round == rounds)
            make_step(batch, y);
        if (round == rounds)
            return;
        int again = batch->sided > 0 && take_in(batch, round == rounds - 1);
        again |= set_on_limits(batch, y);
        again |= keeps_limits(batch) && set_on_cones(batch, batch->step);
        if (!again)
            break;
    }
    if (!needs_step)
        make_step(batch, y);
}

/* The length of Q^T c, the base and the fixed hinges, which are orthogonal. */
static V task_length(const Batch *batch)
{
    const int hinges = (int)batch->problem->of.hinges;
    V square = dot_product(batch->c, batch->c, batch->rows);
    square += dot_product(batch->hinge_fixed, batch->hinge_fixed, hinges);
    if (keeps_limits(batch))
        square += dot_product(batch->cone_fixed, batch->cone_fixed, (int)cones(batch));
    if (batch->holds)
        square += dot_product(batch->base, batch->base, batch->unknowns);
    return root_of(square);
}
