/* The bodies of a batch: frames in and out of lanes, forward kinematics, the pull z of eq. (1), hinges, and the step put
   into the joints. Part of solver.c. */

/* Radians: limits as far apart as this are none. */
#define ALL_ROUND 12.0

/* Put frame `at` into a lane. */
static void load(Batch *batch, int lane, int64_t at)
{
    const Problem *problem = batch->problem;
    const int64_t own = problem->frames[at];
    const double *local = problem->rotations + 4 * problem->of.joints * own;
    const double *translations = problem->translations + 3 * problem->of.translated * own;
    const double *reference = problem->reference_rotations + 4 * problem->of.joints * own;
    for (int64_t i = 0; i < problem->of.nodes; i++) {
        const Node *node = problem->node + i;
        const double *offset = node->translation < 0 ? node->offset : translations + 3 * node->translation;
        for (int a = 0; a < 4; a++)
            LANE(batch->local[4 * i + a], lane) = local[4 * node->joint + a];
        for (int a = 0; a < 3; a++)
            LANE(batch->offsets[3 * i + a], lane) = offset[a];
    }
    for (int64_t k = 0; k < problem->of.columns; k++)
        for (int a = 0; a < 4; a++)
            LANE(batch->reference[4 * k + a], lane) = reference[4 * problem->node[problem->column_node[k]].joint + a];
    for (int a = 0; a < 3 && problem->pulls_root; a++)
        LANE(batch->reference_root[a], lane) = problem->reference_root[3 * own + a];
    for (int64_t l = 0; l < problem->of.layers; l++)
        LANE(batch->layers[l].soft, lane) = problem->softness[problem->of.layers * at + l];
    for (int64_t t = 0; t < problem->of.tasks; t++) {
        const Task *task = problem->task + t;
        for (int64_t a = 0; a < task->width; a++)
            LANE(batch->targets[4 * t + a], lane) = problem->targets[task->targets + task->width * at + a];
    }
}

/* Write back what the columns of a lane have moved. */
static void store(const Batch *batch, int lane)
{
    const Problem *problem = batch->problem;
    const int64_t own = problem->frames[batch->at[lane]];
    double *local = problem->rotations + 4 * problem->of.joints * own;
    for (int64_t k = 0; k < problem->of.columns; k++) {
        const int64_t i = problem->column_node[k];
        for (int a = 0; a < 4; a++)
            local[4 * problem->node[i].joint + a] = LANE(batch->local[4 * i + a], lane);
    }
    if (problem->of.root >= 0) {
        const int64_t place = problem->of.translated * own + problem->node[problem->of.root].translation;
        for (int a = 0; a < 3; a++)
            problem->translations[3 * place + a] = LANE(batch->offsets[3 * problem->of.root + a], lane);
    }
}

static const V *parent_rotation(const Batch *batch, int64_t node)
{
    const int64_t parent = batch->problem->node[node].parent;
    return parent < 0 ? batch->identity : batch->rotations + 9 * parent;
}

static void set_identity(Batch *batch)
{
    for (int i = 0; i < 9; i++)
        batch->identity[i] = all(i % 4 == 0 ? 1.0 : 0.0);
}

/* The shares of subtrees in the body's mass. */
static void share_masses(Batch *batch)
{
    const Problem *problem = batch->problem;
    for (int64_t i = problem->of.nodes - 1; i >= 0; i--)
        batch->mass_shares[i] = 0.0;
    for (int64_t i = problem->of.nodes - 1; i >= 0; i--) {
        batch->mass_shares[i] += problem->node[i].share;
        if (problem->node[i].parent >= 0)
            batch->mass_shares[problem->node[i].parent] += batch->mass_shares[i];
    }
}

