/* The iteration of one frame after another: layered_numpy.py and homing.py, frame by frame. */

#include "layered.h"
#include "rotations.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* As in layered_numpy.py and homing.py, where each is explained. */
#define LARGEST_TURN 0.5
#define STOP_STEP 1e-4
#define STOP_LEFT 2e-5
#define STOP_ERROR 1e-5
#define FULL_GAIN_ITERATIONS 8
#define GAIN_DECAY 0.85
#define ANNEALED_ITERATIONS 10
#define LIMIT_ROUNDS 4
#define ON_LIMIT 1e-12
#define LARGEST_TASK_SHARE 0.5
#define LARGEST_FACTOR 3.0
#define NO_CHANGE 1e-24
/* Metres and radians: what is less is rounding. */
#define AT_REST 1e-13

static double length(const double *v, int64_t n)
{
    double sum = 0.0;
    for (int64_t i = 0; i < n; i++)
        sum += v[i] * v[i];
    return sqrt(sum);
}

static int64_t unknowns(const Frame *frame)
{
    return 3 * frame->problem->columns + 3;
}

/* v <- v P, what no layer sees: v - Q^T (Q v). Hinges on their limits take no part. */
static void off_layers(Frame *frame, double *v)
{
    double *y = frame->scratch_rows + 2 * frame->problem->rows;
    rows_times(frame, v, y);
    into_rank_space(frame, y, frame->scratch_rank);
    for (int64_t q = 0; q < frame->problem->rows; q++)
        frame->scratch_rank[q] = -frame->scratch_rank[q];
    out_of_rank_space(frame, frame->scratch_rank, y);
    add_rows_transposed(frame, y, v);
}

/* v on the hinges' axes; 0 where they are on their limits. */
static void on_free_axes(const Frame *frame, double *v)
{
    for (int64_t h = 0; h < frame->problem->hinges; h++) {
        const double *axis = frame->hinge_axes + 3 * h;
        double *w = v + 3 * frame->problem->hinge[h].column;
        const double along = frame->hinge_free[h] ? dot(w, axis) : 0.0;
        for (int a = 0; a < 3; a++)
            w[a] = along * axis[a];
    }
}

/* home = z - Q^T (Q z), where Q z was found for the hinges that are free. */
static void pull_home(Frame *frame)
{
    const Problem *problem = frame->problem;
    double *y = frame->scratch_rows + 2 * problem->rows;
    memcpy(frame->home, frame->z, sizeof *frame->z * unknowns(frame));
    on_free_axes(frame, frame->home);
    for (int64_t q = 0; q < problem->rows; q++)
        frame->scratch_rank[q] = -frame->Qz[q];
    out_of_rank_space(frame, frame->scratch_rank, y);
    add_rows_transposed(frame, y, frame->home);
}

/* Q z with the hinges that are free, from J z with all of them: a hinge's part is its row times its turn. */
static void pull_in_rank_space(Frame *frame, const double *Jz)
{
    const Problem *problem = frame->problem;
    double *rest = frame->scratch_rows + 2 * problem->rows;
    memcpy(rest, Jz, sizeof *rest * problem->rows);
    for (int64_t h = 0; h < problem->hinges; h++) {
        const double turn = dot(frame->z + 3 * problem->hinge[h].column, frame->hinge_axes + 3 * h);
        if (!frame->hinge_free[h])
            add_multiple(rest, -turn, frame->hinge_rows + h * problem->rows, (int)problem->rows);
    }
    into_rank_space(frame, rest, frame->Qz);
}

/* Where a turn takes a hinge (rad), and how far beyond its limits that is. */
static double beyond(const Frame *frame, int64_t h, double turn, double *limited)
{
    const Hinge *hinge = frame->problem->hinge + h;
    const double after = frame->hinge_angles[h] + turn;
    *limited = smaller(larger(after, hinge->limits[0]), hinge->limits[1]);
    return fabs(after - *limited);
}

/* Set on their limits the hinges that fixed + gain z + J^T y would take beyond them; returns whether there were any. */
static int set_on_limits(Frame *frame, double gain, const double *y)
{
    const Problem *problem = frame->problem;
    int out = 0;
    for (int64_t h = 0; h < problem->hinges; h++) {
        if (!frame->hinge_free[h])
            continue;
        double limited;
        const double pull = dot(frame->z + 3 * problem->hinge[h].column, frame->hinge_axes + 3 * h);
        const double *row = frame->hinge_rows + h * problem->rows;
        if (beyond(frame, h, gain * pull + dot_product(row, y, (int)problem->rows), &limited) > ON_LIMIT) {
            frame->hinge_fixed[h] = limited - frame->hinge_angles[h];
            frame->hinge_free[h] = 0;
            out = 1;
        }
    }
    return out;
}

