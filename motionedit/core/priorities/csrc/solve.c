/* The iteration of a batch: numpy_solver.py and homing.py, each lane with its own frame. Part of solver.c. */

/* Metres and radians: what is less is rounding. */
#define AT_REST 1e-13

static V length(const V *v, int n)
{
    return root_of(dot_product(v, v, n));
}

/* Scratch of R numbers; layers.c uses the first two. */
static V *scratch(const Batch *batch, int which)
{
    return batch->scratch_rows + (2 + which) * batch->problem->of.rows;
}

/* Hinges on their limits take no part. */
static void without_fixed_hinges(const Batch *batch, V *v)
{
    for (int64_t h = 0; h < batch->problem->of.hinges; h++) {
        V *turn = hinge_turn(batch, v, h);
        *turn = only(batch->hinge_free[h], *turn);
    }
}

/* v <- v - Q^T q; q is used up. */
static void subtract_rank_space(const Batch *batch, V *q, V *v)
{
    V *y = scratch(batch, 0);
    out_of_rank_space(batch, q, y);
    for (int64_t r = 0; r < batch->problem->of.rows; r++)
        y[r] = -y[r];
    add_rows_transposed(batch, y, v);
}

/* v <- v P, what no layer sees: v - Q^T (Q v). Hinges on their limits take no part. */
static void off_layers(const Batch *batch, V *v)
{
    V *Jv = scratch(batch, 0), *q = scratch(batch, 1);
    without_fixed_hinges(batch, v);
    rows_times(batch, v, Jv);
    into_rank_space(batch, Jv, q);
    subtract_rank_space(batch, q, v);
}

/* home = z - Q^T (Q z), where Q z was found for the hinges that are free. */
static void pull_home(Batch *batch)
{
    V *q = scratch(batch, 1);
    memcpy(batch->home, batch->z, sizeof *batch->z * batch->unknowns);
    without_fixed_hinges(batch, batch->home);
    memcpy(q, batch->Qz, sizeof *q * batch->problem->of.rows);
    subtract_rank_space(batch, q, batch->home);
}

/* Q z with the hinges that are free, from J z with all of them: a hinge's part is its row times its turn. */
static void pull_in_rank_space(Batch *batch, const V *Jz)
{
    V *rest = scratch(batch, 0);
    memcpy(rest, Jz, sizeof *rest * batch->problem->of.rows);
    for (int64_t h = 0; h < batch->problem->of.hinges; h++)
        if (any(~batch->hinge_free[h]))
            add_hinge_row(batch, h, only(~batch->hinge_free[h], -*hinge_turn(batch, batch->z, h)), rest);
    into_rank_space(batch, rest, batch->Qz);
}

/* Where a turn takes a hinge (rad), and whether that is beyond its limits. */
static Mask beyond(const Batch *batch, int64_t h, V turn, V *limited)
{
    const Constants *constants = &batch->problem->constants;
    const Hinge *hinge = batch->problem->hinge + h;
    const V after = batch->hinge_angles[h] + turn;
    *limited = smaller(larger(after, all(hinge->limits[0])), all(hinge->limits[1]));
    return less(all(constants->on_limit), size_of(after - *limited)) & batch->hinge_free[h];
}

/* Set on their limits the hinges that gain z + J^T y would take beyond them; returns whether there were any. */
static int set_on_limits(Batch *batch, const V *y)
{
    const Problem *problem = batch->problem;
    int out = 0;
    for (int64_t h = 0; h < problem->of.hinges; h++) {
        V turn = batch->gain * *hinge_turn(batch, batch->z, h), limited;
        for (int i = 0; i < batch->hinge_felt_count[h]; i++) {
            const int r = batch->hinge_felt[h * problem->of.rows + i];
            turn += batch->hinge_rows[h * problem->of.rows + r] * y[r];
        }
        const Mask leaves = beyond(batch, h, turn, &limited);
        batch->hinge_fixed[h] = choose(leaves, limited - batch->hinge_angles[h], batch->hinge_fixed[h]);
        batch->hinge_free[h] &= ~leaves;
        out |= any(leaves);
    }
    return out;
}

