/* Whether what comes from Python makes sense: a slip there is an error and no crash. */

#include "layered.h"

/* More than anybody has, and so few that no product of sizes overflows. */
enum { MOST = 1 << 20 };
static const int64_t MOST_TARGETS = (int64_t)1 << 50;

static int between(int64_t least, int64_t index, int64_t count)
{
    return least <= index && index < count;
}

const char *settings_fault(const Settings *of)
{
    const int64_t counts[] = {
        of->nodes, of->columns, of->tasks, of->hinges, of->limits, of->layers, of->joints, of->translated, of->rows};
    int sense = between(0, of->targets, MOST_TARGETS) && between(-1, of->root, of->nodes);
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        sense &= between(0, counts[i], MOST);
    return sense ? 0 : "sizes that are none";
}

/* Nodes, an ancestor before its descendants, and the columns among them, which know each other. */
static int are_nodes(const Problem *problem)
{
    const Settings *of = &problem->of;
    int64_t columns = 0;
    int sense = of->root < 0 || problem->node[of->root].translation >= 0;
    for (int64_t i = 0; i < of->nodes; i++) {
        const Node *node = problem->node + i;
        sense &= between(0, node->joint, of->joints) && between(-1, node->parent, i) &&
                 between(-1, node->translation, of->translated) && between(-1, node->column, of->columns);
        columns += node->column >= 0;
    }
    sense &= columns == of->columns;
    for (int64_t k = 0; k < of->columns; k++) {
        const int64_t node = problem->column_node[k];
        sense &= between(0, node, of->nodes) && problem->node[node].column == k;
    }
    return sense;
}

/* A task's kind, its node, base and layer, its axes, and its part of the targets. */
static int is_task(const Problem *problem, const Task *task)
{
    const Settings *of = &problem->of;
    const RowKind *kind = task->kind < 0 ? 0 : row_kind(task->kind);
    if (kind == 0 || !between(0, task->layer, of->layers) || !between(1, task->rows, 4))
        return 0;
    if ((kind->rows != 0 && task->rows != kind->rows) || (kind->spans && task->base < 0))
        return 0;
    int sense = between(kind->weighs ? -1 : 0, task->node, of->nodes) && between(-1, task->base, of->nodes) &&
                task->width == kind->width && between(0, task->targets, of->targets + 1) &&
                task->targets + task->width * problem->count <= of->targets;
    for (int64_t r = 0; r < task->rows; r++)
        sense &= kind->rows != 0 || between(0, task->axes[r], 3);
    return sense;
}

static int are_tasks(const Problem *problem)
{
    const Settings *of = &problem->of;
    int64_t rows = 0;
    int sense = 1;
    for (int64_t t = 0; t < of->tasks; t++) {
        sense &= is_task(problem, problem->task + t);
        sense &= t == 0 || problem->task[t - 1].layer <= problem->task[t].layer; /* layer by layer */
        rows += problem->task[t].rows;
    }
    return sense && rows == of->rows;
}

/* Hinges are columns, a column's second follows its first. */
static int are_hinges(const Problem *problem)
{
    const int64_t count = problem->of.hinges;
    int sense = 1;
    for (int64_t h = 0; h < count; h++) {
        sense &= between(0, problem->hinge[h].column, problem->of.columns);
        const Hinge *hinge = problem->hinge + h;
        sense &= between(0, hinge->second, 2) && (!hinge->second || (h > 0 && !hinge[-1].second));
        for (int64_t other = 0; other < h; other++)
            sense &= (problem->hinge[other].column == hinge->column) == (hinge->second && other == h - 1);
    }
    return sense;
}

/* Limits are columns without hinges. */
static int are_limits(const Problem *problem)
{
    int sense = 1;
    for (int64_t c = 0; c < problem->of.limits; c++) {
        const int64_t column = problem->limit[c].column;
        sense &= between(0, column, problem->of.columns);
        for (int64_t h = 0; h < problem->of.hinges; h++)
            sense &= problem->hinge[h].column != column;
    }
    return sense;
}

/* Frames are the motion's, and those in order follow each other. */
static int are_frames(const Problem *problem)
{
    int sense = 1;
    for (int64_t f = 0; f < problem->count; f++) {
        sense &= between(0, problem->frames[f], problem->motion_frames);
        sense &= f == 0 || !problem->in_order || problem->frames[f] == problem->frames[f - 1] + 1;
    }
    return sense;
}

static int are_levels(const Problem *problem)
{
    int sense = 1;
    for (int64_t l = 0; l < problem->of.layers; l++)
        sense &= between(0, problem->level[l], problem->levels);
    return sense;
}

const char *problem_fault(const Problem *problem)
{
    if (!are_nodes(problem))
        return "nodes or columns that are none";
    if (!are_tasks(problem))
        return "tasks that are none";
    if (!are_hinges(problem))
        return "hinges that are none";
    if (!are_limits(problem))
        return "limits that are none";
    if (!are_levels(problem))
        return "levels that are none";
    return are_frames(problem) ? 0 : "frames that are none";
}
