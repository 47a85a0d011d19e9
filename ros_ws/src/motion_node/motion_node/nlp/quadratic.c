/* SPDX-License-Identifier: Apache-2.0
 *
 * min over x   x' H x / 2 + g' x   s.t.   lower <= A x <= upper,  least <= x <= most
 *
 * for a constant, positive definite H and sparse rows A. H consists of blocks, one for each pair of
 * configurations, which are diagonal, as costs are sums over joints, and zero but near its diagonal.
 * Equations of one configuration are eliminated: it moves in what they leave to it, x = p + Z y, and
 * Z' H Z, banded like H, is factorised anew for each program. All other rows are left to the dual
 * active-set method of Goldfarb and Idnani (1983) in the space of the active rows: besides, all that
 * is factorised is N' P N, P = Z (Z' H Z)^-1 Z', of the few active rows N, row by row as they come
 * and go. Of these, equations become active first, all the others when they are violated most.
 */
#include <math.h>
#include <string.h>

/* A violation this small counts as none [m or rad]. */
#define NONE 1e-9
/* A row whose part beyond the active ones is this share of it depends on them. */
#define DEPENDENT 1e-10
/* Rows that miss more than this when all is done contradict one another [m or rad]. */
#define CONTRADICTION 1e-6
/* Of an equation of length 1, what is left beyond others that it depends on. */
#define NOTHING 1e-7

typedef struct {
    int variables, rows, block;        /* variables a block */
    const double *hessian;             /* the diagonals of its blocks, by rows of blocks */
    const int *first;                  /* of each block, the first one that it is coupled with */
    const int *begin, *column, *place; /* of each row's entries, and where a Jacobian has them */
} Shape;

/* What equations of single blocks leave free. */
typedef struct {
    int *start, *size; /* of each block's free directions: the first one, and how many */
    double *basis;     /* of each block, block x block: its free directions, then its equations */
    double *factor;    /* of Z' H Z, lower triangular, by rows of `variables` entries */
    double *y;
} Freedom;