/* Descend, and again with hinges that would leave their limits set on them; Q z and the step come out:

   step = fixed hinges + gain z + Q^T (c - gain Q z) = fixed hinges + gain z + J^T y */
static void descend_within_limits(Frame *frame, double gain, double anneal)
{
    const Problem *problem = frame->problem;
    double *y = frame->scratch_rows + 3 * problem->rows, *Jz = y + problem->rows, *step = frame->step;
    /* At first the reference is where the frame starts. */
    const int pulls = length(frame->z, unknowns(frame)) > AT_REST;
    memset(frame->hinge_free, 1, problem->hinges);
    memset(frame->hinge_fixed, 0, sizeof *frame->hinge_fixed * problem->hinges);
    memset(frame->Qz, 0, sizeof *frame->Qz * problem->rows);
    if (pulls)
        rows_times(frame, frame->z, Jz);
    for (int round = 0;; round++) {
        descend(frame, anneal);
        if (pulls)
            pull_in_rank_space(frame, Jz);
        for (int64_t q = 0; q < problem->rows; q++)
            frame->scratch_rank[q] = frame->c[q] - gain * frame->Qz[q];
        out_of_rank_space(frame, frame->scratch_rank, y);
        if (round == LIMIT_ROUNDS || !set_on_limits(frame, gain, y))
            break;
    }
    memcpy(step, frame->z, sizeof *step * unknowns(frame));
    on_free_axes(frame, step);
    for (int64_t i = 0; i < unknowns(frame); i++)
        step[i] *= gain;
    add_rows_transposed(frame, y, step);
    for (int64_t h = 0; h < problem->hinges; h++)
        if (!frame->hinge_free[h])
            add_scaled(step + 3 * problem->hinge[h].column, frame->hinge_fixed[h], frame->hinge_axes + 3 * h);
}

/* The length of Q^T c and the fixed hinges, which are orthogonal. */
static double task_length(const Frame *frame)
{
    double sum = 0.0;
    const Layer *last = frame->layers + frame->problem->layers - 1;
    for (int q = 0; q < last->first_rank + last->rank; q++)
        sum += frame->c[q] * frame->c[q];
    for (int64_t h = 0; h < frame->problem->hinges; h++)
        sum += frame->hinge_fixed[h] * frame->hinge_fixed[h];
    return sqrt(sum);
}

/* homing.py: a secant step for the pull where it applies and leaves every hinge within its limits. */
static void accelerate(Frame *frame, double gain, double task)
{
    const Problem *problem = frame->problem;
    const int64_t n = unknowns(frame);
    double size = 0.0, along = 0.0;
    for (int64_t i = 0; i < n; i++) {
        const double change = frame->home[i] - frame->home_before[i];
        size += change * change, along += frame->home[i] * change;
        frame->fast[i] = frame->step_before[i] + change;
    }
    const double home = length(frame->home, n);
    if (size <= NO_CHANGE || !(task < LARGEST_TASK_SHARE * home))
        return;
    on_free_axes(frame, frame->fast);
    off_layers(frame, frame->fast);
    for (int64_t i = 0; i < n; i++)
        frame->fast[i] = frame->home[i] - along / size * frame->fast[i];
    const double factor = smaller(1.0, LARGEST_FACTOR * home / larger(length(frame->fast, n), 1e-300));
    /* step + gain (fast - home) */
    for (int64_t i = 0; i < n; i++)
        frame->fast[i] = frame->step[i] + gain * (factor * frame->fast[i] - frame->home[i]);
    for (int64_t h = 0; h < problem->hinges; h++) {
        double limited;
        const double turn = dot(frame->fast + 3 * problem->hinge[h].column, frame->hinge_axes + 3 * h);
        if (frame->hinge_free[h] && beyond(frame, h, turn, &limited) > ON_LIMIT)
            return;
    }
    memcpy(frame->step, frame->fast, sizeof *frame->step * n);
}

