/* J by its levers: G = J J^T, J v and J^T y ([PRIO] 3). Part of solver.c. */

/* The unknown of a step that is a hinge's turn, over its mobility. */
static V *hinge_turn(const Batch *batch, V *v, int64_t h)
{
    const Hinge *hinge = batch->problem->hinge + h;
    return v + batch->column_unknown[hinge->column] + hinge->second;
}

/* What the rows have along a hinge's axis: hinge_rows[h][r] = mobility a . (l x f + t). */
static void hinge_rows(Batch *batch)
{
    const Problem *problem = batch->problem;
    for (int64_t i = 0; i < problem->of.hinges * batch->rows; i++)
        batch->hinge_rows[i] = all(0.0);
    for (int64_t t = 0; t < problem->of.tasks; t++) {
        const Pull *pull = batch->pulls + t;
        for (int p = 0; p < pull->parts; p++) {
            const Part *part = pull->part + p;
            for (int i = 0; i < part->count; i++) {
                const int column = part->columns[i], first = batch->column_hinge[column];
                for (int h = first; h < first + batch->column_hinges[column]; h++) {
                    V *out = batch->hinge_rows + h * batch->rows + pull->first_row, lever[3];
                    const V *axis = batch->hinge_axes + 3 * h;
                    cross(axis, part->levers + 3 * i, lever); /* a . (l x f) = f . (a x l) */
                    for (int64_t r = 0; r < pull->rows; r++)
                        out[r] += dot(part->force[r], lever) + problem->mobility[column] * dot(part->torque[r], axis);
                }
            }
        }
    }
}

/* Sums over the columns that two parts share, l the one's levers and m the other's, which hold the columns' mobility. */
typedef struct {
    V outer[3][3]; /* sum m l^T */
    V l[3], m[3];  /* times the mobility once more */
} Sums;

static void sum_levers(const double *mobility, const Shared *shared, const Part *a, const Part *b, Sums *sums)
{
    const int turns = a->has_torque || b->has_torque;
    const V none = all(0.0);
    V xx = none, xy = none, xz = none, yx = none, yy = none, yz = none, zx = none, zy = none, zz = none;
    for (int x = 0; x < 3; x++)
        sums->l[x] = sums->m[x] = none;
    for (int i = 0; i < shared->count; i++) {
        const V *l = a->levers + 3 * shared->places[2 * i], *m = b->levers + 3 * shared->places[2 * i + 1];
        if (turns) {
            const V moves = all(mobility[a->columns[shared->places[2 * i]]]);
            add_scaled(sums->l, moves, l), add_scaled(sums->m, moves, m);
        }
        if (!a->has_force || !b->has_force)
            continue;
        xx += m[0] * l[0], xy += m[0] * l[1], xz += m[0] * l[2];
        yx += m[1] * l[0], yy += m[1] * l[1], yz += m[1] * l[2];
        zx += m[2] * l[0], zy += m[2] * l[1], zz += m[2] * l[2];
    }
    const V outer[3][3] = {{xx, xy, xz}, {yx, yy, yz}, {zx, zy, zz}};
    memcpy(sums->outer, outer, sizeof outer);
}

/* Add sum_j (l_j x f_r + t_r) . (m_j x g_s + u_s) over the shared columns, and the root's f_r . g_s. */
static void add_block(Batch *batch, const Shared *shared)
{
    const Problem *problem = batch->problem;
    const Pull *mine = batch->pulls + shared->task[0], *theirs = batch->pulls + shared->task[1];
    const Part *a = mine->part + shared->part[0], *b = theirs->part + shared->part[1];
    const int64_t rows = problem->task[shared->task[0]].rows, others = problem->task[shared->task[1]].rows;
    Sums sums;
    sum_levers(problem->mobility, shared, a, b, &sums);
    V(*outer)[3] = sums.outer;
    const double shift = problem->mobility[problem->of.columns];
    const V between = outer[0][0] + outer[1][1] + outer[2][2] + (a->root && b->root ? shift * shift : 0.0);
    if (a->plain && b->plain) { /* the world's axes on both sides: (l x e_r) . (m x e_s) = (l . m) [r = s] - m_r l_s */
        const V scale = a->force[0][0] * b->force[0][0];
        V *out = batch->G + mine->first_row * batch->rows + theirs->first_row;
        for (int r = 0; r < 3; r++, out += batch->rows)
            for (int s = 0; s < 3; s++)
                out[s] += scale * (r == s ? between - outer[r][s] : -outer[r][s]);
        return;
    }
    for (int64_t r = 0; r < rows; r++) {
        const V *f = a->force[r], *t = a->torque[r];
        V pushed[3] = {all(0.0), all(0.0), all(0.0)};
        V *out = batch->G + (mine->first_row + r) * batch->rows + theirs->first_row;
        /* (l x f) . (m x g) = (l . m) (f . g) - (m . f) (l . g) */
        for (int x = 0; x < 3 && a->has_force && b->has_force; x++)
            pushed[x] = between * f[x] - (outer[0][x] * f[0] + outer[1][x] * f[1] + outer[2][x] * f[2]);
        if (a->has_torque && b->has_force) { /* t . (m x g) = g . (t x m) */
            V lever[3];
            cross(t, sums.m, lever);
            add(pushed, lever);
        }
        for (int64_t s = 0; s < others && b->has_force; s++)
            out[s] += dot(pushed, b->force[s]);
        if (b->has_torque) {
            V twisted[3];
            for (int x = 0; x < 3; x++)
                twisted[x] = shared->mobility * t[x];
            if (a->has_force) {
                V lever[3];
                cross(sums.l, f, lever);
                add(twisted, lever);
            }
            for (int64_t s = 0; s < others; s++)
                out[s] += dot(twisted, b->torque[s]);
        }
    }
}

