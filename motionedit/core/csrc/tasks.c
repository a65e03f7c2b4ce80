/* Tasks: errors, rows as forces and torques on chains of columns, and G = J J^T from levers ([PRIO] 3, 4). */

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

/* Whether a task's rows are the world's axes. */
static int measures_plainly(const Task *task)
{
    int plain = task->rows == 3;
    for (int r = 0; r < 3; r++)
        for (int a = 0; a < 3; a++)
            plain &= task->measure[r][a] == (r == a ? 1.0 : 0.0);
    return plain;
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
        part->plain = parts == 1 && !part->has_torque && measures_plainly(task);
        for (int r = 0; r < 3 && part->plain; r++)
            part->force[r][r] = task->weight;
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

/* The rows that feel a hinge turn, growing. */
static void list_felt(Frame *frame, int64_t h)
{
    const Problem *problem = frame->problem;
    int *felt = frame->hinge_felt + h * problem->rows, count = 0;
    for (int64_t t = 0; t < problem->tasks; t++) {
        const Pull *pull = frame->pulls + t;
        int feels = 0;
        for (int p = 0; p < pull->parts; p++)
            for (int i = 0; i < pull->part[p].count; i++)
                feels |= frame->column_hinge[pull->part[p].columns[i]] == h;
        for (int64_t r = 0; r < problem->task[t].rows && feels; r++)
            felt[count++] = pull->first_row + (int)r;
    }
    frame->hinge_felt_count[h] = count;
}

/* Lay out what does not change from frame to frame. Called twice: to count the memory, and to fill it. */
void lay_out_tasks(Frame *frame, char **memory, size_t *needed)
{
    const Problem *problem = frame->problem;
    const int tasks = (int)problem->tasks;
    frame->pulls = take(memory, needed, sizeof *frame->pulls * tasks);
    frame->hinge_felt = take(memory, needed, sizeof *frame->hinge_felt * problem->hinges * problem->rows);
    frame->hinge_felt_count = take(memory, needed, sizeof *frame->hinge_felt_count * problem->hinges);
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
    for (int64_t h = 0; h < problem->hinges; h++)
        list_felt(frame, h);
    frame->shared_count = 0;
    for (int s = 0; s < tasks; s++)
        for (int p = 0; p < frame->pulls[s].parts; p++) {
            const Part *mine = frame->pulls[s].part + p;
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

/* Put w times the measuring axes, turned by R, into the rows of a force. */
static void turned_axes(const Task *task, const double *R, double rows[3][3])
{
    for (int64_t r = 0; r < task->rows; r++) {
        turned(R, task->measure[r], rows[r]);
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

static const double IDENTITY[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};

/* e = target - x along the axes; dx = R_b^T (dp - dp_b - w_b x (p - p_b)): the base pulls back at the same point. */
static void evaluate_position(const Frame *frame, const Task *task, Pull *pull, const double *target, double *e)
{
    double point[3], seen[3];
    const double *base = task->base >= 0 ? frame->rotations + 9 * task->base : IDENTITY;
    turned(frame->rotations + 9 * task->node, task->offset, point);
    add_scaled(point, 1.0, frame->positions + 3 * task->node);
    memcpy(seen, point, sizeof seen);
    if (task->base >= 0) {
        add_scaled(seen, -1.0, frame->positions + 3 * task->base);
        turned_back(base, seen, seen);
    }
    for (int64_t r = 0; r < task->rows; r++)
        e[r] = task->weight * (target[task->axes[r]] - dot(task->measure[r], seen));
    if (!pull->part[0].plain)
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
    if (!part->plain)
        turned_axes(task, IDENTITY, part->force);
    for (int i = 0; i < part->count; i++) {
        const int64_t node = frame->problem->column_node[part->columns[i]];
        for (int a = 0; a < 3; a++)
            part->levers[3 * i + a] =
                frame->mass_moments[3 * node + a] - frame->mass_shares[node] * frame->positions[3 * node + a];
    }
}

/* e = log(q_target q^-1), in the base's frame where there is one. */
static void evaluate_orientation(
    const Frame *frame, const Task *task, Pull *pull, const double *local, const double *target, double *e)
{
    const double *base = task->base >= 0 ? frame->rotations + 9 * task->base : IDENTITY;
    const double scale = task->weight * METRES_PER_RADIAN;
    double q[4], v[4];
    world_quaternion(frame, local, task->node, q);
    q_conjugate(q, q);
    if (task->base >= 0) {
        double below[4];
        world_quaternion(frame, local, task->base, below);
        q_multiply(q, below, q);
    }
    q_multiply(target, q, v);
    q_log(v, v);
    for (int r = 0; r < 3; r++) {
        e[r] = scale * v[r];
        for (int a = 0; a < 3; a++)
            pull->part[0].torque[r][a] = scale * base[3 * a + r];
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
    turned(parent_rotation(frame, task->node), v, v);
    for (int r = 0; r < 3; r++) {
        e[r] = scale * v[r];
        pull->part[0].torque[r][r] = scale;
    }
}

/* The turn from d to the target's direction, and (I - d d^T) w + d x (dp_e - dp_t) / r. */
static void evaluate_aim(const Frame *frame, const Task *task, Pull *pull, const double *target, double *e)
{
    const double scale = task->weight * METRES_PER_RADIAN, *turn = frame->rotations + 9 * task->node;
    double d[3], from[3], at[3], t[3], side[3];
    turned(turn, task->axis, d);
    turned(turn, task->offset, from);
    add_scaled(from, 1.0, frame->positions + 3 * task->node);
    if (task->base < 0)
        memcpy(at, target, sizeof at);
    else {
        memcpy(at, frame->positions + 3 * task->base, sizeof at);
        if (task->width) {
            double arm[3];
            turned(frame->rotations + 9 * task->base, target, arm);
            add_scaled(at, 1.0, arm);
        }
    }
    for (int a = 0; a < 3; a++)
        t[a] = at[a] - from[a];
    const double distance = larger(sqrt(dot(t, t)), 1e-9);
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
        case ORIENTATION: evaluate_orientation(frame, task, pull, local, target, e); break;
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

/* Sums over the columns that two parts share, l the one's levers and m the other's. */
typedef struct {
    double between;     /* sum l . m */
    double outer[3][3]; /* sum m l^T */
    double l[3], m[3];
} Sums;

static void sum_levers(const Shared *shared, const Part *a, const Part *b, Sums *sums)
{
    const int turns = a->has_torque || b->has_torque;
    memset(sums, 0, sizeof *sums);
    for (int i = 0; i < shared->count && turns && a->has_force; i++)
        add_scaled(sums->l, 1.0, a->levers + 3 * shared->places[2 * i]);
    for (int i = 0; i < shared->count && turns && b->has_force; i++)
        add_scaled(sums->m, 1.0, b->levers + 3 * shared->places[2 * i + 1]);
    if (!a->has_force || !b->has_force)
        return;
    double xx = 0.0, xy = 0.0, xz = 0.0, yx = 0.0, yy = 0.0, yz = 0.0, zx = 0.0, zy = 0.0, zz = 0.0;
    for (int i = 0; i < shared->count; i++) {
        const double *l = a->levers + 3 * shared->places[2 * i], *m = b->levers + 3 * shared->places[2 * i + 1];
        xx += m[0] * l[0], xy += m[0] * l[1], xz += m[0] * l[2];
        yx += m[1] * l[0], yy += m[1] * l[1], yz += m[1] * l[2];
        zx += m[2] * l[0], zy += m[2] * l[1], zz += m[2] * l[2];
    }
    sums->between = xx + yy + zz;
    memcpy(sums->outer, (double[3][3]){{xx, xy, xz}, {yx, yy, yz}, {zx, zy, zz}}, sizeof sums->outer);
}

/* Add sum_j (l_j x f_r + t_r) . (m_j x g_s + u_s) over the shared columns, and the root's f_r . g_s. */
static void add_block(Frame *frame, const Shared *shared)
{
    const Problem *problem = frame->problem;
    const Pull *mine = frame->pulls + shared->task[0], *theirs = frame->pulls + shared->task[1];
    const Part *a = mine->part + shared->part[0], *b = theirs->part + shared->part[1];
    const int64_t rows = problem->task[shared->task[0]].rows, others = problem->task[shared->task[1]].rows;
    Sums sums;
    sum_levers(shared, a, b, &sums);
    const double between = sums.between + (a->root && b->root);
    if (a->plain && b->plain) { /* the world's axes on both sides: (l x e_r) . (m x e_s) = (l . m) [r = s] - m_r l_s */
        const double scale = a->force[0][0] * b->force[0][0];
        double *out = frame->G + mine->first_row * problem->rows + theirs->first_row;
        for (int r = 0; r < 3; r++, out += problem->rows)
            for (int s = 0; s < 3; s++)
                out[s] += scale * ((r == s ? between : 0.0) - sums.outer[r][s]);
        return;
    }
    for (int64_t r = 0; r < rows; r++) {
        const double *f = a->force[r], *t = a->torque[r];
        double pushed[3] = {0.0}, *out = frame->G + (mine->first_row + r) * problem->rows + theirs->first_row;
        /* (l x f) . (m x g) = (l . m) (f . g) - (m . f) (l . g) */
        for (int x = 0; x < 3 && a->has_force && b->has_force; x++)
            pushed[x] = between * f[x] - (sums.outer[0][x] * f[0] + sums.outer[1][x] * f[1] + sums.outer[2][x] * f[2]);
        if (a->has_torque && b->has_force) { /* t . (m x g) = g . (t x m) */
            double lever[3];
            cross(t, sums.m, lever);
            add_scaled(pushed, 1.0, lever);
        }
        for (int64_t s = 0; s < others && b->has_force; s++)
            out[s] += dot(pushed, b->force[s]);
        if (b->has_torque) {
            double twisted[3];
            cross(sums.l, f, twisted);
            add_scaled(twisted, shared->count, t);
            for (int64_t s = 0; s < others; s++)
                out[s] += dot(twisted, b->torque[s]);
        }
    }
}

/* G += sign times a hinge's rank-one part, in the rows that feel it. */
void add_hinge(const Frame *frame, int64_t h, double sign, double *G)
{
    const int64_t R = frame->problem->rows;
    const double *along = frame->hinge_rows + h * R;
    const int *felt = frame->hinge_felt + h * R;
    for (int i = 0; i < frame->hinge_felt_count[h]; i++) {
        const double factor = sign * along[felt[i]];
        double *row = G + felt[i] * R;
        for (int j = 0; j <= i; j++)
            row[felt[j]] += factor * along[felt[j]];
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
    for (int64_t h = 0; h < problem->hinges; h++)
        add_hinge(frame, h, 1.0, frame->G);
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
            double x = 0.0, y = 0.0, z = 0.0, twist[3] = {0.0};
            for (int i = 0; i < part->count && part->has_force; i++) {
                const double *w = v + 3 * part->columns[i], *l = part->levers + 3 * i;
                x += w[1] * l[2] - w[2] * l[1], y += w[2] * l[0] - w[0] * l[2], z += w[0] * l[1] - w[1] * l[0];
            }
            for (int i = 0; i < part->count && part->has_torque; i++)
                add_scaled(twist, 1.0, v + 3 * part->columns[i]);
            double moved[3] = {x, y, z};
            if (part->root)
                add_scaled(moved, 1.0, v + 3 * problem->columns);
            for (int64_t r = 0; r < problem->task[t].rows; r++)
                out[pull->first_row + r] += dot(part->force[r], moved) + dot(part->torque[r], twist);
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
                double turn[3] = {torque[0], torque[1], torque[2]}, *to = out + 3 * part->columns[i];
                if (part->has_force) {
                    double lever[3];
                    cross(part->levers + 3 * i, force, lever);
                    add_scaled(turn, 1.0, lever);
                }
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
