/* Limits of columns that turn about any axis: cones.py. A cone that is on its limit is a direction of its column that
   takes no part: a rank-one part of G less, as for a hinge. Part of solver.c. */

/* Radians. */
#define TURN 6.28318530717958647692

static int64_t cones(const Batch *batch)
{
    return 2 * batch->problem->of.limits;
}

static int keeps_limits(const Batch *batch)
{
    return batch->problem->of.limits > 0 && any(batch->limited);
}

static const Limit *limit_of(const Batch *batch, int64_t cone)
{
    return batch->problem->limit + cone / 2;
}

static double cone_mobility(const Batch *batch, int64_t cone)
{
    return batch->problem->mobility[limit_of(batch, cone)->column];
}

/* The unknowns of a cone's column. */
static V *cone_column(const Batch *batch, V *v, int64_t cone)
{
    return v + batch->column_unknown[limit_of(batch, cone)->column];
}

/* What a step's turn over its mobility has along a cone's direction. */
static V cone_turn(const Batch *batch, V *v, int64_t cone)
{
    return dot(batch->cone_turns + 3 * cone, cone_column(batch, v, cone));
}

/* A rotation from a limit's middle: q_c^-1 q. */
static void from_middle(const Limit *limit, const V *local, V *turn)
{
    const V inverse[4] = {
        all(limit->center[0]), all(-limit->center[1]), all(-limit->center[2]), all(-limit->center[3])};
    q_multiply(inverse, local, turn);
}

/* How far a rotation from the middle twists about the bone, rad, in one lane. */
static double twist_of(const Limit *limit, const V *turn, int lane)
{
    const double along = limit->along[0] * LANE(turn[1], lane) + limit->along[1] * LANE(turn[2], lane) +
                         limit->along[2] * LANE(turn[3], lane);
    const double twist = 2.0 * atan2(along, LANE(turn[0], lane));
    return twist - TURN * floor((twist + 0.5 * TURN) / TURN);
}

/* How far it swings the bone. */
static double swing_of(const Limit *limit, const V *turn, int lane)
{
    V R[9], turned[3];
    matrix_of(turn, R);
    turned_plain(R, limit->along, turned);
    const double x = LANE(turned[0], lane), y = LANE(turned[1], lane), z = LANE(turned[2], lane);
    const double *v = limit->along;
    const double a = v[1] * z - v[2] * y, b = v[2] * x - v[0] * z, c = v[0] * y - v[1] * x;
    return atan2(sqrt(a * a + b * b + c * c), v[0] * x + v[1] * y + v[2] * z);
}

/* Whether a lane is beyond any limit. */
static int is_beyond(const Batch *batch, int lane)
{
    const Problem *problem = batch->problem;
    for (int64_t c = 0; c < problem->of.limits; c++) {
        const Limit *limit = problem->limit + c;
        V turn[4];
        from_middle(limit, batch->local + 4 * problem->column_node[limit->column], turn);
        if (fabs(LANE(turn[0], lane)) > limit->least)
            continue;
        const double margin = problem->constants.beyond_limit;
        if (swing_of(limit, turn, lane) > limit->halves[0] + margin ||
            fabs(twist_of(limit, turn, lane)) > limit->halves[1] + margin)
            return 1;
    }
    return 0;
}

/* Directions and values of all cones, none of which is on its limit. */
static void cone_state(Batch *batch)
{
    const Problem *problem = batch->problem;
    const V nearly_none = all(problem->constants.no_direction);
    for (int64_t c = 0; c < problem->of.limits; c++) {
        const Limit *limit = problem->limit + c;
        const int64_t node = problem->column_node[limit->column];
        V bone[3], middle[3], turn[4], *swing = batch->cone_turns + 6 * c, *twist = swing + 3;
        turned_plain(batch->rotations + 9 * node, limit->along, bone);
        turned_plain(parent_rotation(batch, node), limit->middle, middle);
        cross(middle, bone, swing);
        const V across = root_of(dot(swing, swing));
        for (int a = 0; a < 3; a++) {
            swing[a] = only(less(nearly_none, across), swing[a] / larger(across, nearly_none));
            twist[a] = bone[a] + middle[a];
        }
        const V both = larger(root_of(dot(twist, twist)), nearly_none);
        for (int a = 0; a < 3; a++)
            twist[a] /= both;
        batch->cone_rates[2 * c] = all(1.0), batch->cone_rates[2 * c + 1] = 2.0 / both;
        from_middle(limit, batch->local + 4 * node, turn);
        for (int lane = 0; lane < LANES; lane++) {
            LANE(batch->cone_values[2 * c], lane) = swing_of(limit, turn, lane);
            LANE(batch->cone_values[2 * c + 1], lane) = twist_of(limit, turn, lane);
        }
    }
}

