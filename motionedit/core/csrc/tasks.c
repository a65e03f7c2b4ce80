/* Tasks: errors, rows as forces and torques on chains of columns, and G = J J^T from levers ([PRIO] 3, 4). Part of
   solver.c. */

/* Give out memory; with no memory yet only count it. */
static void *take(char **memory, size_t *needed, size_t bytes)
{
    void *place = *memory == NULL ? NULL : *memory + *needed;
    *needed += (bytes + 31) / 32 * 32;
    return place;
}

/* The columns from a node up to the root that a task recruits, growing; returns their number. */
static int chain(const Problem *problem, const Task *task, int64_t node, int *columns)
{
    int count = 0;
    for (int64_t i = node; i >= 0; i = problem->node[i].parent) {
        const int64_t column = problem->node[i].column;
        if (column >= 0 && task->recruited[column]) {
            if (columns != NULL)
                columns[count] = (int)column;
            count++;
        }
    }
    for (int i = 0; columns != NULL && i < count / 2; i++) {
        const int other = columns[i];
        columns[i] = columns[count - 1 - i], columns[count - 1 - i] = other;
    }
    return count;
}

/* The columns that carry mass. */
static int carriers(const Problem *problem, const Task *task, int *columns)
{
    int count = 0;
    for (int64_t k = 0; k < problem->columns; k++) {
        if (!task->recruited[k])
            continue;
        if (columns != NULL)
            columns[count] = (int)k;
        count++;
    }
    return count;
}

static int part_columns(const Problem *problem, const Task *task, int p, int *columns)
{
    if (task->kind == CENTER_OF_MASS)
        return carriers(problem, task, columns);
    return chain(problem, task, p == 0 ? task->node : task->base, columns);
}

/* Whether a task's rows are the world's axes. */
static int measures_plainly(const Task *task)
{
    int plain = task->rows == 3;
    for (int r = 0; r < 3; r++)
        for (int a = 0; a < 3; a++)
            plain &= task->measure[r][a] == (r == a ? 1.0 : 0.0);
    return plain;
}

static void lay_out_pull(const Problem *problem, const Task *task, Pull *pull, char **memory, size_t *needed)
{
    const int parts = task->base >= 0 ? 2 : 1;
    for (int p = 0; p < parts; p++) {
        const int count = part_columns(problem, task, p, NULL);
        int *columns = take(memory, needed, sizeof *columns * count);
        V *levers = take(memory, needed, 3 * sizeof *levers * count);
        if (columns == NULL)
            continue;
        part_columns(problem, task, p, columns);
        memset(levers, 0, 3 * sizeof *levers * count);
        Part *part = pull->part + p;
        memset(part, 0, sizeof *part);
        part->count = count, part->columns = columns, part->levers = levers;
        part->root = (int)(p == 0 ? task->root : task->base_root);
        part->has_force = task->kind != ORIENTATION && task->kind != POSTURE;
        part->has_torque = task->kind != POSITION && task->kind != CENTER_OF_MASS;
        part->plain = parts == 1 && !part->has_torque && measures_plainly(task);
        for (int r = 0; r < 3 && part->plain; r++)
            part->force[r][r] = all(task->weight);
    }
    if (pull != NULL)
        pull->parts = parts;
}

/* The columns without a hinge that two parts share. */
static int common(const Batch *batch, const Part *a, const Part *b, int *places)
{
    int count = 0;
    for (int i = 0, j = 0; i < a->count && j < b->count;) {
        if (a->columns[i] < b->columns[j])
            i++;
        else if (a->columns[i] > b->columns[j])
            j++;
        else {
            if (batch->column_hinge[a->columns[i]] < 0) {
                if (places != NULL)
                    places[2 * count] = i, places[2 * count + 1] = j;
                count++;
            }
            i++, j++;
        }
    }
    return count;
}

