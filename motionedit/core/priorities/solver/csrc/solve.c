/* Frames that come into lanes, iterate there and leave: numpy_solver.py, each lane with its own frame. Part of solver.c. */

/* Nothing is known of a lane's iterations yet. */
static void begin_iterating(Batch *batch, int lane)
{
    const Problem *problem = batch->problem;
    batch->iteration[lane] = 0;
    batch->annealed_from[lane] = problem->of.max_iterations - problem->constants.annealed_iterations;
    LANE(batch->moved_before, lane) = LANE(batch->stale, lane) = 0.0;
    MASK_LANE(batch->nearly, lane) = MASK_LANE(batch->remembers, lane) = 0;
    for (int64_t r = 0; r < batch->rows; r++)
        MASK_LANE(batch->active_before[r], lane) = 0;
    for (int64_t l = 0; l < problem->of.layers; l++)
        LANE(batch->layers[l].error, lane) = 0.0;
}

/* Give a lane frame `at`, or none: -1. */
static void begin_frame(Batch *batch, int lane, int64_t at)
{
    batch->at[lane] = at;
    begin_iterating(batch, lane);
    MASK_LANE(batch->limited, lane) = 0, batch->before_limits[lane] = 0;
    if (at >= 0)
        load(batch, lane, at);
}

/* The largest error of any row of a task, its weight taken off. */
static double largest_left(const Batch *batch, int lane, int64_t t)
{
    const Task *task = batch->problem->task + t;
    const Pull *pull = batch->pulls + t;
    const V *errors = (pull->rows > 0 ? batch->errors : batch->held_errors) + pull->first_row;
    double left = 0.0;
    for (int64_t r = 0; r < task->rows; r++) {
        const double error = LANE(errors[r], lane) / task->weight;
        left = fmax(left, task->one_sided ? error : fabs(error));
    }
    return left;
}

/* Whether all layers that do not give way are met. */
static int is_met_without_limits(const Batch *batch, int lane)
{
    const Problem *problem = batch->problem;
    for (int64_t t = 0; t < problem->of.tasks; t++)
        if (LANE(batch->layers[problem->task[t].layer].soft, lane) == 0.0 &&
            largest_left(batch, lane, t) > problem->constants.met_without_limits)
            return 0;
    return 1;
}

/* Solve a frame on with limits, if it is solved without them and beyond any; returns whether it is. */
static int goes_on_with_limits(Batch *batch, int lane)
{
    if (batch->problem->of.limits == 0 || batch->holds || MASK_LANE(batch->limited, lane) || !is_beyond(batch, lane) ||
        !is_met_without_limits(batch, lane))
        return 0;
    batch->before_limits[lane] = batch->iteration[lane];
    begin_iterating(batch, lane);
    MASK_LANE(batch->limited, lane) = -1;
    return 1;
}

static void end_frame(Batch *batch, int lane, int converged)
{
    const Problem *problem = batch->problem;
    const int64_t at = problem->frames[batch->at[lane]];
    int64_t *ranks = problem->ranks + at * problem->levels;
    double *left = problem->left + at * problem->levels;
    problem->converged[at] = (uint8_t)converged;
    problem->iterations[at] = batch->before_limits[lane] + batch->iteration[lane];
    memset(ranks, 0, sizeof *ranks * problem->levels);
    memset(left, 0, sizeof *left * problem->levels);
    for (int64_t l = 0; l < problem->of.layers; l++)
        ranks[problem->level[l]] += (int64_t)LANE(batch->layers[l].rank, lane);
    for (int64_t t = 0; t < problem->of.tasks; t++) {
        const int64_t level = problem->level[problem->task[t].layer];
        left[level] = fmax(left[level], largest_left(batch, lane, t));
    }
    store(batch, lane);
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
        while (next < end && problem->converged[problem->frames[next]])
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

/* Whether a lane's frame has had all its iterations. What gives way comes to rest slowly: it is not waited for. */
static int is_over(const Batch *batch, int lane)
{
    const Problem *problem = batch->problem;
    const int64_t iteration = batch->iteration[lane];
    if (iteration == problem->of.max_iterations)
        return 1;
    if (iteration != batch->annealed_from[lane] + problem->constants.annealed_iterations)
        return 0;
    for (int64_t l = 0; l < problem->of.layers; l++)
        if (LANE(batch->layers[l].soft, lane) > 0.0)
            return 1;
    return 0;
}

/* End the frames that turn out to be met, or have had all their iterations. */
static void end_before_iterating(Batch *batch)
{
    const Mask met = any(batch->nearly) ? batch->nearly & are_met(batch) : batch->nearly;
    for (int lane = 0; lane < LANES; lane++)
        if (batch->at[lane] >= 0 && (MASK_LANE(met, lane) || is_over(batch, lane)) &&
            !goes_on_with_limits(batch, lane)) {
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
        if (batch->at[lane] >= 0 && LANE(moved, lane) < constants->stop_step && !goes_on_with_limits(batch, lane)) {
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
    set_identity(&batch);
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
