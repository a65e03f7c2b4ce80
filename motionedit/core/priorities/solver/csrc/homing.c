/* The pull back to the reference, accelerated: see homing.py. Part of solver.c. */

/* home = z - Q^T (Q z), where Q z was found for the hinges that are free. */
static void pull_home(Batch *batch)
{
    V *q = scratch(batch, 1);
    memcpy(batch->home, batch->z, sizeof *batch->z * batch->unknowns);
    without_fixed(batch, batch->home);
    memcpy(q, batch->Qz, sizeof *q * batch->rows);
    subtract_rank_space(batch, q, batch->home);
}

/* homing.py: a secant step for the pull where it applies, leaves every hinge within its limits and violates no row. */
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
    if (batch->sided > 0)
        rows_times(batch, batch->fast, scratch(batch, 3));
    for (int i = 0; i < batch->sided; i++)
        usable &= is_zero(lack(batch, i, scratch(batch, 3)));
    usable &= within_cones(batch, batch->fast);
    for (int i = 0; i < n; i++)
        batch->step[i] = choose(usable, batch->fast[i], batch->step[i]);
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
