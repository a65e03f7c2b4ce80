/* A batch's memory: its layers, its unknowns, and room for all that a frame needs. Part of solver.c. */

static int hinges_on(const Problem *problem, int64_t column)
{
    int count = 0;
    for (int64_t h = 0; h < problem->of.hinges; h++)
        count += problem->hinge[h].column == column;
    return count;
}

/* So few joints are rows as others are: to take them out costs more. */
#define FEW_JOINTS 8

/* How many joints a layer holds: 0 where it is anything else but joints, each once and with one hinge at most, or few. */
static int joints_held(const Problem *problem, int64_t layer)
{
    int count = 0;
    for (int64_t t = 0; t < problem->of.tasks; t++) {
        const Task *task = problem->task + t;
        if (task->layer != layer)
            continue;
        if (!ROW_KINDS[task->kind].is.holds || task->one_sided || task->base >= 0)
            return 0;
        const int64_t column = problem->node[task->node].column;
        if (column < 0 || !recruited(problem, task)[column] || hinges_on(problem, column) > 1)
            return 0;
        for (int64_t s = 0; s < t; s++)
            if (problem->task[s].layer == layer && problem->task[s].node == task->node)
                return 0;
        count++;
    }
    return count < FEW_JOINTS ? 0 : count;
}

/* The joints that a layer holds, whose tasks these are. */
static void lay_out_held(Batch *batch, int l, const Task *task, int error)
{
    const Problem *problem = batch->problem;
    Layer *layer = batch->layers + l;
    for (int j = 0; j < layer->held; j++, error += 3) {
        const int column = (int)problem->node[task[j].node].column, h = batch->column_hinge[column];
        const int first = batch->column_unknown[column], count = h < 0 ? 3 : 1;
        const double scale = task[j].weight * problem->constants.metres_per_radian * problem->mobility[column];
        layer->joints[j] = (Held){first, count, h, error, batch->holder[first] >= 0, scale};
        for (int a = 0; a < count && !layer->joints[j].again; a++)
            batch->holder[first + a] = l;
    }
}

static void lay_out_layers(Batch *batch, char **memory, size_t *needed)
{
    const Problem *problem = batch->problem;
    batch->layers = take(memory, needed, sizeof *batch->layers * problem->of.layers);
    batch->chain = take(memory, needed, sizeof *batch->chain * (problem->of.layers + 1));
    for (int64_t l = 0, t = 0, first = 0, error = 0; l < problem->of.layers; l++) {
        const int64_t begin = t, held = joints_held(problem, l);
        int rows = 0;
        for (; t < problem->of.tasks && problem->task[t].layer == l; t++)
            rows += held > 0 ? 0 : (int)problem->task[t].rows;
        V *B = take(memory, needed, sizeof *B * rows * rows);
        Held *joints = take(memory, needed, sizeof *joints * held);
        Layer *above = take(memory, needed, held > 0 ? sizeof *above : 0);
        V *B_above = take(memory, needed, held > 0 ? sizeof *B * first * first : 0);
        if (batch->layers != NULL) {
            batch->layers[l] = (Layer){.first = (int)first,
                .rows = rows,
                .B = B,
                .rank = all(0.0),
                .soft = all(0.0),
                .held = (int)held,
                .joints = joints,
                .above = held > 0 ? above : NULL};
            if (held > 0)
                *above = (Layer){.rows = (int)first, .B = B_above, .rank = all(0.0), .soft = all(0.0)};
            lay_out_held(batch, (int)l, problem->task + begin, (int)error);
        }
        first += rows, error += 3 * held;
    }
}

/* How many joints layers hold, and how many rows the others have. */
static void count_rows(Batch *batch)
{
    const Problem *problem = batch->problem;
    batch->held = 0;
    for (int64_t l = 0; l < problem->of.layers; l++)
        batch->held += joints_held(problem, l);
    batch->rows = (int)problem->of.rows - 3 * batch->held;
    batch->holds = batch->held > 0;
}