/* Descend, and again with hinges that would leave their limits set on them; Q z and the step come out:

   step = fixed hinges + gain z + Q^T (c - gain Q z) = fixed hinges + gain z + J^T y */
static void descend_within_limits(Batch *batch)
{
    const Constants *constants = &batch->problem->constants;
    const Problem *problem = batch->problem;
    V *y = scratch(batch, 0), *q = scratch(batch, 1), *Jz = scratch(batch, 2), *step = batch->step;
    for (int64_t h = 0; h < problem->of.hinges; h++)
        batch->hinge_free[h] = everywhere(), batch->hinge_fixed[h] = all(0.0);
    rows_times(batch, batch->z, Jz);
    for (int round = 0;; round++) {
        descend(batch);
        pull_in_rank_space(batch, Jz);
        for (int64_t p = 0; p < problem->of.rows; p++)
            q[p] = batch->c[p] - batch->gain * batch->Qz[p];
        out_of_rank_space(batch, q, y);
        if (round == constants->limit_rounds || !set_on_limits(batch, y))
            break;
    }
    for (int i = 0; i < batch->unknowns; i++)
        step[i] = batch->gain * batch->z[i];
    add_rows_transposed(batch, y, step);
    for (int64_t h = 0; h < problem->of.hinges; h++)
        *hinge_turn(batch, step, h) += batch->hinge_fixed[h];
}

/* The length of Q^T c and the fixed hinges, which are orthogonal. */
static V task_length(const Batch *batch)
{
    const int64_t rows = batch->problem->of.rows, hinges = batch->problem->of.hinges;
    return root_of(
        dot_product(batch->c, batch->c, (int)rows) + dot_product(batch->hinge_fixed, batch->hinge_fixed, (int)hinges));
}

/* homing.py: a secant step for the pull where it applies and leaves every hinge within its limits. */
static void accelerate(Batch *batch, Mask usable, V task)
{
    const Constants *constants = &batch->problem->constants;
    const int n = batch->unknowns;
    V size = all(0.0), share = size;
    for (int i = 0; i < n; i++) {
        const V change = batch->home[i] - batch->home_before[i];
        size += change * change, share += batch->home[i] * change;
        batch->fast[i] = batch->step_before[i] + change;
    }
    const V home = length(batch->home, n);
    usable &= less(all(constants->no_change), size) & less(task, constants->largest_task_share * home);
    if (!any(usable))
        return;
    off_layers(batch, batch->fast);
    share /= choose(usable, size, all(1.0));
    for (int i = 0; i < n; i++)
        batch->fast[i] = batch->home[i] - share * batch->fast[i];
    const V factor = smaller(all(1.0), constants->largest_factor * home / larger(length(batch->fast, n), all(1e-300)));
    /* step + gain (fast - home) */
    for (int i = 0; i < n; i++)
        batch->fast[i] = batch->step[i] + batch->gain * (factor * batch->fast[i] - batch->home[i]);
    for (int64_t h = 0; h < batch->problem->of.hinges; h++) {
        V limited;
        usable &= ~beyond(batch, h, *hinge_turn(batch, batch->fast, h), &limited);
    }
    for (int i = 0; i < n; i++)
        batch->step[i] = choose(usable, batch->fast[i], batch->step[i]);
}

/* Scale the step so that no joint turns further than the largest allowed; returns the largest turn. */
static V bound_turns(Batch *batch)
{
    const Constants *constants = &batch->problem->constants;
    V largest = all(0.0);
    for (int64_t k = 0; k < batch->problem->of.columns; k++) {
        const V *w = batch->step + batch->column_unknown[k];
        const int hinges = batch->column_hinges[k];
        largest = larger(largest, hinges == 0 ? dot(w, w) : w[0] * w[0] + (hinges == 2 ? w[1] * w[1] : all(0.0)));
    }
    largest = root_of(largest);
    if (!any(less(all(constants->largest_turn), largest)))
        return largest;
    const V factor = constants->largest_turn / larger(largest, all(constants->largest_turn));
    for (int i = 0; i < batch->unknowns; i++)
        batch->step[i] *= factor;
    return smaller(largest, all(constants->largest_turn));
}