/* Scale the step so that no joint turns further than LARGEST_TURN; returns the largest turn. */
static double bound_turns(Frame *frame)
{
    double largest = 0.0;
    for (int64_t k = 0; k < frame->problem->columns; k++)
        largest = larger(largest, dot(frame->step + 3 * k, frame->step + 3 * k));
    largest = sqrt(largest);
    if (largest <= LARGEST_TURN)
        return largest;
    for (int64_t i = 0; i < unknowns(frame); i++)
        frame->step[i] *= LARGEST_TURN / largest;
    return LARGEST_TURN;
}

/* Remember the pull and the step where the next iteration may compare with them: see homing.py. */
static void remember(Frame *frame, double task, int has_home)
{
    const int64_t n = unknowns(frame);
    frame->remembers = task < LARGEST_TASK_SHARE * length(frame->step, n);
    if (!frame->remembers)
        return;
    if (!has_home)
        pull_home(frame);
    memcpy(frame->home_before, frame->home, sizeof *frame->home * n);
    memcpy(frame->step_before, frame->step, sizeof *frame->step * n);
    memcpy(frame->hinge_free_before, frame->hinge_free, frame->problem->hinges);
}

/* Whether every layer is met to STOP_ERROR. */
static int are_met(const Frame *frame)
{
    for (int l = 0; l < frame->problem->layers; l++)
        if (!(length(frame->errors + frame->layers[l].first_row, frame->layers[l].rows) < STOP_ERROR))
            return 0;
    return 1;
}

/* Whether nothing is left to do: every layer met, the reference reached, to rounding, and hinges within limits. */
static int is_at_rest(const Frame *frame)
{
    const Problem *problem = frame->problem;
    if (length(frame->errors, problem->rows) > AT_REST || length(frame->z, unknowns(frame)) > AT_REST)
        return 0;
    for (int64_t h = 0; h < problem->hinges; h++) {
        const double angle = frame->hinge_angles[h], *limits = problem->hinge[h].limits;
        if (angle < limits[0] - ON_LIMIT || angle > limits[1] + ON_LIMIT)
            return 0;
    }
    return 1;
}

static void solve_frame(Frame *frame, int64_t at)
{
    const Problem *problem = frame->problem;
    const int64_t own = problem->frames[at];
    double *local = problem->rotations + 4 * problem->joints * own;
    double *translations = problem->translations + 3 * problem->translated * own;
    double before = 0.0;
    int nearly = 0;
    frame->remembers = 0;
    problem->converged[at] = 0, problem->iterations[at] = 0;
    for (int64_t iteration = 0; iteration < problem->max_iterations || nearly; iteration++) {
        forward(frame, local, translations);
        hinge_state(frame, local);
        evaluate_tasks(frame, local, at);
        if (nearly && are_met(frame)) {
            problem->converged[at] = 1;
            return;
        }
        if (iteration == problem->max_iterations)
            return;
        const int64_t left_over = problem->max_iterations - ANNEALED_ITERATIONS - iteration - 1;
        const double anneal = left_over < 0 ? ldexp(1.0, (int)left_over) : 1.0;
        double gain = problem->attraction * anneal;
        for (int64_t i = FULL_GAIN_ITERATIONS; i < iteration + 1; i++)
            gain *= GAIN_DECAY;
        attraction(frame, local, translations, own);
        gram(frame);
        double moved = 0.0;
        if (is_at_rest(frame)) { /* for its ranks alone */
            memset(frame->hinge_free, 1, problem->hinges);
            memset(frame->errors, 0, sizeof *frame->errors * problem->rows);
            descend(frame, anneal);
        } else {
            descend_within_limits(frame, gain, anneal);
            const double task = task_length(frame);
            const int compares =
                frame->remembers && !memcmp(frame->hinge_free, frame->hinge_free_before, problem->hinges);
            if (compares) {
                pull_home(frame);
                accelerate(frame, gain, task);
            }
            moved = bound_turns(frame);
            remember(frame, task, compares);
            moved = larger(moved, apply_step(frame, local, translations));
        }
        problem->iterations[at] = iteration + 1;
        for (int l = 0; l < problem->layers; l++)
            problem->ranks[at * problem->layers + l] = frame->layers[l].rank;
        if (moved < STOP_STEP) {
            problem->converged[at] = 1;
            return;
        }
        const double ratio = moved / larger(before, 1e-300);
        nearly = ratio < 0.5 && moved * ratio / (1.0 - ratio) < STOP_LEFT;
        before = moved;
    }
}