/* A column's hinges, and its first unknown: a hinge has one, columns without have three. */
static void number_unknowns(Batch *batch)
{
    const Problem *problem = batch->problem;
    for (int64_t k = 0; k < problem->of.columns; k++)
        batch->column_hinge[k] = -1, batch->column_hinges[k] = 0;
    for (int64_t h = problem->of.hinges - 1; h >= 0; h--) {
        batch->column_hinge[problem->hinge[h].column] = (int)h;
        batch->column_hinges[problem->hinge[h].column]++;
    }
    for (int64_t k = 0, unknown = 0; k < problem->of.columns; k++) {
        batch->column_unknown[k] = (int)unknown;
        unknown += batch->column_hinges[k] == 0 ? 3 : batch->column_hinges[k];
    }
}

/* Give a batch its memory, all in one piece; counts it where there is none yet. */
static size_t lay_out(Batch *batch, char *memory)
{
    const Problem *problem = batch->problem;
    count_rows(batch);
    const size_t nodes = problem->of.nodes, R = batch->rows, K = problem->of.columns, H = problem->of.hinges;
    size_t hinged = 0;
    for (size_t h = 0; h < H; h++)
        hinged += !problem->hinge[h].second;
    batch->unknowns = (int)(3 * (K - hinged) + H + 3);
    const size_t n = batch->unknowns;
    size_t needed = 0;
    char **from = &memory;
#define NUMBERS(count) take(from, &needed, sizeof(V) * (count))
#define MASKS(count) take(from, &needed, sizeof(Mask) * (count))
#define PLACES(count) take(from, &needed, sizeof(int) * (count))
    batch->local = NUMBERS(4 * nodes), batch->reference = NUMBERS(4 * K), batch->offsets = NUMBERS(3 * nodes);
    batch->targets = NUMBERS(4 * problem->of.tasks);
    batch->positions = NUMBERS(3 * nodes), batch->rotations = NUMBERS(9 * nodes);
    batch->mass_moments = NUMBERS(3 * nodes);
    batch->mass_shares = take(from, &needed, sizeof(double) * nodes);
    batch->hinge_axes = NUMBERS(3 * H), batch->hinge_angles = NUMBERS(H), batch->hinge_rows = NUMBERS(H * R);
    batch->hinge_fixed = NUMBERS(H), batch->hinge_free = MASKS(H), batch->hinge_free_before = MASKS(H);
    const size_t L = 2 * problem->of.limits;
    batch->cone_turns = NUMBERS(3 * L), batch->cone_rates = NUMBERS(L), batch->cone_values = NUMBERS(L);
    batch->cone_fixed = NUMBERS(L), batch->cone_rows = NUMBERS(L * R);
    batch->cone_on = MASKS(L), batch->cone_before = MASKS(L);
    batch->errors = NUMBERS(R), batch->G = NUMBERS(R * R), batch->G_frozen = NUMBERS(R * R), batch->M = NUMBERS(R * R);
    batch->c = NUMBERS(R), batch->Qz = NUMBERS(R), batch->scratch_rows = NUMBERS(6 * R);
    batch->algebra = NUMBERS(factor_scratch((int)R)), batch->dependent = MASKS(R);
    batch->dependent_row = PLACES(R), batch->sided_row = PLACES(R);
    batch->active = MASKS(R), batch->active_before = MASKS(R);
    batch->z = NUMBERS(n), batch->home = NUMBERS(n), batch->step = NUMBERS(n), batch->fast = NUMBERS(n);
    batch->home_before = NUMBERS(n), batch->step_before = NUMBERS(n);
    batch->column_hinge = PLACES(K), batch->column_hinges = PLACES(K), batch->column_unknown = PLACES(K);
    const size_t held = batch->holds ? 1 : 0;
    batch->held_errors = NUMBERS(3 * (size_t)batch->held), batch->holder = PLACES(n), batch->held_unknown = PLACES(n),
    batch->base = NUMBERS(held * n);
    batch->J = NUMBERS(held * R * n), batch->X = NUMBERS(held * R * n), batch->held_pull = NUMBERS(held * R);
    batch->G_held = NUMBERS(held * R * R),
    batch->held_scratch = NUMBERS(held * held_scratch((int)R, (int)n, batch->held));
#undef NUMBERS
#undef MASKS
#undef PLACES
    if (memory != NULL) {
        number_unknowns(batch);
        for (size_t i = 0; i < n; i++)
            batch->holder[i] = -1;
    }
    lay_out_layers(batch, from, &needed);
    lay_out_tasks(batch, from, &needed);
    return needed;
}