/* The rows that feel a hinge turn, growing. */
static void list_felt(Batch *batch, int64_t h)
{
    const Problem *problem = batch->problem;
    int *felt = batch->hinge_felt + h * problem->rows, count = 0;
    for (int64_t t = 0; t < problem->tasks; t++) {
        const Pull *pull = batch->pulls + t;
        int feels = 0;
        for (int p = 0; p < pull->parts; p++)
            for (int i = 0; i < pull->part[p].count; i++)
                feels |= batch->column_hinge[pull->part[p].columns[i]] == h;
        for (int64_t r = 0; r < problem->task[t].rows && feels; r++)
            felt[count++] = pull->first_row + (int)r;
    }
    batch->hinge_felt_count[h] = count;
}

/* Lay out what does not change from frame to frame. Called twice: to count the memory, and to fill it. */
static void lay_out_tasks(Batch *batch, char **memory, size_t *needed)
{
    const Problem *problem = batch->problem;
    const int tasks = (int)problem->tasks;
    batch->pulls = take(memory, needed, sizeof *batch->pulls * tasks);
    batch->hinge_felt = take(memory, needed, sizeof *batch->hinge_felt * problem->hinges * problem->rows);
    batch->hinge_felt_count = take(memory, needed, sizeof *batch->hinge_felt_count * problem->hinges);
    for (int t = 0; t < tasks; t++)
        lay_out_pull(problem, problem->task + t, batch->pulls == NULL ? NULL : batch->pulls + t, memory, needed);
    /* Every pair of parts, two a task at most: room for the longest lists. */
    const size_t pairs = (size_t)2 * tasks * (tasks + 1);
    batch->shared = take(memory, needed, sizeof *batch->shared * pairs);
    int *places = take(memory, needed, 2 * sizeof *places * problem->columns * pairs);
    if (batch->pulls == NULL)
        return;
    for (int t = 0, row = 0; t < tasks; t++) {
        batch->pulls[t].first_row = row;
        row += (int)problem->task[t].rows;
    }
    for (int64_t h = 0; h < problem->hinges; h++)
        list_felt(batch, h);
    batch->weighs = batch->shared_count = 0;
    for (int t = 0; t < tasks; t++)
        batch->weighs |= problem->task[t].kind == CENTER_OF_MASS;
    for (int s = 0; s < tasks; s++)
        for (int p = 0; p < batch->pulls[s].parts; p++) {
            const Part *mine = batch->pulls[s].part + p;
            for (int t = 0; t <= s; t++)
                for (int q = 0; q < batch->pulls[t].parts; q++) {
                    const Part *theirs = batch->pulls[t].part + q;
                    const int count = common(batch, mine, theirs, places);
                    if (count == 0 && !(mine->root && theirs->root))
                        continue;
                    batch->shared[batch->shared_count++] = (Shared){{s, t}, {p, q}, count, places};
                    places += 2 * count;
                }
        }
}

/* Put w times the measuring axes, turned by R, into the rows of a force. */
static void turned_axes(const Task *task, const V *R, V rows[3][3])
{
    for (int64_t r = 0; r < task->rows; r++) {
        turned_plain(R, task->measure[r], rows[r]);
        for (int a = 0; a < 3; a++)
            rows[r][a] *= task->weight;
    }
}

static void negated(V rows[3][3], V out[3][3])
{
    for (int r = 0; r < 3; r++)
        for (int a = 0; a < 3; a++)
            out[r][a] = -rows[r][a];
}

/* Levers from the columns of a part to a point. */
static void levers_to(const Batch *batch, Part *part, const V *point)
{
    for (int i = 0; i < part->count; i++) {
        const V *place = batch->positions + 3 * batch->problem->column_node[part->columns[i]];
        for (int a = 0; a < 3; a++)
            part->levers[3 * i + a] = point[a] - place[a];
    }
}

static const V IDENTITY[9] = {ONES, ZEROS, ZEROS, ZEROS, ONES, ZEROS, ZEROS, ZEROS, ONES};