/* Remember the pull and the step where the next iteration may compare with them: see homing.py. */
static void remember(Batch *batch, V task, int has_home)
{
    const Constants *constants = &batch->problem->constants;
    const size_t n = batch->unknowns, hinges = batch->problem->of.hinges;
    batch->remembers = less(task, constants->largest_task_share * length(batch->step, (int)n));
    if (!any(batch->remembers))
        return;
    if (!has_home)
        pull_home(batch);
    memcpy(batch->home_before, batch->home, sizeof *batch->home * n);
    memcpy(batch->step_before, batch->step, sizeof *batch->step * n);
    memcpy(batch->hinge_free_before, batch->hinge_free, sizeof *batch->hinge_free * hinges);
}

/* Which lanes meet every layer. */
static Mask are_met(const Batch *batch)
{
    const Constants *constants = &batch->problem->constants;
    Mask met = everywhere();
    for (int l = 0; l < batch->problem->of.layers; l++)
        met &= less(length(batch->errors + batch->layers[l].first, batch->layers[l].rows), all(constants->stop_error));
    return met;
}

/* Rounding is no error and no pull. */
static void drop_rounding(Batch *batch)
{
    const int rows = (int)batch->problem->of.rows;
    const Mask pulls = less(all(AT_REST), length(batch->z, batch->unknowns));
    const Mask errs = less(all(AT_REST), length(batch->errors, rows)) | pulls;
    for (int i = 0; i < batch->unknowns; i++)
        batch->z[i] = only(pulls, batch->z[i]);
    for (int r = 0; r < rows; r++)
        batch->errors[r] = only(errs, batch->errors[r]);
}

/* Give a lane frame `at`, or none: -1. */
static void begin_frame(Batch *batch, int lane, int64_t at)
{
    batch->at[lane] = at, batch->iteration[lane] = 0;
    MASK_LANE(batch->nearly, lane) = MASK_LANE(batch->remembers, lane) = 0;
    LANE(batch->moved_before, lane) = 0.0;
    if (at >= 0)
        load(batch, lane, at);
}

static void end_frame(Batch *batch, int lane, int converged)
{
    const Problem *problem = batch->problem;
    const int64_t at = batch->at[lane];
    problem->converged[at] = (uint8_t)converged, problem->iterations[at] = batch->iteration[lane];
    for (int l = 0; l < problem->of.layers; l++)
        problem->ranks[at * problem->of.layers + l] = (int64_t)LANE(batch->layers[l].rank, lane);
    store(batch, lane);
}

/* How each lane goes about its iteration. */
static void set_pace(Batch *batch)
{
    const Constants *constants = &batch->problem->constants;
    const Problem *problem = batch->problem;
    for (int lane = 0; lane < LANES; lane++) {
        const int64_t iteration = batch->iteration[lane];
        const int64_t left_over = problem->of.max_iterations - constants->annealed_iterations - iteration - 1;
        LANE(batch->anneal, lane) = left_over < 0 ? ldexp(1.0, (int)left_over) : 1.0;
        LANE(batch->gain, lane) = problem->of.attraction * LANE(batch->anneal, lane);
        for (int64_t i = constants->full_gain_iterations; i < iteration + 1; i++)
            LANE(batch->gain, lane) *= constants->gain_decay;
        MASK_LANE(batch->steady, lane) = iteration >= constants->hasty_iterations ? -1 : 0;
    }
}

/* One iteration of every lane: what it moves. */
static V iterate(Batch *batch)
{
    const Problem *problem = batch->problem;
    set_pace(batch);
    attraction(batch);
    drop_rounding(batch);
    gram(batch);
    descend_within_limits(batch);
    const V task = task_length(batch);
    Mask compares = batch->remembers;
    for (int64_t h = 0; h < problem->of.hinges; h++)
        compares &= ~(batch->hinge_free[h] ^ batch->hinge_free_before[h]);
    const int compare = any(compares);
    if (compare) {
        pull_home(batch);
        accelerate(batch, compares, task);
    }
    const V largest = bound_turns(batch);
    remember(batch, task, compare);
    return larger(largest, apply_step(batch));
}