/* What the rows have along a cone's direction. */
static void find_cone_rows(Batch *batch, int64_t cone)
{
    const Problem *problem = batch->problem;
    const int64_t column = limit_of(batch, cone)->column;
    const V *axis = batch->cone_turns + 3 * cone;
    V *out = batch->cone_rows + cone * batch->rows;
    for (int64_t r = 0; r < batch->rows; r++)
        out[r] = all(0.0);
    for (int64_t t = 0; t < problem->of.tasks; t++) {
        const Pull *pull = batch->pulls + t;
        for (int p = 0; p < pull->parts; p++) {
            const Part *part = pull->part + p;
            for (int i = 0; i < part->count; i++) {
                if (part->columns[i] != column)
                    continue;
                V lever[3];
                cross(axis, part->levers + 3 * i, lever);
                for (int r = 0; r < pull->rows; r++)
                    out[pull->first_row + r] +=
                        dot(part->force[r], lever) + problem->mobility[column] * dot(part->torque[r], axis);
            }
        }
    }
}

/* Where a step takes a cone, and by how much that is beyond its limit, rad. */
static V beyond_cone(const Batch *batch, V *step, int64_t cone, V *after)
{
    *after =
        batch->cone_values[cone] + batch->cone_rates[cone] * cone_mobility(batch, cone) * cone_turn(batch, step, cone);
    return size_of(*after) - limit_of(batch, cone)->halves[cone % 2];
}

/* Set the cones on their limits that a step would take beyond them; returns whether there were any. */
static int set_on_cones(Batch *batch, V *step)
{
    int found = 0;
    for (int64_t cone = 0; cone < cones(batch); cone++) {
        V after;
        const Mask leaves = less(all(batch->problem->constants.on_limit), beyond_cone(batch, step, cone, &after)) &
                            ~batch->cone_on[cone] & batch->limited;
        if (!any(leaves))
            continue;
        const V half = all(limit_of(batch, cone)->halves[cone % 2]);
        const V onto = choose(less(after, all(0.0)), -half, half) - batch->cone_values[cone];
        if (!any(batch->cone_on[cone]))
            find_cone_rows(batch, cone);
        batch->cone_fixed[cone] =
            choose(leaves, onto / (batch->cone_rates[cone] * cone_mobility(batch, cone)), batch->cone_fixed[cone]);
        batch->cone_on[cone] |= leaves;
        found = 1;
    }
    return found;
}

/* Whether a step leaves all cones within their limits. */
static Mask within_cones(const Batch *batch, V *step)
{
    Mask within = everywhere();
    for (int64_t cone = 0; cone < cones(batch) && keeps_limits(batch); cone++) {
        V after;
        within &= ~less(all(batch->problem->constants.on_limit), beyond_cone(batch, step, cone, &after)) |
                  batch->cone_on[cone] | ~batch->limited;
    }
    return within;
}

static void no_cones_on(Batch *batch)
{
    for (int64_t cone = 0; cone < cones(batch); cone++)
        batch->cone_on[cone] = ~everywhere(), batch->cone_fixed[cone] = all(0.0);
}

/* v less what it has along the cones that are on their limits. */
static void off_cones(const Batch *batch, V *v)
{
    for (int64_t cone = 0; cone < cones(batch); cone++)
        if (any(batch->cone_on[cone]))
            add_scaled(cone_column(batch, v, cone), only(batch->cone_on[cone], -cone_turn(batch, v, cone)),
                batch->cone_turns + 3 * cone);
}

/* v and the turns that set cones on their limits. */
static void add_cones(const Batch *batch, V *v)
{
    for (int64_t cone = 0; cone < cones(batch); cone++)
        if (any(batch->cone_on[cone]))
            add_scaled(cone_column(batch, v, cone), batch->cone_fixed[cone], batch->cone_turns + 3 * cone);
}

/* out += factor times what the rows have along a cone, shape (R,). */
static void add_cone_row(const Batch *batch, int64_t cone, V factor, V *out)
{
    const int64_t R = batch->rows;
    for (int64_t r = 0; r < R; r++)
        out[r] += factor * batch->cone_rows[cone * R + r];
}

/* G less a cone's rank-one part. */
static void take_cone(const Batch *batch, int64_t cone, V *G)
{
    const int64_t R = batch->rows;
    const V *rows = batch->cone_rows + cone * R;
    for (int64_t r = 0; r < R; r++) {
        const V scaled = only(batch->cone_on[cone], rows[r]);
        for (int64_t s = 0; s <= r; s++)
            G[r * R + s] -= scaled * rows[s];
    }
}