/* e = target - x along the axes; dx = R_b^T (dp - dp_b - w_b x (p - p_b)): the base pulls back at the same point. */
static void evaluate_position(const Batch *batch, const Task *task, Pull *pull, const V *target, V *e)
{
    V point[3], seen[3];
    const V *base = task->base >= 0 ? batch->rotations + 9 * task->base : IDENTITY;
    turned_plain(batch->rotations + 9 * task->node, task->offset, point);
    add(point, batch->positions + 3 * task->node);
    memcpy(seen, point, sizeof seen);
    if (task->base >= 0) {
        add_scaled(seen, all(-1.0), batch->positions + 3 * task->base);
        turned_back(base, seen, seen);
    }
    for (int64_t r = 0; r < task->rows; r++)
        e[r] = task->weight * (target[task->axes[r]] - along(task->measure[r], seen));
    if (!pull->part[0].plain)
        turned_axes(task, base, pull->part[0].force);
    levers_to(batch, pull->part, point);
    if (task->base >= 0) {
        negated(pull->part[0].force, pull->part[1].force);
        levers_to(batch, pull->part + 1, point);
    }
}

/* e = target - c, and (m_sub / M) e_a x (c_sub - p_j). */
static void evaluate_center_of_mass(const Batch *batch, const Task *task, Pull *pull, const V *target, V *e)
{
    Part *part = pull->part;
    for (int64_t r = 0; r < task->rows; r++)
        e[r] = task->weight * (target[task->axes[r]] - along(task->measure[r], batch->center));
    if (!part->plain)
        turned_axes(task, IDENTITY, part->force);
    for (int i = 0; i < part->count; i++) {
        const int64_t node = batch->problem->column_node[part->columns[i]];
        for (int a = 0; a < 3; a++)
            part->levers[3 * i + a] =
                batch->mass_moments[3 * node + a] - batch->mass_shares[node] * batch->positions[3 * node + a];
    }
}

/* e = log(q_target q^-1), in the base's frame where there is one. */
static void evaluate_orientation(const Batch *batch, const Task *task, Pull *pull, const V *target, V *e)
{
    const V *base = task->base >= 0 ? batch->rotations + 9 * task->base : IDENTITY;
    const double scale = task->weight * METRES_PER_RADIAN;
    V q[4], turn[3];
    world_quaternion(batch, task->node, q);
    if (task->base >= 0) {
        V inverse[4];
        world_quaternion(batch, task->base, inverse);
        q_conjugate(inverse, inverse);
        q_multiply(inverse, q, q);
    }
    turn_to(target, q, turn);
    for (int r = 0; r < 3; r++) {
        e[r] = scale * turn[r];
        for (int a = 0; a < 3; a++)
            pull->part[0].torque[r][a] = scale * base[3 * a + r];
    }
    if (task->base >= 0)
        negated(pull->part[0].torque, pull->part[1].torque);
}

/* One joint's local rotation: e = log(q_target q^-1) as a world-axis increment, the identity in its own column. */
static void evaluate_posture(const Batch *batch, const Task *task, Pull *pull, const V *target, V *e)
{
    const double scale = task->weight * METRES_PER_RADIAN;
    V turn[3];
    turn_to(target, batch->local + 4 * task->node, turn);
    turned(parent_rotation(batch, task->node), turn, turn);
    for (int r = 0; r < 3; r++) {
        e[r] = scale * turn[r];
        pull->part[0].torque[r][r] = all(scale);
    }
}

/* Where an aim looks straight ahead or behind, any axis square to d will do: the one most square of the world's. */
static void any_side(const V *d, int lane, V *side)
{
    const double of[3] = {LANE(d[0], lane), LANE(d[1], lane), LANE(d[2], lane)};
    int least = 0;
    for (int a = 1; a < 3; a++)
        if (fabs(of[a]) < fabs(of[least]))
            least = a;
    const int next = (least + 1) % 3, last = (least + 2) % 3;
    LANE(side[least], lane) = 0.0;
    LANE(side[next], lane) = of[last], LANE(side[last], lane) = -of[next];
}