typedef struct {
    int count;        /* of active rows */
    int *row, *where; /* which they are; of each row, -1 or where it is among them */
    double *sign;     /* 1 at its lower bound, -1 at its upper one */
    double *multiplier;
    double *factor; /* lower triangular, by rows of `variables` entries */
    double *part, *share, *direction, *across;
    Freedom freedom;
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

/* Of the block of H for two configurations. */
static const double *diagonal(const Shape *shape, int b, int c) {
    const int blocks = shape->variables / shape->block;
    return shape->hessian + ((size_t)b * blocks + c) * shape->block;
}

/* out += H x */
static void times(const Shape *shape, const double *x, double *out) {
    const int size = shape->block;
    for (int b = 0; b < shape->variables / size; ++b)
        for (int c = shape->first[b]; c <= b; ++c) {
            const double *cost = diagonal(shape, b, c);
            for (int k = 0; k < size; ++k) out[b * size + k] += cost[k] * x[c * size + k];
            if (c == b) continue;
            for (int k = 0; k < size; ++k) out[c * size + k] += cost[k] * x[b * size + k];
        }
}

/* The block that all of a row's entries are in; -1: there is none. */
static int block_of(const Shape *shape, int row) {
    if (row >= shape->rows) return (row - shape->rows) / shape->block;
    const int begin = shape->begin[row], end = shape->begin[row + 1];
    if (begin == end) return -1;
    const int block = shape->column[begin] / shape->block;
    for (int e = begin + 1; e < end; ++e)
        if (shape->column[e] / shape->block != block) return -1;
    return block;
}

/* Less its parts along orthonormal directions; returns the length of what is left. */
static double beyond(int size, int count, const double *directions, double *vector) {
    for (int twice = 0; twice < 2; ++twice)
        for (int i = 0; i < count; ++i)
            add(size, vector, -dot(size, directions + i * size, vector), directions + i * size);
    return sqrt(dot(size, vector, vector));
}

/* The first free direction of the block that a free direction couples to first. */
static int reach(const Shape *shape, const Freedom *freedom, int block) {
    return freedom->start[shape->first[block]];
}

/* y = (L L')^-1 y, whose entries before `from` are 0. */
static void solve(const Shape *shape, const Freedom *freedom, int from, double *y) {
    const int n = shape->variables, blocks = n / shape->block;
    for (int b = 0; b < blocks; ++b) {
        if (freedom->start[b] + freedom->size[b] <= from) continue;
        const int low = reach(shape, freedom, b);
        for (int i = freedom->start[b]; i < freedom->start[b] + freedom->size[b]; ++i) {
            if (i < from) continue;
            const double *row = freedom->factor + (size_t)i * n;
            const int begin = low > from ? low : from;
            y[i] = (y[i] - dot(i - begin, row + begin, y + begin)) / row[i];
        }
    }
    for (int b = blocks - 1; b >= 0; --b) {
        const int low = reach(shape, freedom, b);
        for (int i = freedom->start[b] + freedom->size[b] - 1; i >= freedom->start[b]; --i) {
            const double *row = freedom->factor + (size_t)i * n;
            y[i] /= row[i];
            add(i - low, y + low, -y[i], row + low);
        }
    }
}

/* x += Z y */
static void spanned(const Shape *shape, const Freedom *freedom, double *x) {
    const int size = shape->block;
    const double *y = freedom->y;
    for (int b = 0; b < shape->variables / size; ++b)
        for (int k = 0; k < freedom->size[b]; ++k)
            add(size, x + b * size, y[freedom->start[b] + k],
                freedom->basis + (size_t)(b * size + k) * size);
}

/* y += factor Z' n; returns the first free direction with a share in n. */
static int gather(const Shape *shape, const double *jacobian, const Freedom *freedom, int row,
                  double factor, double *y) {
    const int size = shape->block, one = row - shape->rows;
    const int begin = one < 0 ? shape->begin[row] : 0;
    const int end = one < 0 ? shape->begin[row + 1] : 1;
    int from = shape->variables;
    for (int e = begin; e < end; ++e) {
        const int column = one < 0 ? shape->column[e] : one, b = column / size;
        const double value = one < 0 ? factor * jacobian[shape->place[e]] : factor;
        const double *basis = freedom->basis + (size_t)b * size * size + column % size;
        double *own = y + freedom->start[b];
        for (int k = 0; k < freedom->size[b]; ++k) own[k] += value * basis[k * size];
        if (freedom->start[b] < from) from = freedom->start[b];
    }
    return from;
}

/* The entry of H on its diagonal. */
static double own_cost(const Shape *shape, int variable) {
    const int b = variable / shape->block;
    return diagonal(shape, b, b)[variable % shape->block];
}

/* Of a row, n' D^-1 n for the diagonal D of H: what it is measured by. */
static double weight(const Shape *shape, const double *jacobian, int row) {
    if (row >= shape->rows) return 1.0 / own_cost(shape, row - shape->rows);
    double sum = 0.0;
    for (int e = shape->begin[row]; e < shape->begin[row + 1]; ++e) {
        const double value = jacobian[shape->place[e]];
        sum += value * value / own_cost(shape, shape->column[e]);
    }
    return sum;
}

/* The active row with an index leaves: the rows of the factor below it move up, rotated. */
static void leave(const Shape *shape, Active *active, int index) {
    const int n = shape->variables, last = active->count - 1;
    active->where[active->row[index]] = -1;
    for (int i = index; i < last; ++i) {
        double *row = active->factor + (size_t)i * n;
        memcpy(row, row + n, (i + 2) * sizeof(double));
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
    const Freedom *freedom = &active->freedom;
    memset(freedom->y, 0, shape->variables * sizeof(double));
    solve(shape, freedom, gather(shape, jacobian, freedom, row, sign, freedom->y), freedom->y);
    memset(active->across, 0, shape->variables * sizeof(double));
    spanned(shape, freedom, active->across);
    for (int i = 0; i < active->count; ++i) {
        const double *factor = active->factor + (size_t)i * shape->variables;
        const double own =
            active->sign[i] * row_times(shape, jacobian, active->row[i], active->across);
        part[i] = (own - dot(i, factor, part)) / factor[i];
    }
    const double whole = sign * row_times(shape, jacobian, row, active->across);
    const double left = whole - dot(active->count, part, part);
    const double least = DEPENDENT * weight(shape, jacobian, row);
    return active->count < shape->variables && left > least ? left : 0.0;
}

/* share = L^-T share, for the factor L. */
static void back(const Shape *shape, const Active *active, double *share) {
    for (int i = active->count - 1; i >= 0; --i) {
        const double *factor = active->factor + (size_t)i * shape->variables;
        share[i] /= factor[i];
        add(i, share, -share[i], factor);
    }
}

/* x += P N share, of the active rows N. */
static void along(const Shape *shape, const double *jacobian, Active *active,
                  const double *share, double factor, double *x) {
    const Freedom *freedom = &active->freedom;
    if (active->count == 0) return;
    memset(freedom->y, 0, shape->variables * sizeof(double));
    for (int i = 0; i < active->count; ++i)
        gather(shape, jacobian, freedom, active->row[i], factor * share[i] * active->sign[i],
               freedom->y);
    solve(shape, freedom, 0, freedom->y);
    spanned(shape, freedom, x);
}

/* Of the row that was looked at last, what a unit costs each active one, and its direction. */
static void spread(const Shape *shape, const double *jacobian, Active *active) {
    memcpy(active->share, active->part, active->count * sizeof(double));
    back(shape, active, active->share);
    memcpy(active->direction, active->across, shape->variables * sizeof(double));
    along(shape, jacobian, active, active->share, -1.0, active->direction);
}

/* The row that was looked at last becomes active. */
static void join(const Shape *shape, Active *active, int row, double sign, double left,
                 double multiplier) {
    const int n = shape->variables, count = active->count;
    double *factor = active->factor + (size_t)count * n;
    memcpy(factor, active->part, count * sizeof(double));
    factor[count] = sqrt(left);
    active->row[count] = row;
    active->where[row] = count;
    active->sign[count] = sign;
    active->multiplier[count] = multiplier;
    active->count = count + 1;
}

/* Equations of single blocks hold at x, which lies nowhere else than they say, and are eliminated:
 * each block's free directions are found, then Z' H Z is factorised. Rows that are eliminated are
 * marked by -2. */
static void eliminate(const Shape *shape, const double *jacobian, const double *lower,
                      const double *upper, Active *active, double *x) {
    const int n = shape->variables, size = shape->block, blocks = n / size;
    Freedom *freedom = &active->freedom;
    for (int b = 0; b < blocks; ++b) freedom->size[b] = 0;
    memset(x, 0, n * sizeof(double));
    /* First come the equations' own directions, with x along each as far as it asks for. */
    for (int row = 0; row < shape->rows + n; ++row) {
        if (lower[row] < upper[row]) continue;
        const int b = block_of(shape, row);
        if (b < 0 || freedom->size[b] == size) continue;
        double *basis = freedom->basis + (size_t)b * size * size;
        double *own = basis + freedom->size[b] * size;
        memset(own, 0, size * sizeof(double));
        if (row >= shape->rows) own[(row - shape->rows) % size] = 1.0;
        else
            for (int e = shape->begin[row]; e < shape->begin[row + 1]; ++e)
                own[shape->column[e] % size] = jacobian[shape->place[e]];
        const double length = sqrt(dot(size, own, own));
        const double left = beyond(size, freedom->size[b], basis, own);
        if (left <= NOTHING * length) continue;
        const double missing = lower[row] - row_times(shape, jacobian, row, x);
        for (int i = 0; i < size; ++i) own[i] /= left;
        add(size, x + b * size, missing / left, own);
        freedom->size[b] += 1;
        active->where[row] = -2;
    }
    int start = 0;
    for (int b = 0; b < blocks; ++b) {
        double *basis = freedom->basis + (size_t)b * size * size;
        const int taken = freedom->size[b];
        if (taken == 0) {
            memset(basis, 0, (size_t)size * size * sizeof(double));
            for (int k = 0; k < size; ++k) basis[k * size + k] = 1.0;
        }
        for (int k = taken == 0 ? size : taken; k < size; ++k) {
            /* Of the axes the one that is farthest from what is there. */
            int best = 0;
            double most = -1.0;
            for (int i = 0; i < size; ++i) {
                double left = 1.0;
                for (int j = 0; j < k; ++j) left -= basis[j * size + i] * basis[j * size + i];
                if (left > most) {
                    most = left;
                    best = i;
                }
            }
            double *own = basis + k * size;
            memset(own, 0, size * sizeof(double));
            own[best] = 1.0;
            const double left = beyond(size, k, basis, own);
            for (int i = 0; i < size; ++i) own[i] /= left;
        }
        /* Free directions first. */
        memmove(basis, basis + taken * size, (size_t)(size - taken) * size * sizeof(double));
        freedom->size[b] = size - taken;
        freedom->start[b] = start;
        start += size - taken;
    }
    double *half = active->across;
    for (int b = 0; b < blocks; ++b)
        for (int c = shape->first[b]; c <= b; ++c) {
            const double *cost = diagonal(shape, b, c);
            const int whole = freedom->size[c] == size;
            for (int i = 0; i < freedom->size[b]; ++i) {
                const double *own = freedom->basis + (size_t)(b * size + i) * size;
                double *row = freedom->factor + (size_t)(freedom->start[b] + i) * n;
                const int count = c < b ? freedom->size[c] : i + 1;
                for (int k = 0; k < size; ++k) half[k] = own[k] * cost[k];
                if (whole) memcpy(row + freedom->start[c], half, count * sizeof(double));
                else
                    for (int j = 0; j < count; ++j)
                        row[freedom->start[c] + j] =
                            dot(size, half, freedom->basis + (size_t)(c * size + j) * size);
            }
        }
    for (int b = 0; b < blocks; ++b) {
        const int low = reach(shape, freedom, b);
        for (int i = freedom->start[b]; i < freedom->start[b] + freedom->size[b]; ++i) {
            double *row = freedom->factor + (size_t)i * n;
            int c = shape->first[b];
            for (int j = low; j <= i; ++j) {
                while (j >= freedom->start[c] + freedom->size[c]) ++c;
                const int other = reach(shape, freedom, c), begin = other > low ? other : low;
                const double *column = freedom->factor + (size_t)j * n;
                const double left = row[j] - dot(j - begin, row + begin, column + begin);
                row[j] = j < i ? left / column[j] : sqrt(left);
            }
        }
    }
}

/* From a gradient to the minimum x where all equations hold. Returns 0 if they contradict one
 * another. */
static int equations(const Shape *shape, const double *jacobian, const double *gradient,
                     const double *lower, const double *upper, Active *active, double *x) {
    const int n = shape->variables, size = shape->block, all = shape->rows + n;
    const Freedom *freedom = &active->freedom;
    double *share = active->share, *slope = active->direction;
    eliminate(shape, jacobian, lower, upper, active, x);
    memcpy(slope, gradient, n * sizeof(double));
    times(shape, x, slope);
    for (int b = 0; b < n / size; ++b)
        for (int k = 0; k < freedom->size[b]; ++k)
            freedom->y[freedom->start[b] + k] =
                -dot(size, freedom->basis + (size_t)(b * size + k) * size, slope + b * size);
    solve(shape, freedom, 0, freedom->y);
    spanned(shape, freedom, x);
    for (int row = 0; row < all; ++row) {
        if (lower[row] < upper[row] || active->where[row] == -2) continue;
        const double left = look(shape, active, jacobian, row, 1.0);
        if (left == 0.0) continue;
        const double missing = lower[row] - row_times(shape, jacobian, row, x);
        share[active->count] =
            (missing - dot(active->count, active->part, share)) / sqrt(left);
        join(shape, active, row, 1.0, left, 0.0);
    }
    back(shape, active, share);
    along(shape, jacobian, active, share, 1.0, x);
    for (int row = 0; row < all; ++row) {
        if (lower[row] < upper[row] || active->where[row] >= 0) continue;
        if (fabs(lower[row] - row_times(shape, jacobian, row, x)) > CONTRADICTION) return 0;
    }
    return 1;
}

/* The row that is violated most; -1: none is. */
static int violated(const Shape *shape, const double *jacobian, const double *lower,
                    const double *upper, const Active *active, const double *x) {
    const int all = shape->rows + shape->variables;
    double most = NONE;
    int worst = -1;
    for (int row = 0; row < all; ++row) {
        if (active->where[row] != -1 || !(lower[row] < upper[row])) continue;
        if (isinf(lower[row]) && isinf(upper[row])) continue;
        const double value = row_times(shape, jacobian, row, x);
        const double missing = fmax(lower[row] - value, value - upper[row]);
        if (missing <= most) continue;
        most = missing;
        worst = row;
    }
    return worst;
}

/* Whether active rows hold, too: among rows that contradict one another nearly enough rounding can
 * decide that one does not depend on the others, and what is found then is none. */
static int active_hold(const Shape *shape, const double *jacobian, const double *lower,
                       const double *upper, const Active *active, const double *x) {
    for (int i = 0; i < active->count; ++i) {
        const int row = active->row[i];
        const double value = row_times(shape, jacobian, row, x);
        if (!(fmax(lower[row] - value, value - upper[row]) <= CONTRADICTION)) return 0;
    }
    return 1;
}

/* The minimum x of a gradient at 0. `lower` and `upper` are those of the rows, then of the
 * variables. Returns 0 if the constraints contradict one another. */
static int quadratic(const Shape *shape, const double *jacobian, const double *gradient,
                     const double *lower, const double *upper, Active *active, double *x) {
    const int n = shape->variables, all = shape->rows + n;
    active->count = 0;
    for (int row = 0; row < all; ++row) active->where[row] = -1;
    if (!equations(shape, jacobian, gradient, lower, upper, active, x)) return 0;
    const int always = active->count;
    for (int turn = 0; turn < 20 * all;) {
        const int row = violated(shape, jacobian, lower, upper, active, x);
        if (row < 0) return active_hold(shape, jacobian, lower, upper, active, x);
        const double value = row_times(shape, jacobian, row, x);
        const double sign = lower[row] > value ? 1.0 : -1.0;
        double missing = sign > 0.0 ? lower[row] - value : value - upper[row];
        double multiplier = 0.0;
        for (;;) {
            if (++turn > 20 * all) return 0;
            const double left = look(shape, active, jacobian, row, sign);
            spread(shape, jacobian, active);
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
                join(shape, active, row, sign, left, multiplier);
                break;
            }
            leave(shape, active, leaving);
        }
    }
    return 0;
}
