/* One iteration of a batch: its pace, its step, and what is left of the errors: numpy_step.py and annealing.py. Part of
   solver.c. */

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