/* The turn from d to the target's direction, and (I - d d^T) w + d x (dp_e - dp_t) / r. */
static void evaluate_aim(const Batch *batch, const Task *task, Pull *pull, const V *target, V *e)
{
    const double scale = task->weight * METRES_PER_RADIAN;
    const V *turn = batch->rotations + 9 * task->node;
    V d[3], from[3], at[3], t[3], side[3], angle;
    turned_plain(turn, task->axis, d);
    turned_plain(turn, task->offset, from);
    add(from, batch->positions + 3 * task->node);
    memcpy(at, target, sizeof at);
    if (task->base >= 0) {
        memcpy(at, batch->positions + 3 * task->base, sizeof at);
        if (task->width) {
            V arm[3];
            turned(batch->rotations + 9 * task->base, target, arm);
            add(at, arm);
        }
    }
    for (int a = 0; a < 3; a++)
        t[a] = at[a] - from[a];
    const V distance = larger(root_of(dot(t, t)), all(1e-9));
    for (int a = 0; a < 3; a++)
        t[a] /= distance;
    cross(d, t, side);
    const V sine = root_of(dot(side, side)), cosine = dot(d, t);
    for (int lane = 0; lane < LANES; lane++) {
        LANE(angle, lane) = atan2(LANE(sine, lane), LANE(cosine, lane));
        if (LANE(sine, lane) < 1e-9)
            any_side(d, lane, side);
    }
    const V of_unit = angle / root_of(dot(side, side));
    for (int r = 0; r < 3; r++) {
        V *torque = pull->part[0].torque[r], *force = pull->part[0].force[r];
        V axis[3] = {all(0.0), all(0.0), all(0.0)};
        e[r] = scale * of_unit * side[r];
        axis[r] = all(1.0);
        cross(axis, d, force);
        for (int a = 0; a < 3; a++) {
            torque[a] = scale * (axis[a] - d[r] * d[a]);
            force[a] *= scale / distance;
        }
    }
    levers_to(batch, pull->part, from);
    if (task->base >= 0) {
        negated(pull->part[0].force, pull->part[1].force);
        levers_to(batch, pull->part + 1, at);
    }
}

/* Errors, shape (R,), and the rows of every task, at the pose that `forward` has laid out. */
static void evaluate_tasks(Batch *batch)
{
    for (int64_t t = 0; t < batch->problem->tasks; t++) {
        const Task *task = batch->problem->task + t;
        Pull *pull = batch->pulls + t;
        const V *target = batch->targets + 4 * t;
        V *e = batch->errors + pull->first_row;
        switch (task->kind) {
        case POSITION: evaluate_position(batch, task, pull, target, e); break;
        case CENTER_OF_MASS: evaluate_center_of_mass(batch, task, pull, target, e); break;
        case ORIENTATION: evaluate_orientation(batch, task, pull, target, e); break;
        case POSTURE: evaluate_posture(batch, task, pull, target, e); break;
        default: evaluate_aim(batch, task, pull, target, e);
        }
    }
}

/* What the rows have along a hinge's axis: hinge_rows[h][r] = a . (l x f + t). */
static void hinge_rows(Batch *batch)
{
    const Problem *problem = batch->problem;
    for (int64_t i = 0; i < problem->hinges * problem->rows; i++)
        batch->hinge_rows[i] = all(0.0);
    for (int64_t t = 0; t < problem->tasks; t++) {
        const Pull *pull = batch->pulls + t;
        for (int p = 0; p < pull->parts; p++) {
            const Part *part = pull->part + p;
            for (int i = 0; i < part->count; i++) {
                const int h = batch->column_hinge[part->columns[i]];
                if (h < 0)
                    continue;
                V *out = batch->hinge_rows + h * problem->rows + pull->first_row, lever[3];
                const V *axis = batch->hinge_axes + 3 * h;
                cross(axis, part->levers + 3 * i, lever); /* a . (l x f) = f . (a x l) */
                for (int64_t r = 0; r < problem->task[t].rows; r++)
                    out[r] += dot(part->force[r], lever) + dot(part->torque[r], axis);
            }
        }
    }
}

