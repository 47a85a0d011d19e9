/* SPDX-License-Identifier: Apache-2.0
 *
 * min over x   x' H x / 2 + g' x   s.t.   lower <= A x <= upper,  least <= x <= most
 *
 * for a constant, positive definite H and sparse rows A, by the dual active-set method of Goldfarb
 * and Idnani (1983) in the space of the active rows: with the inverse of H known beforehand, all
 * that is factorised is N' H^-1 N of the few active rows N, row by row as they come and go. Rows
 * that are equations become active first, all the others when they are violated most.
 */
#include <math.h>
#include <string.h>

/* A violation this small counts as none [m or rad]. */
#define NONE 1e-9
/* A row whose part beyond the active ones is this share of it depends on them. */
#define DEPENDENT 1e-10
/* Equations that depend on others contradict them if they miss more than this [m or rad]. */
#define CONTRADICTION 1e-6

typedef struct {
    int variables, rows;
    const double *inverse;             /* of H, by rows */
    const int *begin, *column, *place; /* of each row's entries, and where a Jacobian has them */
} Shape;

typedef struct {
    int count;        /* of active rows */
    int *row, *where; /* which they are; of each row, -1 or where it is among them */
    double *sign;     /* 1 at its lower bound, -1 at its upper one */
    double *multiplier;
    double *pushed; /* H^-1 n of each of them, by rows */
    double *factor; /* lower triangular, by rows of `variables` entries */
    double *part, *share, *direction, *across;
} Active;

static double dot(int count, const double *left, const double *right) {
    double sum = 0.0;
#pragma omp simd reduction(+ : sum)
    for (int i = 0; i < count; ++i) sum += left[i] * right[i];
    return sum;
}

static void add(int count, double *target, double factor, const double *more) {
#pragma omp simd
    for (int i = 0; i < count; ++i) target[i] += factor * more[i];
}

/* Of a row, or behind the rows of a variable. */
static double row_times(const Shape *shape, const double *jacobian, int row, const double *x) {
    if (row >= shape->rows) return x[row - shape->rows];
    double sum = 0.0;
    for (int e = shape->begin[row]; e < shape->begin[row + 1]; ++e)
        sum += jacobian[shape->place[e]] * x[shape->column[e]];
    return sum;
}

/* H^-1 n, of the row with a sign. */
static void push(const Shape *shape, const double *jacobian, int row, double sign, double *out) {
    const int n = shape->variables;
    memset(out, 0, n * sizeof(double));
    if (row >= shape->rows) {
        add(n, out, sign, shape->inverse + (size_t)(row - shape->rows) * n);
        return;
    }
    for (int e = shape->begin[row]; e < shape->begin[row + 1]; ++e)
        add(n, out, sign * jacobian[shape->place[e]],
            shape->inverse + (size_t)shape->column[e] * n);
}

/* The active row with an index leaves: the rows of the factor below it move up, rotated. */
static void leave(const Shape *shape, Active *active, int index) {
    const int n = shape->variables, last = active->count - 1;
    active->where[active->row[index]] = -1;
    for (int i = index; i < last; ++i) {
        double *row = active->factor + (size_t)i * n;
        memcpy(row, row + n, (i + 2) * sizeof(double));
        memcpy(active->pushed + (size_t)i * n, active->pushed + (size_t)(i + 1) * n,
               n * sizeof(double));
        active->row[i] = active->row[i + 1];
        active->where[active->row[i]] = i;
        active->sign[i] = active->sign[i + 1];
        active->multiplier[i] = active->multiplier[i + 1];
    }
    for (int k = index; k < last; ++k) {
        double *row = active->factor + (size_t)k * n;
        const double length = hypot(row[k], row[k + 1]);
        const double c = row[k] / length, s = row[k + 1] / length;
        row[k] = length;
        row[k + 1] = 0.0;
        for (int i = k + 1; i < last; ++i) {
            double *below = active->factor + (size_t)i * n;
            const double left = below[k], right = below[k + 1];
            below[k] = c * left + s * right;
            below[k + 1] = c * right - s * left;
        }
    }
    active->count = last;
}

/* Of a row that may become active, what pushes against it, and that in terms of the active ones.
 * Returns how far a unit of what is left across these goes; 0: the row depends on them. */
static double look(const Shape *shape, Active *active, const double *jacobian, int row,
                   double sign) {
    double *part = active->part;
    push(shape, jacobian, row, sign, active->across);
    for (int i = 0; i < active->count; ++i) {
        const double *factor = active->factor + (size_t)i * shape->variables;
        const double own =
            active->sign[i] * row_times(shape, jacobian, active->row[i], active->across);
        part[i] = (own - dot(i, factor, part)) / factor[i];
    }
    const double whole = sign * row_times(shape, jacobian, row, active->across);
    const double left = whole - dot(active->count, part, part);
    return active->count < shape->variables && left > DEPENDENT * whole ? left : 0.0;
}

