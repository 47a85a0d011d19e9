/* SPDX-License-Identifier: Apache-2.0
 *
 * What inverse_kinematics.py says, for one configuration after the other, around the machine code
 * that casadi generated for the hand.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef int (*Hand)(const double **, double **, long long *, double *, int);

static double clipped(double value, double least, double most) {
    return value < least ? least : value > most ? most : value;
}

/* y = (J J' + damping I)^-1 residual, for J by columns; `gram` is room for a square of rows. */
static void pulled(int rows, int joints, const double *jacobian, double damping, double *gram,
                   double *y) {
    for (int i = 0; i < rows; ++i)
        for (int k = 0; k <= i; ++k) {
            double sum = i == k ? damping : 0.0;
            for (int j = 0; j < joints; ++j) sum += jacobian[j * rows + i] * jacobian[j * rows + k];
            for (int m = 0; m < k; ++m) sum -= gram[i * rows + m] * gram[k * rows + m];
            gram[i * rows + k] = i == k ? sqrt(sum) : sum / gram[k * rows + k];
        }
    for (int i = 0; i < rows; ++i) {
        for (int k = 0; k < i; ++k) y[i] -= gram[i * rows + k] * y[k];
        y[i] /= gram[i * rows + i];
    }
    for (int i = rows - 1; i >= 0; --i) {
        for (int k = i + 1; k < rows; ++k) y[i] -= gram[k * rows + i] * y[k];
        y[i] /= gram[i * rows + i];
    }
}

/* Moves configurations q until the hand's rows are the targets, or the iterations are spent.
 *
 * sizes: the room that the hand's function needs: arguments, results, integers, reals.
 * Returns 0, or -1 without memory. */
int inverse(Hand hand, const int *sizes, int count, int joints, int rows, const double *targets,
            const double *lower, const double *upper, int iterations, double tolerance,
            double damping, double longest, double *q) {
    const size_t reals = (size_t)sizes[3] + rows * (1 + joints + rows);
    double *room = malloc(reals * sizeof(double));
    long long *integers = malloc((sizes[2] + 1) * sizeof(long long));
    const double **arguments = malloc((sizes[0] + 1) * sizeof(double *));
    double **results = malloc((sizes[1] + 2) * sizeof(double *));
    int result = -1;
    if (!room || !integers || !arguments || !results) goto end;
    double *y = room + sizes[3], *jacobian = y + rows, *gram = jacobian + rows * joints;
    for (int c = 0; c < count; ++c, q += joints, targets += rows) {
        for (int turn = 0; turn < iterations; ++turn) {
            arguments[0] = q;
            results[0] = y;
            results[1] = jacobian;
            hand(arguments, results, integers, room, 0);
            double far = 0.0;
            for (int i = 0; i < rows; ++i) {
                y[i] -= targets[i];
                far = fmax(far, fabs(y[i]));
            }
            if (far < tolerance) break;
            pulled(rows, joints, jacobian, damping, gram, y);
            for (int j = 0; j < joints; ++j) {
                double step = 0.0;
                for (int i = 0; i < rows; ++i) step += jacobian[j * rows + i] * y[i];
                q[j] = clipped(q[j] - clipped(step, -longest, longest), lower[j], upper[j]);
            }
        }
    }
    result = 0;
end:
    free(room);
    free(integers);
    free(arguments);
    free(results);
    return result;
}
