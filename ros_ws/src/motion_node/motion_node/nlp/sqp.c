/* SPDX-License-Identifier: Apache-2.0
 *
 * The loop of sqp.py in C, around the machine code that casadi generated for the constraints.
 */
#include "quadratic.c"

#include <stdlib.h>

typedef int (*Constraints)(const double **, double **, long long *, double *, int);

typedef struct {
    Shape shape;
    Constraints constraints; /* (z, p) -> (values, Jacobian's entries) */
    int arguments, results, integers, reals; /* the room that it needs */
    int entries;                             /* of the Jacobian */
    int most;                                /* steps */
    double tolerance, step_tolerance, trust;
} Problem;

/* By how much a value is outside at most; infinite if it is none. */
static double outside(int count, const double *values, const double *lower, const double *upper) {
    double worst = 0.0;
    for (int i = 0; i < count; ++i) {
        if (isnan(values[i])) return INFINITY;
        worst = fmax(worst, fmax(lower[i] - values[i], values[i] - upper[i]));
    }
    return worst;
}

static int infinite(int count, const double *values) {
    for (int i = 0; i < count; ++i)
        if (!isfinite(values[i])) return 1;
    return 0;
}

/* Solves from z, which becomes where it converged or gave up; `values` are those there.
 *
 * linear: cost; lower, upper: of the constraints, then of the unknowns.
 * Returns the number of steps, or -1 without memory. */
int sqp(const Problem *problem, const double *p, const double *linear, const double *lower,
        const double *upper, double *z, double *values) {
    const Shape *shape = &problem->shape;
    const int n = shape->variables, rows = shape->rows, all = n + rows;
    const size_t square = (size_t)n * n;
    const size_t reals = problem->reals + problem->entries + 2 * square + (9 + shape->block) * n
        + 2 * all;
    double *room = malloc(reals * sizeof(double));
    int *indices = malloc((size_t)(3 * n + all) * sizeof(int));
    long long *integers = malloc((problem->integers + 1) * sizeof(long long));
    const double **arguments = malloc((problem->arguments + 2) * sizeof(double *));
    double **results = malloc((problem->results + 2) * sizeof(double *));
    int taken = -1;
    if (!room || !indices || !integers || !arguments || !results) goto end;
    double *work = room, *jacobian = work + problem->reals, *x = jacobian + problem->entries;
    double *low = x + n, *high = low + all;
    Active active = {.row = indices, .where = indices + n};
    active.sign = high + all;
    active.multiplier = active.sign + n;
    active.part = active.multiplier + n;
    active.share = active.part + n;
    active.direction = active.share + n;
    active.across = active.direction + n;
    active.factor = active.across + n;
    active.freedom.start = active.where + all;
    active.freedom.size = active.freedom.start + n;
    active.freedom.factor = active.factor + square;
    active.freedom.basis = active.freedom.factor + square;
    active.freedom.y = active.freedom.basis + (size_t)shape->block * n;
    double *gradient = active.freedom.y + n;
    double step = INFINITY, trust = problem->trust;
    for (taken = 0;; ++taken) {
        arguments[0] = z;
        arguments[1] = p;
        results[0] = values;
        results[1] = jacobian;
        problem->constraints(arguments, results, integers, work, 0);
        const int holds = outside(rows, values, lower, upper) < problem->tolerance / 2;
        if ((step < problem->step_tolerance && holds) || taken == problem->most ||
            infinite(rows, values) || infinite(problem->entries, jacobian))
            break;
        for (int row = 0; row < rows; ++row) {
            low[row] = lower[row] - values[row];
            high[row] = upper[row] - values[row];
        }
        for (int i = 0; i < n; ++i) {
            low[rows + i] = fmax(lower[rows + i] - z[i], -trust);
            high[rows + i] = fmin(upper[rows + i] - z[i], trust);
            gradient[i] = linear[i];
        }
        times(shape, z, gradient);
        if (!quadratic(shape, jacobian, gradient, low, high, &active, x)) break;
        /* Without the constraints' curvature, steps can go to and fro; shorter ones settle. A step
         * that ends at a limit of half the one before has done its part: rounding must not decide
         * whether it is cut again. */
        const double before = step;
        step = 0.0;
        for (int i = 0; i < n; ++i) {
            step = fmax(step, fabs(x[i]));
            z[i] += x[i];
        }
        if (step > before / 2 * (1 + 1e-9)) trust = step / 2;
    }
end:
    free(room);
    free(indices);
    free(integers);
    free(arguments);
    free(results);
    return taken;
}
