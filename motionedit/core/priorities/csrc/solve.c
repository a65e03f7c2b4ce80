/* The iteration of a batch: numpy_solver.py and homing.py, each lane with its own frame. Part of solver.c. */

/* Scale the step so that no joint turns further than the largest allowed; returns the largest turn. */
static V bound_turns(Batch *batch)
{
    const Constants *constants = &batch->problem->constants;
    V largest = all(0.0);
    for (int64_t k = 0; k < batch->problem->of.columns; k++) {
        const V *w = batch->step + batch->column_unknown[k];
        const int hinges = batch->column_hinges[k];
        const V squares = hinges == 0 ? dot(w, w) : w[0] * w[0] + (hinges == 2 ? w[1] * w[1] : all(0.0));
        largest = larger(largest, squared(batch->problem->mobility[k]) * squares);
    }
    largest = root_of(largest);
    if (!any(less(all(constants->largest_turn), largest)))
        return largest;
    const V factor = constants->largest_turn / larger(largest, all(constants->largest_turn));
    for (int i = 0; i < batch->unknowns; i++)
        batch->step[i] *= factor;
    return smaller(largest, all(constants->largest_turn));
}

/* What is left of the errors, shape (R,): nothing of one-sided rows that are on the right side. */
static const V *left_errors(const Batch *batch)
{
    V *left = scratch(batch, 3);
    if (batch->sided == 0)
        return batch->errors;
    memcpy(left, batch->errors, sizeof *left * batch->rows);
    for (int i = 0; i < batch->sided; i++)
        left[batch->sided_row[i]] = larger(left[batch->sided_row[i]], all(0.0));
    return left;
}

/* Which lanes meet every layer. */
static Mask are_met(const Batch *batch)
{
    const Constants *constants = &batch->problem->constants;
    const V *left = left_errors(batch);
    Mask met = everywhere();
    for (int l = 0; l < batch->problem->of.layers; l++)
        if (batch->layers[l].held > 0) {
            const V *held = batch->held_errors + batch->layers[l].joints[0].error;
            met &= less(length(held, 3 * batch->layers[l].held), all(constants->stop_error));
        } else
            met &= less(length(left + batch->layers[l].first, batch->layers[l].rows), all(constants->stop_error));
    return met;
}

/* Rounding is no error and no pull; one-sided rows, none of which takes part yet, keep what they have. */
static void drop_rounding(Batch *batch)
{
    const int rows = (int)batch->rows;
    const Mask pulls = less(all(AT_REST), length(batch->z, batch->unknowns));
    const V held = length(batch->held_errors, 3 * batch->held);
    const Mask errs = less(all(AT_REST), length(left_errors(batch), rows)) | less(all(AT_REST), held) | pulls;
    for (int r = 0; r < 3 * batch->held; r++)
        batch->held_errors[r] = only(errs, batch->held_errors[r]);
    for (int i = 0; i < batch->unknowns; i++)
        batch->z[i] = only(pulls, batch->z[i]);
    for (int r = 0; r < rows; r++)
        batch->errors[r] = only(errs | ~batch->active[r], batch->errors[r]);
}

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

/* Count the iterations in which what is missed stays so, in lanes that are watched: annealing.py. */
static void watch_errors(Batch *batch, Mask watched)
{
    if (!any(watched) || !batch->problem->of.ends_early) {
        batch->stale = all(0.0);
        return;
    }
    const Constants *constants = &batch->problem->constants;
    const double same = constants->same_error;
    const V *left = left_errors(batch);
    Mask missed = ~everywhere(), soft = missed, decided = missed, changes = missed, soft_changes = missed;
    for (int l = 0; l < batch->problem->of.layers; l++) {
        Layer *layer = batch->layers + l;
        const V size = layer->held > 0 ? length(batch->held_errors + layer->joints[0].error, 3 * layer->held)
                                       : length(left + layer->first, layer->rows);
        const Mask far = less(all(constants->met_without_limits), size), gives_way = less(all(0.0), layer->soft);
        const Mask here = far & ~gives_way & ~decided, here_soft = far & gives_way;
        const Mask differs = less(size, same * layer->error) | less(layer->error, same * size);
        const Mask changed = here & (differs | less(size, all(constants->far_error)));
        layer->error = choose(watched & (changed | (here_soft & differs)), size, layer->error);
        missed |= here, soft |= here_soft, soft_changes |= here_soft & differs;
        decided |= l == 0 ? here & ~changed : here, changes |= l == 0 ? ~everywhere() : changed;
    }
    const Mask stays = (decided & ~changes) | (soft & ~soft_changes & ~missed);
    batch->stale = only(batch->steady & ~batch->limited & stays, batch->stale + 1.0);
}

/* How each lane goes about its iteration. */
static void set_pace(Batch *batch)
{
    const Constants *constants = &batch->problem->constants;
    const Problem *problem = batch->problem;
    Mask watched = ~everywhere();
    for (int lane = 0; lane < LANES; lane++) {
        const int64_t hasty = constants->hasty_iterations - batch->iteration[lane];
        MASK_LANE(batch->steady, lane) = hasty <= 0 ? -1 : 0;
        MASK_LANE(watched, lane) = hasty <= 1 ? -1 : 0;
    }
    watch_errors(batch, watched);
    for (int lane = 0; lane < LANES; lane++) {
        const int64_t iteration = batch->iteration[lane];
        if (LANE(batch->stale, lane) >= (double)constants->stale_iterations && iteration < batch->annealed_from[lane])
            batch->annealed_from[lane] = iteration;
        const int64_t left_over = batch->annealed_from[lane] - iteration - 1;
        LANE(batch->anneal, lane) = left_over < 0 ? ldexp(1.0, 2 * (int)left_over) : 1.0;
        LANE(batch->gain, lane) = problem->of.attraction * LANE(batch->anneal, lane);
        for (int64_t i = constants->full_gain_iterations; i < iteration + 1; i++)
            LANE(batch->gain, lane) *= constants->gain_decay;
    }
}

/* One iteration of every lane: what it moves. */
static V iterate(Batch *batch)
{
    const Problem *problem = batch->problem;
    set_pace(batch);
    if (keeps_limits(batch))
        cone_state(batch);
    attraction(batch);
    for (int i = 0; i < batch->sided; i++)
        batch->active[batch->sided_row[i]] = ~everywhere();
    drop_rounding(batch);
    gram(batch);
    if (batch->holds)
        form_rows(batch);
    descend_within_limits(batch);
    const V task = task_length(batch);
    Mask compares = batch->remembers;
    for (int64_t h = 0; h < problem->of.hinges; h++)
        compares &= ~(batch->hinge_free[h] ^ batch->hinge_free_before[h]);
    for (int i = 0; i < batch->sided; i++) {
        const int r = batch->sided_row[i];
        compares &= ~(batch->active[r] ^ batch->active_before[r]);
        batch->active_before[r] = batch->active[r];
    }
    for (int64_t cone = 0; cone < cones(batch); cone++) {
        compares &= ~(batch->cone_on[cone] ^ batch->cone_before[cone]);
        batch->cone_before[cone] = batch->cone_on[cone];
    }
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