/* eq. (4): what the columns move starts where the frame before ended. */
static void start_where_the_last_ended(const Problem *problem, int64_t at)
{
    at = problem->frames[at];
    double *here = problem->rotations + 4 * problem->of.joints * at;
    for (int64_t k = 0; k < problem->of.columns; k++) {
        const int64_t joint = problem->node[problem->column_node[k]].joint;
        memcpy(here + 4 * joint, here + 4 * (joint - problem->of.joints), 4 * sizeof *here);
    }
    if (problem->of.moves_root && problem->of.root >= 0) {
        const int64_t place = problem->node[problem->of.root].translation;
        double *root = problem->translations + 3 * (problem->of.translated * at + place);
        memcpy(root, root - 3 * problem->of.translated, 3 * sizeof *root);
    }
}

/* Fill the lanes that have no frame, from frame `next` on, as long as there are any; returns which is next then. In
   order, one goes at a time. */
static int64_t fill(Batch *batch, int64_t next, int64_t end)
{
    const Problem *problem = batch->problem;
    for (int lane = 0; lane < (problem->in_order ? 1 : LANES); lane++) {
        while (next < end && problem->converged[next])
            next++;
        if (batch->at[lane] >= 0 || next == end)
            continue;
        if (problem->in_order && next > 0)
            start_where_the_last_ended(problem, next);
        begin_frame(batch, lane, next++);
    }
    return next;
}

static int active(const Batch *batch)
{
    int count = 0;
    for (int lane = 0; lane < LANES; lane++)
        count += batch->at[lane] >= 0;
    return count;
}

/* End the frames that turn out to be met, or have had all their iterations. */
static void end_before_iterating(Batch *batch)
{
    const Mask met = any(batch->nearly) ? batch->nearly & are_met(batch) : batch->nearly;
    for (int lane = 0; lane < LANES; lane++)
        if (batch->at[lane] >= 0 &&
            (MASK_LANE(met, lane) || batch->iteration[lane] == batch->problem->of.max_iterations)) {
            end_frame(batch, lane, MASK_LANE(met, lane) != 0);
            batch->at[lane] = -1;
        }
}

/* End the frames whose last step was short enough; expect that of others. */
static void end_after_iterating(Batch *batch, V moved)
{
    const Constants *constants = &batch->problem->constants;
    const V ratio = moved / larger(batch->moved_before, all(1e-300));
    batch->nearly =
        less(ratio, all(constants->largest_ratio)) & less(moved * ratio, constants->stop_left * (1.0 - ratio));
    batch->moved_before = moved;
    for (int lane = 0; lane < LANES; lane++) {
        batch->iteration[lane] += batch->at[lane] >= 0;
        if (batch->at[lane] >= 0 && LANE(moved, lane) < constants->stop_step) {
            end_frame(batch, lane, 1);
            batch->at[lane] = -1;
        }
    }
}

int solve_frames(const Problem *problem, int64_t begin, int64_t end)
{
    Batch batch = {.problem = problem};
    if (begin == end)
        return 0;
    char *memory = malloc(lay_out(&batch, NULL) + sizeof(V));
    if (memory == NULL)
        return -1;
    lay_out(&batch, memory + sizeof(V) - (uintptr_t)memory % sizeof(V));
    share_masses(&batch);
    for (int lane = 0; lane < LANES; lane++) {
        load(&batch, lane, begin); /* so that a lane without a frame has numbers, too */
        begin_frame(&batch, lane, -1);
    }
    for (int64_t next = begin;;) {
        next = fill(&batch, next, end);
        const int count = active(&batch);
        if (count == 0)
            break;
        forward(&batch);
        hinge_state(&batch);
        evaluate_tasks(&batch);
        end_before_iterating(&batch);
        const int left = active(&batch);
        if (left == 0 || (left < count && next < end))
            continue;
        end_after_iterating(&batch, iterate(&batch));
    }
    free(memory);
    return 0;
}