/* Sums over the columns that two parts share, l the one's levers and m the other's. */
typedef struct {
    V outer[3][3]; /* sum m l^T */
    V l[3], m[3];
} Sums;

static void sum_levers(const Shared *shared, const Part *a, const Part *b, Sums *sums)
{
    const int turns = a->has_torque || b->has_torque;
    const V none = all(0.0);
    V xx = none, xy = none, xz = none, yx = none, yy = none, yz = none, zx = none, zy = none, zz = none;
    for (int x = 0; x < 3; x++)
        sums->l[x] = sums->m[x] = none;
    for (int i = 0; i < shared->count; i++) {
        const V *l = a->levers + 3 * shared->places[2 * i], *m = b->levers + 3 * shared->places[2 * i + 1];
        if (turns)
            add(sums->l, l), add(sums->m, m);
        if (!a->has_force || !b->has_force)
            continue;
        xx += m[0] * l[0], xy += m[0] * l[1], xz += m[0] * l[2];
        yx += m[1] * l[0], yy += m[1] * l[1], yz += m[1] * l[2];
        zx += m[2] * l[0], zy += m[2] * l[1], zz += m[2] * l[2];
    }
    memcpy(sums->outer, (V[3][3]){{xx, xy, xz}, {yx, yy, yz}, {zx, zy, zz}}, sizeof sums->outer);
}

