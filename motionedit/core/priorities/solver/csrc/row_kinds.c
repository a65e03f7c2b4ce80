/* The kinds of rows that the compiled solver knows: errors, and rows as forces and torques on columns ([PRIO] 3, 4). A new
   one is a function and its line in the table at the end. Part of solver.c. */

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
        const double mobility = batch->problem->mobility[part->columns[i]];
        for (int a = 0; a < 3; a++)
            part->levers[3 * i + a] = mobility * (point[a] - place[a]);
    }
}

/* e = target - x along the axes; dx = R_b^T (dp - dp_b - w_b x (p - p_b)): the base pulls back at the same point. */
static void evaluate_position(const Batch *batch, const Task *task, Pull *pull, const V *target, V *e)
{
    V point[3], seen[3];
    const V *base = task->base >= 0 ? batch->rotations + 9 * task->base : batch->identity;
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
        turned_axes(task, batch->identity, part->force);
    for (int i = 0; i < part->count; i++) {
        const int64_t node = batch->problem->column_node[part->columns[i]];
        const double mobility = batch->problem->mobility[part->columns[i]];
        for (int a = 0; a < 3; a++)
            part->levers[3 * i + a] = mobility * (batch->mass_moments[3 * node + a] -
                                                     batch->mass_shares[node] * batch->positions[3 * node + a]);
    }
}

/* e = log(q_target q^-1), in the base's frame where there is one. */
static void evaluate_orientation(const Batch *batch, const Task *task, Pull *pull, const V *target, V *e)
{
    const V *base = task->base >= 0 ? batch->rotations + 9 * task->base : batch->identity;
    const double scale = task->weight * batch->problem->constants.metres_per_radian;
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
    const double scale = task->weight * batch->problem->constants.metres_per_radian;
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
    const double scale = task->weight * batch->problem->constants.metres_per_radian;
    const V *turn = batch->rotations + 9 * task->node;
    V d[3], from[3], at[3], t[3], side[3], angle;
    turned_plain(turn, task->axis, d);
    turned_plain(turn, task->offset, from);
    add(from, batch->positions + 3 * task->node);
    memcpy(at, target, sizeof at);
    if (task->base >= 0) {
        V arm[3];
        turned(batch->rotations + 9 * task->base, target, arm);
        memcpy(at, batch->positions + 3 * task->base, sizeof at);
        add(at, arm);
    }
    for (int a = 0; a < 3; a++)
        t[a] = at[a] - from[a];
    const V distance = larger(root_of(dot(t, t)), all(batch->problem->constants.no_direction));
    for (int a = 0; a < 3; a++)
        t[a] /= distance;
    cross(d, t, side);
    const V sine = root_of(dot(side, side)), cosine = dot(d, t);
    for (int lane = 0; lane < LANES; lane++) {
        LANE(angle, lane) = atan2(LANE(sine, lane), LANE(cosine, lane));
        if (LANE(sine, lane) < batch->problem->constants.no_direction)
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

/* A point fixed in a node, in the world. */
static void point_of(const Batch *batch, int64_t node, const double *offset, V *point)
{
    turned_plain(batch->rotations + 9 * node, offset, point);
    add(point, batch->positions + 3 * node);
}

/* e = d - |p - q|, u (dp - dq); where two points meet, any u will do to part them: x. */
static void evaluate_distance(const Batch *batch, const Task *task, Pull *pull, const V *target, V *e)
{
    const double none = batch->problem->constants.no_direction;
    V point[3], to[3], way[3];
    point_of(batch, task->node, task->offset, point);
    point_of(batch, task->base, task->base_offset, to);
    for (int a = 0; a < 3; a++)
        way[a] = point[a] - to[a];
    const V distance = root_of(dot(way, way)), size = larger(distance, all(none));
    e[0] = task->weight * (target[0] - distance);
    for (int a = 0; a < 3; a++)
        pull->part[0].force[0][a] =
            task->weight * choose(less(distance, all(none)), all(a == 0 ? 1.0 : 0.0), way[a] / size);
    negated(pull->part[0].force, pull->part[1].force);
    levers_to(batch, pull->part, point);
    levers_to(batch, pull->part + 1, to);
}

static const struct {
    RowKind is;
    /* errors into e, rows into the parts of the pull */
    void (*evaluate)(const Batch *batch, const Task *task, Pull *pull, const V *target, V *e);
} ROW_KINDS[] = {
    {{"position", .force = 1, .width = 3}, evaluate_position},
    {{"orientation", .torque = 1, .rows = 3, .width = 4}, evaluate_orientation},
    {{"center of mass", .force = 1, .weighs = 1, .width = 3}, evaluate_center_of_mass},
    {{"aim", .force = 1, .torque = 1, .rows = 3, .width = 3}, evaluate_aim},
    {{"posture", .torque = 1, .rows = 3, .holds = 1, .width = 4}, evaluate_posture},
    {{"distance", .force = 1, .rows = 1, .spans = 1, .width = 1}, evaluate_distance},
};

const RowKind *row_kind(int64_t kind)
{
    return kind < (int64_t)(sizeof ROW_KINDS / sizeof *ROW_KINDS) ? &ROW_KINDS[kind].is : NULL;
}

/* Errors, shape (R,), and the rows of every task, at the pose that `forward` has laid out. */
static void evaluate_tasks(Batch *batch)
{
    for (int64_t t = 0; t < batch->problem->of.tasks; t++) {
        const Task *task = batch->problem->task + t;
        Pull *pull = batch->pulls + t;
        V *errors = pull->rows > 0 ? batch->errors : batch->held_errors;
        ROW_KINDS[task->kind].evaluate(batch, task, pull, batch->targets + 4 * t, errors + pull->first_row);
    }
}
