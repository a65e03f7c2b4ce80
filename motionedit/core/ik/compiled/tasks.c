/* Tasks: their errors, their rows as forces and torques on chains of columns, and G = J J^T from levers ([PRIO] 3, 4). */

#include "layered.h"
#include "rotations.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Give out memory; with no memory yet only count it. */
void *take(char **memory, size_t *needed, size_t bytes)
{
    void *place = *memory == NULL ? NULL : *memory + *needed;
    *needed += (bytes + 15) / 16 * 16;
    return place;
}

/* The columns from a node up to the root that a task recruits, growing; returns their number. */
static int chain(const Problem *problem, const Task *task, int64_t node, int *columns)
{
    int count = 0;
    for (int64_t i = node; i >= 0; i = problem->node[i].parent) {
        const int64_t column = problem->node[i].column;
        if (column >= 0 && task->recruited[column]) {
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

/* The columns that carry mass. */
static int carriers(const Frame *frame, const Task *task, int *columns)
{
    const Problem *problem = frame->problem;
    int count = 0;
    for (int64_t k = 0; k < problem->columns; k++) {
        if (!task->recruited[k])
            continue;
        if (columns != NULL)
            columns[count] = (int)k;
        count++;
    }
    return count;
}

static int part_columns(const Frame *frame, const Task *task, int p, int *columns)
{
    if (task->kind == CENTER_OF_MASS)
        return carriers(frame, task, columns);
    return chain(frame->problem, task, p == 0 ? task->node : task->base, columns);
}

static void lay_out_pull(Frame *frame, const Task *task, Pull *pull, char **memory, size_t *needed)
{
    const int parts = task->base >= 0 ? 2 : 1;
    for (int p = 0; p < parts; p++) {
        const int count = part_columns(frame, task, p, NULL);
        int *columns = take(memory, needed, sizeof *columns * count);
        double *levers = take(memory, needed, 3 * sizeof *levers * count);
        if (columns == NULL)
            continue;
        part_columns(frame, task, p, columns);
        memset(levers, 0, 3 * sizeof *levers * count);
        Part *part = pull->part + p;
        memset(part, 0, sizeof *part);
        part->count = count, part->columns = columns, part->levers = levers;
        part->root = (int)(p == 0 ? task->root : task->base_root);
        part->has_force = task->kind != ORIENTATION && task->kind != POSTURE;
        part->has_torque = task->kind != POSITION && task->kind != CENTER_OF_MASS;
    }
    if (pull != NULL)
        pull->parts = parts;
}

/* The columns without a hinge that two parts share. */
static int common(const Frame *frame, const Part *a, const Part *b, int *places)
{
    int count = 0;
    for (int i = 0, j = 0; i < a->count && j < b->count;) {
        if (a->columns[i] < b->columns[j])
            i++;
        else if (a->columns[i] > b->columns[j])
            j++;
        else {
            if (frame->column_hinge[a->columns[i]] < 0) {
                if (places != NULL)
                    places[2 * count] = i, places[2 * count + 1] = j;
                count++;
            }
            i++, j++;
        }
    }
    return count;
}

/* Lay out what does not change from frame to frame. Called twice: to count the memory, and to fill it. */
void lay_out_tasks(Frame *frame, char **memory, size_t *needed)
{
    const Problem *problem = frame->problem;
    const int tasks = (int)problem->tasks;
    frame->pulls = take(memory, needed, sizeof *frame->pulls * tasks);
    frame->recruits_hinge = take(memory, needed, problem->hinges * tasks);
    for (int t = 0; t < tasks; t++)
        lay_out_pull(frame, problem->task + t, frame->pulls == NULL ? NULL : frame->pulls + t, memory, needed);
    /* Every pair of parts, two a task at most: room for the longest lists. */
    const size_t pairs = (size_t)2 * tasks * (tasks + 1);
    frame->shared = take(memory, needed, sizeof *frame->shared * pairs);
    int *places = take(memory, needed, 2 * sizeof *places * problem->columns * pairs);
    if (frame->pulls == NULL)
        return;
    for (int t = 0, row = 0; t < tasks; t++) {
        frame->pulls[t].first_row = row;
        row += (int)problem->task[t].rows;
    }
    memset(frame->recruits_hinge, 0, problem->hinges * tasks);
    frame->shared_count = 0;
    for (int s = 0; s < tasks; s++)
        for (int p = 0; p < frame->pulls[s].parts; p++) {
            const Part *mine = frame->pulls[s].part + p;
            for (int i = 0; i < mine->count; i++)
                if (frame->column_hinge[mine->columns[i]] >= 0)
                    frame->recruits_hinge[frame->column_hinge[mine->columns[i]] * tasks + s] = 1;
            for (int t = 0; t <= s; t++)
                for (int q = 0; q < frame->pulls[t].parts; q++) {
                    const Part *theirs = frame->pulls[t].part + q;
                    const int count = common(frame, mine, theirs, places);
                    if (count == 0 && !(mine->root && theirs->root))
                        continue;
                    frame->shared[frame->shared_count++] = (Shared){{s, t}, {p, q}, count, places};
                    places += 2 * count;
                }
        }
}

/* Put w times the measuring axes, turned by q, into the rows of a force or torque. */
static void turned_axes(const Task *task, const double *q, double rows[3][3])
{
    for (int64_t r = 0; r < task->rows; r++) {
        q_rotate(q, task->measure[r], rows[r]);
        for (int a = 0; a < 3; a++)
            rows[r][a] *= task->weight;
    }
}

static void negated(double rows[3][3], double out[3][3])
{
    for (int r = 0; r < 3; r++)
        for (int a = 0; a < 3; a++)
            out[r][a] = -rows[r][a];
}

/* Levers from the columns of a part to a point. */
static void levers_to(const Frame *frame, Part *part, const double *point)
{
    for (int i = 0; i < part->count; i++) {
        const double *place = frame->positions + 3 * frame->problem->column_node[part->columns[i]];
        for (int a = 0; a < 3; a++)
            part->levers[3 * i + a] = point[a] - place[a];
    }
}

static const double IDENTITY[4] = {1.0, 0.0, 0.0, 0.0};

/* e = target - x along the axes; dx = R_b^T (dp - dp_b - w_b x (p - p_b)): the base pulls back at the same point. */
static void evaluate_position(const Frame *frame, const Task *task, Pull *pull, const double *target, double *e)
{
    double point[3], seen[3];
    const double *base = task->base >= 0 ? frame->rotations + 4 * task->base : IDENTITY;
    q_rotate(frame->rotations + 4 * task->node, task->offset, point);
    add_scaled(point, 1.0, frame->positions + 3 * task->node);
    memcpy(seen, point, sizeof seen);
    if (task->base >= 0) {
        add_scaled(seen, -1.0, frame->positions + 3 * task->base);
        q_rotate_back(base, seen, seen);
    }
    for (int64_t r = 0; r < task->rows; r++)
        e[r] = task->weight * (target[task->axes[r]] - dot(task->measure[r], seen));
    turned_axes(task, base, pull->part[0].force);
    levers_to(frame, pull->part, point);
    if (task->base >= 0) {
        negated(pull->part[0].force, pull->part[1].force);
        levers_to(frame, pull->part + 1, point);
    }
}

/* e = target - c, and (m_sub / M) e_a x (c_sub - p_j). */
static void evaluate_center_of_mass(const Frame *frame, const Task *task, Pull *pull, const double *target, double *e)
{
    Part *part = pull->part;
    for (int64_t r = 0; r < task->rows; r++)
        e[r] = task->weight * (target[task->axes[r]] - dot(task->measure[r], frame->center));
    turned_axes(task, IDENTITY, part->force);
    for (int i = 0; i < part->count; i++) {
        const int64_t node = frame->problem->column_node[part->columns[i]];
        for (int a = 0; a < 3; a++)
            part->levers[3 * i + a] = frame->mass_shares[node] *
                                      (frame->mass_centers[3 * node + a] - frame->positions[3 * node + a]);
    }
}

/* e = log(q_target q^-1), in the base's frame where there is one. */
static void evaluate_orientation(const Frame *frame, const Task *task, Pull *pull, const double *target, double *e)
{
    const double *base = task->base >= 0 ? frame->rotations + 4 * task->base : IDENTITY;
    const double scale = task->weight * METRES_PER_RADIAN;
    double q[4], inverse[4], v[4];
    q_conjugate(base, inverse);
    q_multiply(inverse, frame->rotations + 4 * task->node, q);
    q_conjugate(q, q);
    q_multiply(target, q, v);
    q_log(v, v);
    for (int r = 0; r < 3; r++) {
        e[r] = scale * v[r];
        double axis[3] = {0.0, 0.0, 0.0};
        axis[r] = scale;
        q_rotate(base, axis, pull->part[0].torque[r]);
    }
    if (task->base >= 0)
        negated(pull->part[0].torque, pull->part[1].torque);
}

/* One joint's local rotation: e = log(q_target q^-1) as a world-axis increment, the identity in its own column. */
static void evaluate_posture(
    const Frame *frame, const Task *task, Pull *pull, const double *local, const double *target, double *e)
{
    const Node *node = frame->problem->node + task->node;
    const double scale = task->weight * METRES_PER_RADIAN;
    double inverse[4], v[4];
    q_conjugate(local + 4 * node->joint, inverse);
    q_multiply(target, inverse, v);
    q_log(v, v);
    q_rotate(node->parent < 0 ? IDENTITY : frame->rotations + 4 * node->parent, v, v);
    for (int r = 0; r < 3; r++) {
        e[r] = scale * v[r];
        pull->part[0].torque[r][r] = scale;
    }
}

/* The turn from d to the target's direction, and (I - d d^T) w + d x (dp_e - dp_t) / r. */
static void evaluate_aim(const Frame *frame, const Task *task, Pull *pull, const double *target, double *e)
{
    const double scale = task->weight * METRES_PER_RADIAN, *turn = frame->rotations + 4 * task->node;
    double d[3], from[3], at[3], t[3], side[3];
    q_rotate(turn, task->axis, d);
    q_rotate(turn, task->offset, from);
    add_scaled(from, 1.0, frame->positions + 3 * task->node);
    if (task->base < 0)
        memcpy(at, target, sizeof at);
    else {
        memcpy(at, frame->positions + 3 * task->base, sizeof at);
        if (task->width) {
            double arm[3];
            q_rotate(frame->rotations + 4 * task->base, target, arm);
            add_scaled(at, 1.0, arm);
        }
    }
    for (int a = 0; a < 3; a++)
        t[a] = at[a] - from[a];
    const double distance = fmax(sqrt(dot(t, t)), 1e-9);
    for (int a = 0; a < 3; a++)
        t[a] /= distance;
    cross(d, t, side);
    double sine = sqrt(dot(side, side));
    const double angle = atan2(sine, dot(d, t));
    if (sine < 1e-9) { /* straight ahead or behind: any axis square to d will do */
        double helper[3] = {0.0, 0.0, 0.0};
        int least = 0;
        for (int a = 1; a < 3; a++)
            if (fabs(d[a]) < fabs(d[least]))
                least = a;
        helper[least] = 1.0;
        cross(d, helper, side);
        sine = sqrt(dot(side, side));
    }
    for (int r = 0; r < 3; r++) {
        double *torque = pull->part[0].torque[r], *force = pull->part[0].force[r], axis[3] = {0.0, 0.0, 0.0};
        e[r] = scale * angle * side[r] / sine;
        axis[r] = 1.0;
        cross(axis, d, force);
        for (int a = 0; a < 3; a++) {
            torque[a] = scale * (axis[a] - d[r] * d[a]);
            force[a] *= scale / distance;
        }
    }
    levers_to(frame, pull->part, from);
    if (task->base >= 0) {
        negated(pull->part[0].force, pull->part[1].force);
        levers_to(frame, pull->part + 1, at);
    }
}

/* Errors, shape (R,), and the rows of every task, at the pose that `forward` has laid out. */
void evaluate_tasks(Frame *frame, const double *local, int64_t at)
{
    for (int64_t t = 0; t < frame->problem->tasks; t++) {
        const Task *task = frame->problem->task + t;
        Pull *pull = frame->pulls + t;
        const double *target = task->targets + task->width * at;
        double *e = frame->errors + pull->first_row;
        switch (task->kind) {
        case POSITION: evaluate_position(frame, task, pull, target, e); break;
        case CENTER_OF_MASS: evaluate_center_of_mass(frame, task, pull, target, e); break;
        case ORIENTATION: evaluate_orientation(frame, task, pull, target, e); break;
        case POSTURE: evaluate_posture(frame, task, pull, local, target, e); break;
        default: evaluate_aim(frame, task, pull, target, e);
        }
    }
}

/* What the rows have along a hinge's axis: hinge_rows[h][r] = a . (l x f + t). */
static void hinge_rows(Frame *frame)
{
    const Problem *problem = frame->problem;
    memset(frame->hinge_rows, 0, sizeof *frame->hinge_rows * problem->hinges * problem->rows);
    for (int64_t t = 0; t < problem->tasks; t++) {
        const Pull *pull = frame->pulls + t;
        for (int p = 0; p < pull->parts; p++) {
            const Part *part = pull->part + p;
            for (int i = 0; i < part->count; i++) {
                const int h = frame->column_hinge[part->columns[i]];
                if (h < 0)
                    continue;
                double *out = frame->hinge_rows + h * problem->rows + pull->first_row, lever[3];
                const double *axis = frame->hinge_axes + 3 * h;
                cross(axis, part->levers + 3 * i, lever); /* a . (l x f) = f . (a x l) */
                for (int64_t r = 0; r < problem->task[t].rows; r++)
                    out[r] += dot(part->force[r], lever) + dot(part->torque[r], axis);
            }
        }
    }
}

/* Add sum_j (l_j x f_r + t_r) . (m_j x f_s + t_s) over the shared columns, and the root's f_r . f_s. */
static void add_block(Frame *frame, const Shared *shared)
{
    const Problem *problem = frame->problem;
    const Pull *mine = frame->pulls + shared->task[0], *theirs = frame->pulls + shared->task[1];
    const Part *a = mine->part + shared->part[0], *b = theirs->part + shared->part[1];
    double between = 0.0, outer[3][3] = {{0.0}}, l_sum[3] = {0.0}, m_sum[3] = {0.0};
    for (int i = 0; i < shared->count; i++) {
        const double *l = a->levers + 3 * shared->places[2 * i], *m = b->levers + 3 * shared->places[2 * i + 1];
        between += dot(l, m);
        for (int x = 0; x < 3; x++) {
            outer[x][0] += m[x] * l[0], outer[x][1] += m[x] * l[1], outer[x][2] += m[x] * l[2];
            l_sum[x] += l[x], m_sum[x] += m[x];
        }
    }
    if (a->root && b->root)
        between += 1.0;
    for (int64_t r = 0; r < problem->task[shared->task[0]].rows; r++) {
        const double *f = a->force[r], *t = a->torque[r];
        double pushed[3], *out = frame->G + (mine->first_row + r) * problem->rows + theirs->first_row;
        /* (l x f) . (m x g) = (l . m) (f . g) - (m . f) (l . g) */
        for (int x = 0; x < 3; x++)
            pushed[x] = between * f[x] - (outer[0][x] * f[0] + outer[1][x] * f[1] + outer[2][x] * f[2]);
        double turned[3] = {0.0}, lever[3];
        if (a->has_torque) {
            cross(t, m_sum, lever); /* t . (m x g) = g . (t x m) */
            add_scaled(pushed, 1.0, lever);
        }
        if (b->has_torque) {
            cross(l_sum, f, turned);
            add_scaled(turned, shared->count, t);
        }
        for (int64_t s = 0; s < problem->task[shared->task[1]].rows; s++)
            out[s] += dot(pushed, b->force[s]) + dot(turned, b->torque[s]);
    }
}

/* G = J J^T, shape (R, R), lower triangle of blocks, with every hinge turning. */
void gram(Frame *frame)
{
    const Problem *problem = frame->problem;
    const int64_t R = problem->rows;
    memset(frame->G, 0, sizeof *frame->G * R * R);
    for (int i = 0; i < frame->shared_count; i++)
        add_block(frame, frame->shared + i);
    hinge_rows(frame);
    for (int64_t h = 0; h < problem->hinges; h++) {
        const double *rows = frame->hinge_rows + h * R;
        const uint8_t *recruits = frame->recruits_hinge + h * problem->tasks;
        for (int64_t s = 0; s < problem->tasks; s++)
            for (int64_t t = 0; t <= s && recruits[s]; t++) {
                if (!recruits[t])
                    continue;
                const int first = frame->pulls[s].first_row, other = frame->pulls[t].first_row;
                for (int64_t r = first; r < first + problem->task[s].rows; r++)
                    for (int64_t q = other; q < other + problem->task[t].rows; q++)
                        frame->G[r * R + q] += rows[r] * rows[q];
            }
    }
}

/* J v, shape (R,), of a step v, shape (n,), that turns hinges about their axes alone. */
void rows_times(const Frame *frame, const double *v, double *out)
{
    const Problem *problem = frame->problem;
    for (int64_t t = 0; t < problem->tasks; t++) {
        const Pull *pull = frame->pulls + t;
        for (int64_t r = 0; r < problem->task[t].rows; r++)
            out[pull->first_row + r] = 0.0;
        for (int p = 0; p < pull->parts; p++) {
            const Part *part = pull->part + p;
            double moved[3] = {0.0}, turned[3] = {0.0}, way[3];
            for (int i = 0; i < part->count; i++) {
                const double *w = v + 3 * part->columns[i];
                cross(w, part->levers + 3 * i, way);
                add_scaled(moved, 1.0, way);
                add_scaled(turned, 1.0, w);
            }
            if (part->root)
                add_scaled(moved, 1.0, v + 3 * problem->columns);
            for (int64_t r = 0; r < problem->task[t].rows; r++)
                out[pull->first_row + r] += dot(part->force[r], moved) + dot(part->torque[r], turned);
        }
    }
}

/* out += J^T y: each part's forces and torques add up to one of each; hinges on their limits take none. */
void add_rows_transposed(const Frame *frame, const double *y, double *out)
{
    const Problem *problem = frame->problem;
    for (int64_t t = 0; t < problem->tasks; t++) {
        const Pull *pull = frame->pulls + t;
        for (int p = 0; p < pull->parts; p++) {
            const Part *part = pull->part + p;
            double force[3] = {0.0}, torque[3] = {0.0};
            for (int64_t r = 0; r < problem->task[t].rows; r++) {
                add_scaled(force, y[pull->first_row + r], part->force[r]);
                add_scaled(torque, y[pull->first_row + r], part->torque[r]);
            }
            for (int i = 0; i < part->count; i++) {
                const int h = frame->column_hinge[part->columns[i]];
                double turn[3], *to = out + 3 * part->columns[i];
                cross(part->levers + 3 * i, force, turn);
                add_scaled(turn, 1.0, torque);
                if (h < 0)
                    add_scaled(to, 1.0, turn);
                else if (frame->hinge_free[h])
                    add_scaled(to, dot(frame->hinge_axes + 3 * h, turn), frame->hinge_axes + 3 * h);
            }
            if (part->root)
                add_scaled(out + 3 * problem->columns, 1.0, force);
        }
    }
}
