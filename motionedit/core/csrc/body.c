/* The body of one frame: forward kinematics, the pull z of eq. (1), hinges, and the step put into the joints. */

#include "layered.h"
#include "rotations.h"

#include <math.h>
#include <string.h>

static const double IDENTITY[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};

const double *parent_rotation(const Frame *frame, int64_t node)
{
    const int64_t parent = frame->problem->node[node].parent;
    return parent < 0 ? IDENTITY : frame->rotations + 9 * parent;
}

/* The moment (share times centre) of all mass at and below each node, and its share of the whole. */
static void weigh(Frame *frame)
{
    const Problem *problem = frame->problem;
    double *moments = frame->mass_moments, *shares = frame->mass_shares;
    for (int64_t i = 0; i < problem->nodes; i++) {
        const Node *node = problem->node + i;
        double arm[3];
        shares[i] = node->share;
        if (node->share == 0.0) {
            memset(moments + 3 * i, 0, 3 * sizeof *moments);
            continue;
        }
        turned(frame->rotations + 9 * i, node->center, arm);
        for (int a = 0; a < 3; a++)
            moments[3 * i + a] = node->share * (frame->positions[3 * i + a] + arm[a]);
    }
    memset(frame->center, 0, sizeof frame->center);
    for (int64_t i = problem->nodes - 1; i >= 0; i--) {
        const int64_t parent = problem->node[i].parent;
        if (parent >= 0) {
            shares[parent] += shares[i];
            add_scaled(moments + 3 * parent, 1.0, moments + 3 * i);
        } else
            add_scaled(frame->center, 1.0, moments + 3 * i);
    }
}

/* World transforms: p_j = p_parent + R_parent t_j, R_j = R_parent R_local.

   local: shape (J, 4), translations: shape (P, 3). */
void forward(Frame *frame, const double *local, const double *translations)
{
    const Problem *problem = frame->problem;
    for (int64_t i = 0; i < problem->nodes; i++) {
        const Node *node = problem->node + i;
        const double *offset = node->translation < 0 ? node->offset : translations + 3 * node->translation;
        double *position = frame->positions + 3 * i;
        if (node->parent < 0) {
            memcpy(position, offset, 3 * sizeof *position);
            matrix_of(local + 4 * node->joint, frame->rotations + 9 * i);
            continue;
        }
        const double *above = frame->rotations + 9 * node->parent;
        double own[9];
        turned(above, offset, position);
        add_scaled(position, 1.0, frame->positions + 3 * node->parent);
        matrix_of(local + 4 * node->joint, own);
        matrix_product(above, own, frame->rotations + 9 * i);
    }
    if (frame->weighs)
        weigh(frame);
}

/* A node's world rotation as a quaternion: what orientations are compared by. */
void world_quaternion(const Frame *frame, const double *local, int64_t node, double *q)
{
    memcpy(q, local + 4 * frame->problem->node[node].joint, 4 * sizeof *q);
    for (int64_t i = frame->problem->node[node].parent; i >= 0; i = frame->problem->node[i].parent)
        q_multiply(local + 4 * frame->problem->node[i].joint, q, q);
}

/* z at frame `own` of the motion: the world-axis increments that bring the columns back to the reference, hinges along
   their axes alone. */
void attraction(Frame *frame, const double *local, const double *translations, int64_t own)
{
    const Problem *problem = frame->problem;
    const double *reference = problem->reference_rotations + 4 * problem->joints * own;
    double *root = frame->z + 3 * problem->columns;
    for (int64_t k = 0; k < problem->columns; k++) {
        const int64_t i = problem->column_node[k];
        const int64_t joint = problem->node[i].joint;
        const int h = frame->column_hinge[k];
        double inverse[4], turn[4], *z = frame->z + 3 * k;
        q_conjugate(local + 4 * joint, inverse);
        q_multiply(reference + 4 * joint, inverse, turn);
        q_log(turn, turn);
        turned(parent_rotation(frame, i), turn, z);
        if (h >= 0) {
            const double *axis = frame->hinge_axes + 3 * h, along = dot(z, axis);
            for (int a = 0; a < 3; a++)
                z[a] = along * axis[a];
        }
    }
    memset(root, 0, 3 * sizeof *root);
    if (problem->pulls_root && problem->root >= 0) {
        const double *goal = problem->reference_root + 3 * own;
        const double *place = translations + 3 * problem->node[problem->root].translation;
        const double back[3] = {goal[0] - place[0], goal[1] - place[1], goal[2] - place[2]};
        turned(parent_rotation(frame, problem->root), back, root);
    }
}

/* The hinges' axes in the world (a turn about an axis leaves it where the parent has it) and angles (rad). */
void hinge_state(Frame *frame, const double *local)
{
    const Problem *problem = frame->problem;
    for (int64_t h = 0; h < problem->hinges; h++) {
        const Hinge *hinge = problem->hinge + h;
        const int64_t i = problem->column_node[hinge->column];
        double v[4];
        turned(parent_rotation(frame, i), hinge->axis, frame->hinge_axes + 3 * h);
        q_log(local + 4 * problem->node[i].joint, v);
        frame->hinge_angles[h] = dot(v, hinge->axis);
    }
}

/* Turn the columns by the step, q <- exp(R_parent^-1 w) q, and shift the root; returns the root's way. */
double apply_step(Frame *frame, double *local, double *translations)
{
    const Problem *problem = frame->problem;
    for (int64_t k = 0; k < problem->columns; k++) {
        const double *w = frame->step + 3 * k;
        if (dot(w, w) == 0.0)
            continue;
        const int64_t i = problem->column_node[k];
        double v[3], turn[4], *q = local + 4 * problem->node[i].joint;
        turned_back(parent_rotation(frame, i), w, v);
        q_exp(v, turn);
        q_multiply(turn, q, q);
        /* 1 / sqrt(1 + x) to second order: x is rounding */
        const double size = 1.5 - 0.5 * (q[0] * q[0] + dot(q + 1, q + 1));
        for (int a = 0; a < 4; a++)
            q[a] *= size;
    }
    if (problem->root < 0)
        return 0.0;
    const double *shift = frame->step + 3 * problem->columns;
    double own[3];
    turned_back(parent_rotation(frame, problem->root), shift, own);
    add_scaled(translations + 3 * problem->node[problem->root].translation, 1.0, own);
    return sqrt(dot(shift, shift));
}