/* The moment (share times centre) of all mass at and below each node. */
static void weigh(Batch *batch)
{
    const Problem *problem = batch->problem;
    V *moments = batch->mass_moments;
    for (int64_t i = 0; i < problem->of.nodes; i++) {
        const Node *node = problem->node + i;
        V arm[3] = {all(0.0), all(0.0), all(0.0)};
        if (node->share != 0.0) {
            turned_plain(batch->rotations + 9 * i, node->center, arm);
            add(arm, batch->positions + 3 * i);
        }
        for (int a = 0; a < 3; a++)
            moments[3 * i + a] = node->share * arm[a];
    }
    for (int a = 0; a < 3; a++)
        batch->center[a] = all(0.0);
    for (int64_t i = problem->of.nodes - 1; i >= 0; i--) {
        const int64_t parent = problem->node[i].parent;
        add(parent >= 0 ? moments + 3 * parent : batch->center, moments + 3 * i);
    }
}

/* World transforms: p_j = p_parent + R_parent t_j, R_j = R_parent R_local. */
static void forward(Batch *batch)
{
    const Problem *problem = batch->problem;
    for (int64_t i = 0; i < problem->of.nodes; i++) {
        const int64_t parent = problem->node[i].parent;
        V *position = batch->positions + 3 * i, own[9];
        if (parent < 0) {
            memcpy(position, batch->offsets + 3 * i, 3 * sizeof *position);
            matrix_of(batch->local + 4 * i, batch->rotations + 9 * i);
            continue;
        }
        const V *above = batch->rotations + 9 * parent;
        turned(above, batch->offsets + 3 * i, position);
        add(position, batch->positions + 3 * parent);
        matrix_of(batch->local + 4 * i, own);
        matrix_product(above, own, batch->rotations + 9 * i);
    }
    if (batch->weighs)
        weigh(batch);
}

/* A node's world rotation as a quaternion: what orientations are compared by. */
static void world_quaternion(const Batch *batch, int64_t node, V *q)
{
    memcpy(q, batch->local + 4 * node, 4 * sizeof *q);
    for (int64_t i = batch->problem->node[node].parent; i >= 0; i = batch->problem->node[i].parent)
        q_multiply(batch->local + 4 * i, q, q);
}

/* The rotation vector from a local rotation to a target: log(q_target q^-1). */
static void turn_to(const V *target, const V *local, V *out)
{
    V inverse[4], turn[4];
    q_conjugate(local, inverse);
    q_multiply(target, inverse, turn);
    q_log(turn, out);
}

/* z: the world-axis increments that bring the columns back to the reference, of a hinge its angle, over their mobility. */
static void attraction(Batch *batch)
{
    const Problem *problem = batch->problem;
    V *root = batch->z + batch->unknowns - 3;
    const double shift = problem->mobility[problem->of.columns];
    for (int64_t k = 0; k < problem->of.columns; k++) {
        const int64_t i = problem->column_node[k];
        const int h = batch->column_hinge[k];
        V turn[3], *z = batch->z + batch->column_unknown[k];
        turn_to(batch->reference + 4 * k, batch->local + 4 * i, turn);
        for (int a = 0; a < 3; a++)
            turn[a] /= problem->mobility[k];
        if (batch->column_hinges[k] == 1) {
            z[0] = along(problem->hinge[h].axis, turn);
            continue;
        }
        V in_world[3];
        turned(parent_rotation(batch, i), turn, in_world);
        if (h < 0)
            memcpy(z, in_world, sizeof in_world);
        for (int j = 0; j < batch->column_hinges[k]; j++)
            z[j] = dot(batch->hinge_axes + 3 * (h + j), in_world);
    }
    root[0] = root[1] = root[2] = all(0.0);
    if (problem->pulls_root && problem->of.root >= 0) {
        V back[3];
        for (int a = 0; a < 3; a++)
            back[a] = batch->reference_root[a] - batch->offsets[3 * problem->of.root + a];
        const V most = all(problem->constants.largest_way_back);
        const V part = most / larger(root_of(dot(back, back)), most);
        for (int a = 0; a < 3; a++)
            back[a] = part * back[a] / shift;
        turned(parent_rotation(batch, problem->of.root), back, root);
    }
}