static double hinge_mobility(const Batch *batch, int64_t h)
{
    return batch->problem->mobility[batch->problem->hinge[h].column];
}

/* G += factor times a hinge's rank-one part, in the rows that feel it. */
static void add_hinge(const Batch *batch, int64_t h, V factor, V *G)
{
    const int64_t R = batch->rows;
    const V *turns = batch->hinge_rows + h * R;
    const int *felt = batch->hinge_felt + h * R;
    for (int i = 0; i < batch->hinge_felt_count[h]; i++) {
        const V scaled = factor * turns[felt[i]];
        V *row = G + felt[i] * R;
        for (int j = 0; j <= i; j++)
            row[felt[j]] += scaled * turns[felt[j]];
    }
}

/* G = J J^T, shape (R, R), lower triangle of blocks, with every hinge turning. */
static void gram(Batch *batch)
{
    const Problem *problem = batch->problem;
    for (int64_t i = 0; i < batch->rows * batch->rows; i++)
        batch->G[i] = all(0.0);
    for (int i = 0; i < batch->shared_count; i++)
        add_block(batch, batch->shared + i);
    hinge_rows(batch);
    for (int64_t h = 0; h < problem->of.hinges; h++)
        add_hinge(batch, h, all(1.0), batch->G);
}

/* out += factor times what the rows have of a hinge, shape (R,). */
static void add_hinge_row(const Batch *batch, int64_t h, V factor, V *out)
{
    const int *felt = batch->hinge_felt + h * batch->rows;
    for (int i = 0; i < batch->hinge_felt_count[h]; i++)
        out[felt[i]] += factor * batch->hinge_rows[h * batch->rows + felt[i]];
}

/* J v, shape (R,), of a step v, shape (n,). */
static void rows_times(const Batch *batch, const V *v, V *out)
{
    const Problem *problem = batch->problem;
    for (int64_t t = 0; t < problem->of.tasks; t++) {
        const Pull *pull = batch->pulls + t;
        for (int64_t r = 0; r < pull->rows; r++)
            out[pull->first_row + r] = all(0.0);
        for (int p = 0; p < pull->parts; p++) {
            const Part *part = pull->part + p;
            V moved[3] = {all(0.0), all(0.0), all(0.0)}, twist[3] = {all(0.0), all(0.0), all(0.0)};
            for (int i = 0; i < part->count; i++) {
                const int column = part->columns[i], h = batch->column_hinge[column];
                const V *w = v + batch->column_unknown[column];
                V turn[3];
                if (h >= 0) {
                    for (int a = 0; a < 3; a++)
                        turn[a] = w[0] * batch->hinge_axes[3 * h + a];
                    if (batch->column_hinges[column] == 2)
                        add_scaled(turn, w[1], batch->hinge_axes + 3 * (h + 1));
                    w = turn;
                }
                if (part->has_force) {
                    V lever[3];
                    cross(w, part->levers + 3 * i, lever);
                    add(moved, lever);
                }
                if (part->has_torque)
                    add_scaled(twist, all(problem->mobility[column]), w);
            }
            if (part->root)
                add_scaled(moved, all(problem->mobility[problem->of.columns]), v + batch->unknowns - 3);
            for (int64_t r = 0; r < pull->rows; r++) {
                if (part->has_force)
                    out[pull->first_row + r] += dot(part->force[r], moved);
                if (part->has_torque)
                    out[pull->first_row + r] += dot(part->torque[r], twist);
            }
        }
    }
}

/* out += J^T y: each part's forces and torques add up to one of each; hinges on their limits come to 0. */
static void add_rows_transposed(const Batch *batch, const V *y, V *out)
{
    const Problem *problem = batch->problem;
    for (int64_t t = 0; t < problem->of.tasks; t++) {
        const Pull *pull = batch->pulls + t;
        for (int p = 0; p < pull->parts; p++) {
            const Part *part = pull->part + p;
            V force[3] = {all(0.0), all(0.0), all(0.0)}, torque[3] = {all(0.0), all(0.0), all(0.0)};
            for (int64_t r = 0; r < pull->rows; r++) {
                const V of = y[pull->first_row + r];
                if (part->has_force)
                    add_scaled(force, of, part->force[r]);
                if (part->has_torque)
                    add_scaled(torque, of, part->torque[r]);
            }
            for (int i = 0; i < part->count; i++) {
                const int column = part->columns[i], h = batch->column_hinge[column];
                const double mobility = problem->mobility[column];
                V turn[3] = {mobility * torque[0], mobility * torque[1], mobility * torque[2]};
                V *to = out + batch->column_unknown[column];
                if (part->has_force) {
                    V lever[3];
                    cross(part->levers + 3 * i, force, lever);
                    add(turn, lever);
                }
                if (h < 0)
                    add(to, turn);
                for (int j = 0; j < batch->column_hinges[column]; j++)
                    to[j] += dot(batch->hinge_axes + 3 * (h + j), turn);
            }
            if (part->root)
                add_scaled(out + batch->unknowns - 3, all(problem->mobility[problem->of.columns]), force);
        }
    }
    for (int64_t h = 0; h < problem->of.hinges; h++) {
        V *turn = hinge_turn(batch, out, h);
        *turn = only(batch->hinge_free[h], *turn);
    }
    if (keeps_limits(batch))
        off_cones(batch, out);
}
