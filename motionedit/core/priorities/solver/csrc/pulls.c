/* What each task pulls at, and what two of them share: they do not change from frame to frame. Part of solver.c. */

/* Give out memory; with no memory yet only count it. */
static void *take(char **memory, size_t *needed, size_t bytes)
{
    void *place = *memory == NULL ? NULL : *memory + *needed;
    *needed += (bytes + sizeof(V) - 1) / sizeof(V) * sizeof(V);
    return place;
}

/* The columns that a task may use, shape (K,). */
static const uint8_t *recruited(const Problem *problem, const Task *task)
{
    return problem->recruited + (task - problem->task) * problem->of.columns;
}

/* The columns from a node up to the root that a task recruits, growing; returns their number. */
static int chain(const Problem *problem, const Task *task, int64_t node, int *columns)
{
    int count = 0;
    for (int64_t i = node; i >= 0; i = problem->node[i].parent) {
        const int64_t column = problem->node[i].column;
        if (column >= 0 && recruited(problem, task)[column]) {
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

/* All columns that a task may use: what weighs the body is moved by all of them. */
static int carriers(const Problem *problem, const Task *task, int *columns)
{
    int count = 0;
    for (int64_t k = 0; k < problem->of.columns; k++) {
        if (!recruited(problem, task)[k])
            continue;
        if (columns != NULL)
            columns[count] = (int)k;
        count++;
    }
    return count;
}

static int part_columns(const Problem *problem, const Task *task, int p, int *columns)
{
    if (ROW_KINDS[task->kind].is.weighs)
        return carriers(problem, task, columns);
    return chain(problem, task, p == 0 ? task->node : task->base, columns);
}

static double squared(double a)
{
    return a * a;
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
        part->has_force = ROW_KINDS[task->kind].is.force;
        part->has_torque = ROW_KINDS[task->kind].is.torque;
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
    int *felt = batch->hinge_felt + h * batch->rows, count = 0;
    for (int64_t t = 0; t < problem->of.tasks; t++) {
        const Pull *pull = batch->pulls + t;
        int feels = 0;
        for (int p = 0; p < pull->parts; p++)
            for (int i = 0; i < pull->part[p].count; i++)
                feels |= pull->part[p].columns[i] == problem->hinge[h].column;
        for (int64_t r = 0; r < pull->rows && feels; r++)
            felt[count++] = pull->first_row + (int)r;
    }
    batch->hinge_felt_count[h] = count;
}

/* Which rows are whose, which of them are one-sided; of joints that are held, which errors. */
static void number_rows(Batch *batch)
{
    const Problem *problem = batch->problem;
    batch->weighs = batch->sided = 0;
    for (int t = 0, row = 0, error = 0; t < problem->of.tasks; t++) {
        const Task *task = problem->task + t;
        Pull *pull = batch->pulls + t;
        const int rows = (int)task->rows, holds = batch->layers[task->layer].held > 0;
        batch->weighs |= ROW_KINDS[task->kind].is.weighs;
        pull->first_row = holds ? error : row;
        pull->rows = holds ? 0 : rows;
        error += rows - pull->rows;
        if (holds)
            pull->parts = 0;
        for (int r = 0; r < pull->rows; r++, row++) {
            batch->active[row] = everywhere();
            if (task->one_sided)
                batch->sided_row[batch->sided++] = row;
        }
    }
}

/* Every pair of parts that share columns, or the root; `places` has room for all that they share. */
static void list_shared(Batch *batch, int *places)
{
    const Problem *problem = batch->problem;
    batch->shared_count = 0;
    for (int s = 0; s < problem->of.tasks; s++)
        for (int p = 0; p < batch->pulls[s].parts; p++) {
            const Part *mine = batch->pulls[s].part + p;
            for (int t = 0; t <= s; t++)
                for (int q = 0; q < batch->pulls[t].parts; q++) {
                    const Part *theirs = batch->pulls[t].part + q;
                    const int count = common(batch, mine, theirs, places);
                    if (count == 0 && !(mine->root && theirs->root))
                        continue;
                    double mobility = 0.0;
                    for (int i = 0; i < count; i++)
                        mobility += squared(problem->mobility[mine->columns[places[2 * i]]]);
                    batch->shared[batch->shared_count++] = (Shared){{s, t}, {p, q}, count, places, mobility};
                    places += 2 * count;
                }
        }
}

/* Called twice: to count the memory, and to fill it. */
static void lay_out_tasks(Batch *batch, char **memory, size_t *needed)
{
    const Problem *problem = batch->problem;
    const int tasks = (int)problem->of.tasks;
    batch->pulls = take(memory, needed, sizeof *batch->pulls * tasks);
    batch->hinge_felt = take(memory, needed, sizeof *batch->hinge_felt * problem->of.hinges * batch->rows);
    batch->hinge_felt_count = take(memory, needed, sizeof *batch->hinge_felt_count * problem->of.hinges);
    for (int t = 0; t < tasks; t++)
        lay_out_pull(problem, problem->task + t, batch->pulls == NULL ? NULL : batch->pulls + t, memory, needed);
    /* Every pair of parts, two a task at most: room for the longest lists. */
    const size_t pairs = (size_t)2 * tasks * (tasks + 1);
    batch->shared = take(memory, needed, sizeof *batch->shared * pairs);
    int *places = take(memory, needed, 2 * sizeof *places * problem->of.columns * pairs);
    if (batch->pulls == NULL)
        return;
    number_rows(batch);
    for (int64_t h = 0; h < problem->of.hinges; h++)
        list_felt(batch, h);
    list_shared(batch, places);
}