/* Give a frame its memory, all in one piece; counts it where there is none yet. */
static size_t lay_out(Frame *frame, char *memory)
{
    const Problem *problem = frame->problem;
    const size_t nodes = problem->nodes, R = problem->rows, H = problem->hinges, n = unknowns(frame);
    size_t needed = 0;
    char **from = &memory;
#define NUMBERS(count) take(from, &needed, sizeof(double) * (count))
    frame->positions = NUMBERS(3 * nodes), frame->rotations = NUMBERS(9 * nodes);
    frame->mass_moments = NUMBERS(3 * nodes), frame->mass_shares = NUMBERS(nodes);
    frame->hinge_axes = NUMBERS(3 * H), frame->hinge_angles = NUMBERS(H), frame->hinge_rows = NUMBERS(H * R);
    frame->hinge_fixed = NUMBERS(H);
    frame->errors = NUMBERS(R), frame->G = NUMBERS(R * R), frame->G_frozen = NUMBERS(R * R), frame->C = NUMBERS(R * R);
    frame->c = NUMBERS(R), frame->scratch_rows = NUMBERS(5 * R), frame->scratch_rank = NUMBERS(R),
    frame->Qz = NUMBERS(R);
    frame->algebra = NUMBERS(R * R + R + factor_scratch((int)R));
    frame->z = NUMBERS(n), frame->home = NUMBERS(n), frame->step = NUMBERS(n), frame->fast = NUMBERS(n);
    frame->home_before = NUMBERS(n), frame->step_before = NUMBERS(n);
    frame->hinge_free = take(from, &needed, H), frame->hinge_free_before = take(from, &needed, H);
    frame->column_hinge = take(from, &needed, sizeof(int) * problem->columns);
    frame->layers = take(from, &needed, sizeof(Layer) * problem->layers);
    double *B = NUMBERS(R * R);
    int *order = take(from, &needed, sizeof(int) * R);
#undef NUMBERS
    if (memory != NULL) {
        memset(frame->c, 0, sizeof(double) * R), memset(frame->scratch_rank, 0, sizeof(double) * R);
        memset(frame->Qz, 0, sizeof(double) * R);
        for (int64_t k = 0; k < problem->columns; k++)
            frame->column_hinge[k] = -1;
        for (int64_t h = 0; h < problem->hinges; h++)
            frame->column_hinge[problem->hinge[h].column] = (int)h;
        int row = 0, t = 0;
        for (int l = 0; l < problem->layers; l++) {
            Layer *layer = frame->layers + l;
            *layer = (Layer){row, 0, 0, 0, 0, order + row, B + row * R};
            for (; t < problem->tasks && problem->task[t].layer == l; t++)
                row += (int)problem->task[t].rows;
            layer->rows = row - layer->first_row;
        }
        frame->weighs = 0;
        for (int64_t i = 0; i < problem->tasks; i++)
            frame->weighs |= problem->task[i].kind == CENTER_OF_MASS;
    }
    lay_out_tasks(frame, from, &needed);
    return needed;
}

/* eq. (4): what the columns move starts where the frame before ended. */
static void start_where_the_last_ended(const Problem *problem, int64_t at)
{
    at = problem->frames[at];
    double *here = problem->rotations + 4 * problem->joints * at;
    for (int64_t k = 0; k < problem->columns; k++) {
        const int64_t joint = problem->node[problem->column_node[k]].joint;
        memcpy(here + 4 * joint, here + 4 * (joint - problem->joints), 4 * sizeof *here);
    }
    if (problem->moves_root && problem->root >= 0) {
        const int64_t place = problem->node[problem->root].translation;
        double *root = problem->translations + 3 * (problem->translated * at + place);
        memcpy(root, root - 3 * problem->translated, 3 * sizeof *root);
    }
}

int solve_frames(const Problem *problem, int64_t begin, int64_t end)
{
    Frame frame = {.problem = problem};
    char *memory = malloc(lay_out(&frame, NULL));
    if (memory == NULL)
        return -1;
    lay_out(&frame, memory);
    for (int64_t at = begin; at < end; at++) {
        if (problem->in_order && at > 0)
            start_where_the_last_ended(problem, at);
        if (!problem->converged[at])
            solve_frame(&frame, at);
    }
    free(memory);
    return 0;
}