/* Add sum_j (l_j x f_r + t_r) . (m_j x g_s + u_s) over the shared columns, and the root's f_r . g_s. */
static void add_block(Batch *batch, const Shared *shared)
{
    const Problem *problem = batch->problem;
    const Pull *mine = batch->pulls + shared->task[0], *theirs = batch->pulls + shared->task[1];
    const Part *a = mine->part + shared->part[0], *b = theirs->part + shared->part[1];
    const int64_t rows = problem->task[shared->task[0]].rows, others = problem->task[shared->task[1]].rows;
    Sums sums;
    sum_levers(shared, a, b, &sums);
    const V(*outer)[3] = sums.outer;
    const V between = outer[0][0] + outer[1][1] + outer[2][2] + (a->root && b->root ? 1.0 : 0.0);
    if (a->plain && b->plain) { /* the world's axes on both sides: (l x e_r) . (m x e_s) = (l . m) [r = s] - m_r l_s */
        const V scale = a->force[0][0] * b->force[0][0];
        V *out = batch->G + mine->first_row * problem->rows + theirs->first_row;
        for (int r = 0; r < 3; r++, out += problem->rows)
            for (int s = 0; s < 3; s++)
                out[s] += scale * (r == s ? between - outer[r][s] : -outer[r][s]);
        return;
    }
    for (int64_t r = 0; r < rows; r++) {
        const V *f = a->force[r], *t = a->torque[r];
        V pushed[3] = {all(0.0), all(0.0), all(0.0)};
        V *out = batch->G + (mine->first_row + r) * problem->rows + theirs->first_row;
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
                twisted[x] = shared->count * t[x];
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

/* G += factor times a hinge's rank-one part, in the rows that feel it. */
static void add_hinge(const Batch *batch, int64_t h, V factor, V *G)
{
    const int64_t R = batch->problem->rows;
    const V *along = batch->hinge_rows + h * R;
    const int *felt = batch->hinge_felt + h * R;
    for (int i = 0; i < batch->hinge_felt_count[h]; i++) {
        const V scaled = factor * along[felt[i]];
        V *row = G + felt[i] * R;
        for (int j = 0; j <= i; j++)
            row[felt[j]] += scaled * along[felt[j]];
    }
}

/* G = J J^T, shape (R, R), lower triangle of blocks, with every hinge turning. */
static void gram(Batch *batch)
{
    const Problem *problem = batch->problem;
    for (int64_t i = 0; i < problem->rows * problem->rows; i++)
        batch->G[i] = all(0.0);
    for (int i = 0; i < batch->shared_count; i++)
        add_block(batch, batch->shared + i);
    hinge_rows(batch);
    for (int64_t h = 0; h < problem->hinges; h++)
        add_hinge(batch, h, all(1.0), batch->G);
}

/* out += factor times what the rows have of a hinge, shape (R,). */
static void add_hinge_row(const Batch *batch, int64_t h, V factor, V *out)
{
    const int *felt = batch->hinge_felt + h * batch->problem->rows;
    for (int i = 0; i < batch->hinge_felt_count[h]; i++)
        out[felt[i]] += factor * batch->hinge_rows[h * batch->problem->rows + felt[i]];
}

/* J v, shape (R,), of a step v, shape (n,). */
static void rows_times(const Batch *batch, const V *v, V *out)
{
    const Problem *problem = batch->problem;
    for (int64_t t = 0; t < problem->tasks; t++) {
        const Pull *pull = batch->pulls + t;
        for (int64_t r = 0; r < problem->task[t].rows; r++)
            out[pull->first_row + r] = all(0.0);
        for (int p = 0; p < pull->parts; p++) {
            const Part *part = pull->part + p;
            V moved[3] = {all(0.0), all(0.0), all(0.0)}, twist[3] = {all(0.0), all(0.0), all(0.0)};
            for (int i = 0; i < part->count; i++) {
                const int h = batch->column_hinge[part->columns[i]];
                const V *w = v + batch->column_unknown[part->columns[i]];
                V turn[3];
                if (h >= 0) {
                    for (int a = 0; a < 3; a++)
                        turn[a] = w[0] * batch->hinge_axes[3 * h + a];
                    w = turn;
                }
                if (part->has_force) {
                    V lever[3];
                    cross(w, part->levers + 3 * i, lever);
                    add(moved, lever);
                }
                if (part->has_torque)
                    add(twist, w);
            }
            if (part->root)
                add(moved, v + batch->unknowns - 3);
            for (int64_t r = 0; r < problem->task[t].rows; r++) {
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
    for (int64_t t = 0; t < problem->tasks; t++) {
        const Pull *pull = batch->pulls + t;
        for (int p = 0; p < pull->parts; p++) {
            const Part *part = pull->part + p;
            V force[3] = {all(0.0), all(0.0), all(0.0)}, torque[3] = {all(0.0), all(0.0), all(0.0)};
            for (int64_t r = 0; r < problem->task[t].rows; r++) {
                const V of = y[pull->first_row + r];
                if (part->has_force)
                    add_scaled(force, of, part->force[r]);
                if (part->has_torque)
                    add_scaled(torque, of, part->torque[r]);
            }
            for (int i = 0; i < part->count; i++) {
                const int h = batch->column_hinge[part->columns[i]];
                V turn[3] = {torque[0], torque[1], torque[2]}, *to = out + batch->column_unknown[part->columns[i]];
                if (part->has_force) {
                    V lever[3];
                    cross(part->levers + 3 * i, force, lever);
                    add(turn, lever);
                }
                if (h < 0)
                    add(to, turn);
                else
                    to[0] += dot(batch->hinge_axes + 3 * h, turn);
            }
            if (part->root)
                add(out + batch->unknowns - 3, force);
        }
    }
    for (int64_t h = 0; h < problem->hinges; h++) {
        V *turn = out + batch->column_unknown[problem->hinge[h].column];
        *turn = only(batch->hinge_free[h], *turn);
    }
}