/* share = L^-T share, for the factor L. */
static void back(const Shape *shape, const Active *active, double *share) {
    for (int i = active->count - 1; i >= 0; --i) {
        const double *factor = active->factor + (size_t)i * shape->variables;
        share[i] /= factor[i];
        add(i, share, -share[i], factor);
    }
}

/* Of the row that was looked at last, what a unit costs each active one, and its direction. */
static void spread(const Shape *shape, Active *active) {
    const int n = shape->variables;
    memcpy(active->share, active->part, active->count * sizeof(double));
    back(shape, active, active->share);
    memcpy(active->direction, active->across, n * sizeof(double));
    for (int i = 0; i < active->count; ++i)
        add(n, active->direction, -active->share[i], active->pushed + (size_t)i * n);
}

/* The row that was looked at last becomes active. */
static void join(const Shape *shape, Active *active, int row, double sign, double left,
                 double multiplier) {
    const int n = shape->variables, count = active->count;
    double *factor = active->factor + (size_t)count * n;
    memcpy(factor, active->part, count * sizeof(double));
    factor[count] = sqrt(left);
    memcpy(active->pushed + (size_t)count * n, active->across, n * sizeof(double));
    active->row[count] = row;
    active->where[row] = count;
    active->sign[count] = sign;
    active->multiplier[count] = multiplier;
    active->count = count + 1;
}

/* All equations become active, and hold at x. Returns 0 if they contradict one another. */
static int equations(const Shape *shape, const double *jacobian, const double *lower,
                     const double *upper, Active *active, double *x) {
    const int n = shape->variables, all = shape->rows + n;
    double *share = active->share;
    for (int row = 0; row < all; ++row) {
        if (lower[row] < upper[row]) continue;
        const double left = look(shape, active, jacobian, row, 1.0);
        if (left == 0.0) continue;
        const double missing = lower[row] - row_times(shape, jacobian, row, x);
        share[active->count] =
            (missing - dot(active->count, active->part, share)) / sqrt(left);
        join(shape, active, row, 1.0, left, 0.0);
    }
    back(shape, active, share);
    for (int i = 0; i < active->count; ++i)
        add(n, x, share[i], active->pushed + (size_t)i * n);
    for (int row = 0; row < all; ++row) {
        if (lower[row] < upper[row] || active->where[row] >= 0) continue;
        if (fabs(lower[row] - row_times(shape, jacobian, row, x)) > CONTRADICTION) return 0;
    }
    return 1;
}

/* From the minimum x without constraints to that with them. `lower` and `upper` are those of the
 * rows, then of the variables. Returns 0 if the constraints contradict one another. */
static int quadratic(const Shape *shape, const double *jacobian, const double *lower,
                     const double *upper, Active *active, double *x) {
    const int n = shape->variables, all = shape->rows + n;
    active->count = 0;
    for (int row = 0; row < all; ++row) active->where[row] = -1;
    if (!equations(shape, jacobian, lower, upper, active, x)) return 0;
    const int always = active->count;
    for (int turn = 0; turn < 20 * all; ++turn) {
        int worst = -1;
        double sign = 1.0, missing = NONE;
        for (int row = 0; row < all; ++row) {
            if (active->where[row] >= 0 || !(lower[row] < upper[row])) continue;
            const double value = row_times(shape, jacobian, row, x);
            if (lower[row] - value > missing) {
                missing = lower[row] - value;
                worst = row;
                sign = 1.0;
            }
            if (value - upper[row] > missing) {
                missing = value - upper[row];
                worst = row;
                sign = -1.0;
            }
        }
        if (worst < 0) return 1;
        double multiplier = 0.0;
        for (;;) {
            const double left = look(shape, active, jacobian, worst, sign);
            spread(shape, active);
            double most = INFINITY;
            int leaving = -1;
            for (int i = always; i < active->count; ++i) {
                if (active->share[i] <= 1e-12) continue;
                const double until = active->multiplier[i] / active->share[i];
                if (until < most) {
                    most = until;
                    leaving = i;
                }
            }
            const double full = left > 0.0 ? missing / left : INFINITY;
            if (isinf(full) && leaving < 0) return 0;
            const double step = fmin(full, most);
            add(active->count, active->multiplier, -step, active->share);
            multiplier += step;
            if (!isinf(full)) {
                add(n, x, step, active->direction);
                missing -= step * left;
            }
            if (full <= most) {
                join(shape, active, worst, sign, left, multiplier);
                break;
            }
            leave(shape, active, leaving);
            if (++turn >= 20 * all) return 0;
        }
    }
    return 0;
}