/* A hinge's angle (rad): about its axis a, from u to v, atan2(a . (u x v), u . v - (a . u) (a . v)). One without limits has
   none to look at. */
static V hinge_angle(const Hinge *hinge, const V *local)
{
    V R[9], moved[3], still[3], side[3], angle = all(0.0);
    if (hinge->limits[1] - hinge->limits[0] >= ALL_ROUND)
        return angle;
    matrix_of(local, R);
    for (int a = 0; a < 3; a++)
        still[a] = all(hinge->second ? hinge->lower[a] : hinge->upper[a]);
    if (hinge->second)
        for (int a = 0; a < 3; a++)
            moved[a] = R[a] * hinge->upper[0] + R[3 + a] * hinge->upper[1] + R[6 + a] * hinge->upper[2];
    else
        turned_plain(R, hinge->lower, moved);
    cross(hinge->second ? moved : still, hinge->second ? still : moved, side);
    const V sine = along(hinge->axis, side),
            cosine = dot(still, moved) - along(hinge->axis, still) * along(hinge->axis, moved);
    for (int lane = 0; lane < LANES; lane++)
        LANE(angle, lane) = atan2(LANE(sine, lane), LANE(cosine, lane));
    return angle;
}

/* The hinges' axes in the world (a turn about an axis leaves it where the parent has it; the second of two is where the
   joint itself has it) and angles (rad). */
static void hinge_state(Batch *batch)
{
    const Problem *problem = batch->problem;
    for (int64_t h = 0; h < problem->of.hinges; h++) {
        const Hinge *hinge = problem->hinge + h;
        const int64_t i = problem->column_node[hinge->column];
        turned_plain(hinge->second ? batch->rotations + 9 * i : parent_rotation(batch, i), hinge->axis,
            batch->hinge_axes + 3 * h);
        batch->hinge_angles[h] = hinge_angle(hinge, batch->local + 4 * i);
    }
}

/* Turn the columns by the step, q <- exp(R_parent^-1 w) q, and shift the root; returns the root's way. */
static V apply_step(Batch *batch)
{
    const Problem *problem = batch->problem;
    for (int64_t k = 0; k < problem->of.columns; k++) {
        const V *y = batch->step + batch->column_unknown[k];
        const int64_t i = problem->column_node[k];
        const int h = batch->column_hinge[k];
        V w[3], v[3], turn[4], *q = batch->local + 4 * i;
        for (int a = 0; a < (h < 0 ? 3 : batch->column_hinges[k]); a++)
            w[a] = problem->mobility[k] * y[a];
        if (h < 0)
            turned_back(parent_rotation(batch, i), w, v);
        else
            for (int a = 0; a < 3; a++)
                v[a] = problem->hinge[h].axis[a] * w[0];
        q_exp(v, turn);
        q_multiply(turn, q, turn);
        if (batch->column_hinges[k] == 2) {
            V own[4];
            for (int a = 0; a < 3; a++)
                v[a] = problem->hinge[h + 1].axis[a] * w[1];
            q_exp(v, own);
            q_multiply(turn, own, turn);
            v[0] += problem->hinge[h].axis[0] * w[0], v[1] += problem->hinge[h].axis[1] * w[0];
            v[2] += problem->hinge[h].axis[2] * w[0];
        }
        /* 1 / sqrt(1 + x) to second order: x is rounding */
        const V size = 1.5 - 0.5 * (turn[0] * turn[0] + dot(turn + 1, turn + 1));
        const Mask stays = is_zero(dot(v, v));
        for (int a = 0; a < 4; a++)
            q[a] = choose(stays, q[a], size * turn[a]);
    }
    V shift[3];
    for (int a = 0; a < 3; a++)
        shift[a] = problem->mobility[problem->of.columns] * batch->step[batch->unknowns - 3 + a];
    if (problem->of.root >= 0) {
        V own[3];
        turned_back(parent_rotation(batch, problem->of.root), shift, own);
        add(batch->offsets + 3 * problem->of.root, own);
    }
    return root_of(dot(shift, shift));
}
