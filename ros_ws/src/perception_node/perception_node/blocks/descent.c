/* SPDX-License-Identifier: Apache-2.0
 *
 * What descent.py says, for one block after the other; see there and models.py.
 */
#include <math.h>
#include <string.h>

enum { BOX, CYLINDER, BALL };
enum { MOST = 7, FACES = 3, CORNERS = 48 };
static const int COUNT[] = {7, 5, 4};

typedef struct {
    int kind, points, rim, priors, sides; /* sides: corners of a polygon that stands for a circle */
    const double *origin, *pose, *lens;   /* pose: world from optical (4, 4); lens: fx, fy, cx, cy */
    const double *circle;                 /* (sides, 2) */
    double floor, huber, short_edge;
    const double *steps;
} Task;

typedef struct {
    const double *points, *rays, *noise, *used, *outline, *inverse, *rows, *values;
} Block;

typedef struct {
    double cost, information[MOST * MOST], gradient[MOST];
} Found;

typedef struct {
    double off, variance; /* of a point from a face, and of that */
} Face;

/* The face that a point is of, and by which parameters it moves. */
typedef struct {
    double off, variance, slopes[4];
    int count;
    const int *by;
} Met;

static const int ALL[] = {0, 1, 2, 3, 4, 5, 6}, WALLS[2][4] = {{0, 1, 2, 3}, {0, 1, 2, 4}};
static const int LIDS[] = {6, 4};

static double larger(double one, double other) { return one > other ? one : other; }
static double smaller(double one, double other) { return one < other ? one : other; }

/* Corners whose convex hull is the outline; returns how many. */
static int corners(const Task *task, const double *p, double out[][3]) {
    if (task->kind == BOX) {
        const double c = cos(p[2]), s = sin(p[2]);
        for (int k = 0; k < 8; ++k) {
            const double a = (k & 4 ? 0.5 : -0.5) * p[3], b = (k & 2 ? 0.5 : -0.5) * p[4];
            out[k][0] = p[0] + c * a - s * b;
            out[k][1] = p[1] + s * a + c * b;
            out[k][2] = k & 1 ? p[6] : p[5];
        }
        return 8;
    }
    const int sides = task->sides;
    const double *circle = task->circle;
    if (task->kind == CYLINDER) {
        for (int k = 0; k < 2 * sides; ++k) {
            const double *at = circle + 2 * (k % sides);
            out[k][0] = p[0] + p[2] * at[0];
            out[k][1] = p[1] + p[2] * at[1];
            out[k][2] = k < sides ? p[3] : p[4];
        }
        return 2 * sides;
    }
    double to[3], square = 0.0;
    for (int i = 0; i < 3; ++i) {
        to[i] = task->origin[i] - p[i];
        square += to[i] * to[i];
    }
    const double distance = sqrt(square), radius = p[3], part = radius / distance;
    for (int i = 0; i < 3; ++i) to[i] /= distance;
    const double rim = radius * sqrt(larger(1.0 - part * part, 0.0));
    const double flat = hypot(to[0], to[1]);
    const double side[3] = {to[1] / flat, -to[0] / flat, 0.0};
    const double up[3] = {side[1] * to[2], -side[0] * to[2], side[0] * to[1] - side[1] * to[0]};
    for (int k = 0; k < sides; ++k)
        for (int i = 0; i < 3; ++i)
            out[k][i] = p[i] + radius * part * to[i] +
                        rim * (circle[2 * k] * side[i] + circle[2 * k + 1] * up[i]);
    return sides;
}

static void project(const Task *task, int count, double solid[][3], double flat[][2]) {
    const double *pose = task->pose, *lens = task->lens;
    for (int k = 0; k < count; ++k) {
        double seen[3] = {0.0, 0.0, 0.0};
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) seen[j] += (solid[k][i] - task->origin[i]) * pose[4 * i + j];
        const int before = seen[2] > 1e-6;
        flat[k][0] = before ? lens[0] * seen[0] / seen[2] + lens[2] : -1e4;
        flat[k][1] = before ? lens[1] * seen[1] / seen[2] + lens[3] : -1e4;
    }
}

static float turn(float at[][2], int a, int b, int c) {
    return (at[b][0] - at[a][0]) * (at[c][1] - at[a][1]) -
           (at[b][1] - at[a][1]) * (at[c][0] - at[a][0]);
}

/* Indices of the corners of the convex hull, one way round; returns how many (Andrew's chain). */
static int hull_of(int count, double flat[][2], int *hull) {
    float at[CORNERS][2];
    int order[CORNERS];
    for (int k = 0; k < count; ++k) {
        at[k][0] = (float)flat[k][0];
        at[k][1] = (float)flat[k][1];
        int j = k;
        for (; j > 0; --j) {
            const float *other = at[order[j - 1]];
            if (other[0] < at[k][0] || (other[0] == at[k][0] && other[1] <= at[k][1])) break;
            order[j] = order[j - 1];
        }
        order[j] = k;
    }
    int size = 0;
    for (int k = 0; k < count; ++k) {
        while (size >= 2 && turn(at, hull[size - 2], hull[size - 1], order[k]) <= 0.0f) --size;
        hull[size++] = order[k];
    }
    const int lower = size + 1;
    for (int k = count - 2; k >= 0; --k) {
        while (size >= lower && turn(at, hull[size - 2], hull[size - 1], order[k]) <= 0.0f) --size;
        hull[size++] = order[k];
    }
    return size > 1 ? size - 1 : size;
}

/* A residual, whose slopes by some parameters, ascending, are not zero. */
static void add_residual(double huber, double residual, int count, const int *by,
                         const double *slopes, Found *found) {
    const double size = fabs(residual), weight = size > huber ? huber / size : 1.0;
    found->cost += 0.5 * (weight * size * (2.0 * size - weight * size));
    for (int i = 0; i < count; ++i) {
        const double weighted = weight * slopes[i];
        double *row = found->information + MOST * by[i];
        found->gradient[by[i]] += weighted * residual;
        for (int j = 0; j <= i; ++j) row[by[j]] += weighted * slopes[j];
    }
}

/* A face of a convex block; `met` is the one whose plane the ray meets last of those it enters by,
 * see models.py. */
static void add_face(const Task *task, double noise, double off, double step, double distance,
                     int number, Face *face, int *met, double *last) {
    face->off = off;
    face->variance = noise * step * noise * step + task->floor * task->floor;
    const double meets = distance / smaller(step, -1e-9);
    if (meets > *last && step < 0.0) {
        *met = number;
        *last = meets;
    }
}

/* Signed square of how many standard deviations a point is outside of a face. */
static double beyond(const Face *face) { return face->off * fabs(face->off) / face->variance; }

static void surface(const Task *task, const double *p, double c, double s, const double *point,
                    const double *ray, double noise, Met *out) {
    const double *origin = task->origin;
    if (task->kind == BALL) {
        double away[3], square = 0.0, step = 0.0;
        for (int i = 0; i < 3; ++i) {
            away[i] = point[i] - p[i];
            square += away[i] * away[i];
        }
        const double distance = larger(sqrt(square), 1e-6);
        for (int i = 0; i < 3; ++i) {
            out->slopes[i] = -away[i] / distance;
            step -= out->slopes[i] * ray[i];
        }
        out->slopes[3] = -1.0;
        out->count = 4;
        out->by = ALL;
        out->off = distance - p[3];
        out->variance = noise * step * noise * step + task->floor * task->floor;
        return;
    }
    Face faces[FACES];
    const int *lid = task->kind == BOX ? LIDS : LIDS + 1;
    const int count = task->kind == BOX ? 3 : 2;
    int met = 0;
    double last = -INFINITY, slopes[FACES][4];
    const double dx = point[0] - p[0], dy = point[1] - p[1], high = p[*lid];
    add_face(task, noise, point[2] - high, ray[2], high - origin[2], 0, &faces[0], &met, &last);
    if (task->kind == BOX) {
        for (int index = 0; index < 2; ++index) {
            const double a = index ? -s : c, b = index ? c : s, half = 0.5 * p[3 + index];
            const double begin = a * (origin[0] - p[0]) + b * (origin[1] - p[1]);
            const double place = a * dx + b * dy, which = fabs(begin) > half ? begin : place;
            const double side = (which > 0.0) - (which < 0.0);
            double *mine = slopes[1 + index];
            mine[0] = -side * a;
            mine[1] = -side * b;
            mine[2] = side * (a * dy - b * dx);
            mine[3] = -0.5;
            add_face(task, noise, side * place - half, side * (a * ray[0] + b * ray[1]),
                     half - side * begin, 1 + index, &faces[1 + index], &met, &last);
        }
    } else {
        const double from_axis = larger(sqrt(dx * dx + dy * dy), 1e-6);
        const double step = smaller((dx * ray[0] + dy * ray[1]) / from_axis, -1e-9);
        const double ox = origin[0] - p[0], oy = origin[1] - p[1];
        const double a = larger(ray[0] * ray[0] + ray[1] * ray[1], 1e-9);
        const double b = ray[0] * ox + ray[1] * oy;
        const double under = b * b - a * (ox * ox + oy * oy - p[2] * p[2]);
        const double meets = (-b - sqrt(larger(under, 0.0))) / a;
        slopes[1][0] = -dx / from_axis;
        slopes[1][1] = -dy / from_axis;
        slopes[1][2] = -1.0;
        add_face(task, noise, from_axis - p[2], step, meets * step, 1, &faces[1], &met, &last);
    }
    int worst = 0;
    double furthest = beyond(&faces[0]);
    for (int k = 1; k < count; ++k) {
        const double far = beyond(&faces[k]);
        if (far > furthest) {
            furthest = far;
            worst = k;
        }
    }
    if (furthest > fabs(beyond(&faces[met]))) met = worst;
    out->off = faces[met].off;
    out->variance = faces[met].variance;
    if (met == 0) {
        out->slopes[0] = -1.0;
        out->count = 1;
        out->by = lid;
    } else {
        memcpy(out->slopes, slopes[met], sizeof out->slopes);
        out->count = task->kind == BOX ? 4 : 3;
        out->by = task->kind == BOX ? WALLS[met - 1] : ALL;
    }
}

/* What the points of the outline add: each by the edge that it is furthest outside of, with whose
 * ends it moves by how near it is to each. */
static void add_outline(const Task *task, const Block *block, const double *p, Found *found) {
    const int count = COUNT[task->kind];
    double solid[CORNERS][3], pixels[MOST + 1][CORNERS][2], changed[MOST];
    int hull[CORNERS + 1], all = 0;
    for (int k = 0; k <= count; ++k) {
        memcpy(changed, p, sizeof(double) * count);
        if (k) changed[k - 1] += task->steps[k - 1];
        all = corners(task, changed, solid);
        project(task, all, solid, pixels[k]);
    }
    const int edges = hull_of(all, pixels[0], hull);
    double along[CORNERS][2], normal[CORNERS][2], length[CORNERS], middle[2] = {0.0, 0.0};
    for (int e = 0; e < edges; ++e) {
        const double *begin = pixels[0][hull[e]], *end = pixels[0][hull[(e + 1) % edges]];
        along[e][0] = end[0] - begin[0];
        along[e][1] = end[1] - begin[1];
        length[e] = sqrt(along[e][0] * along[e][0] + along[e][1] * along[e][1]);
        for (int i = 0; i < 2; ++i) {
            along[e][i] /= larger(length[e], 1e-9);
            middle[i] += begin[i] / edges;
        }
        normal[e][0] = along[e][1];
        normal[e][1] = -along[e][0];
    }
    const double *first = pixels[0][hull[0]];
    if ((middle[0] - first[0]) * normal[0][0] + (middle[1] - first[1]) * normal[0][1] > 0.0)
        for (int e = 0; e < edges; ++e)
            for (int i = 0; i < 2; ++i) normal[e][i] *= -1.0;
    /* How the ends of each edge move across it, by each parameter. */
    double begins[CORNERS][MOST], ends[CORNERS][MOST];
    for (int e = 0; e < edges; ++e)
        for (int k = 0; k < count; ++k)
            for (int which = 0; which < 2; ++which) {
                const int corner = hull[(e + which) % edges];
                double moved = 0.0;
                for (int i = 0; i < 2; ++i)
                    moved += (pixels[k + 1][corner][i] - pixels[0][corner][i]) * normal[e][i];
                (which ? ends : begins)[e][k] = moved / task->steps[k];
            }
    for (int n = 0; n < task->rim; ++n) {
        const double *point = block->outline + 2 * n, inverse = block->inverse[n];
        if (inverse == 0.0) continue;
        int edge = 0;
        double off = -INFINITY, slopes[MOST];
        for (int e = 0; e < edges; ++e) {
            if (length[e] < task->short_edge) continue;
            const double *begin = pixels[0][hull[e]];
            const double away =
                (point[0] - begin[0]) * normal[e][0] + (point[1] - begin[1]) * normal[e][1];
            if (away > off) {
                off = away;
                edge = e;
            }
        }
        const double *begin = pixels[0][hull[edge]];
        double share = (point[0] - begin[0]) * along[edge][0] + (point[1] - begin[1]) * along[edge][1];
        share = smaller(larger(share / larger(length[edge], 1e-9), 0.0), 1.0);
        for (int k = 0; k < count; ++k)
            slopes[k] = ((share - 1.0) * begins[edge][k] - share * ends[edge][k]) * inverse;
        add_residual(task->huber, off * inverse, count, ALL, slopes, found);
    }
}

static void distances(const Task *task, const Block *block, const double *p, double *offs) {
    const double c = cos(p[2]), s = sin(p[2]);
    for (int n = 0; n < task->points; ++n) {
        Met met;
        surface(task, p, c, s, block->points + 3 * n, block->rays + 3 * n, block->noise[n], &met);
        offs[n] = met.off;
    }
}

static void look(const Task *task, const Block *block, const double *p, Found *found) {
    const int count = COUNT[task->kind];
    memset(found, 0, sizeof *found);
    const double c = cos(p[2]), s = sin(p[2]); /* of a box */
    for (int n = 0; n < task->points; ++n) {
        if (block->used[n] == 0.0) continue;
        Met met;
        surface(task, p, c, s, block->points + 3 * n, block->rays + 3 * n, block->noise[n], &met);
        const double inverse = 1.0 / sqrt(met.variance);
        for (int k = 0; k < met.count; ++k) met.slopes[k] *= inverse;
        add_residual(task->huber, met.off * inverse, met.count, met.by, met.slopes, found);
    }
    add_outline(task, block, p, found);
    for (int m = 0; m < task->priors; ++m) {
        const double *row = block->rows + m * count;
        double known = -block->values[m];
        for (int k = 0; k < count; ++k) known += row[k] * p[k];
        found->cost += 0.5 * known * known;
        for (int i = 0; i < count; ++i) {
            found->gradient[i] += row[i] * known;
            for (int j = 0; j <= i; ++j) found->information[MOST * i + j] += row[i] * row[j];
        }
    }
}

/* The step down, by Cholesky's factors: the matrix is positive, as the priors are of full rank. */
static void step_down(int count, double damping, const Found *found, double *step) {
    double factor[MOST][MOST];
    for (int i = 0; i < count; ++i) {
        for (int j = 0; j <= i; ++j) {
            double sum = found->information[MOST * i + j] * (i == j ? 1.0 + damping : 1.0);
            for (int k = 0; k < j; ++k) sum -= factor[i][k] * factor[j][k];
            factor[i][j] = i == j ? sqrt(sum) : sum / factor[j][j];
        }
        step[i] = -found->gradient[i];
        for (int k = 0; k < i; ++k) step[i] -= factor[i][k] * step[k];
        step[i] /= factor[i][i];
    }
    for (int i = count - 1; i >= 0; --i) {
        for (int k = i + 1; k < count; ++k) step[i] -= factor[k][i] * step[k];
        step[i] /= factor[i][i];
    }
}

/* Damped Gauss-Newton of B blocks; see `descended_by_numpy` in descent.py. Arrays by rows.
 *
 * extents: which parameters are extents; limits: the narrowest and the widest one.
 * parameters: (B, P), where it begins and ends; information: (B, P, P), cost: (B).
 * offs: of the points from their faces, (B, N), or NULL where nobody asks. */
void descend(const Task *task, int blocks, const double *points, const double *rays,
             const double *noise, const double *used, const double *outline, const double *inverse,
             const double *rows, const double *values, int extents, const int *extent,
             const double *limits, int trials, double enough, double gain, double most_damping,
             double *parameters, double *information, double *cost,
             double *offs) {
    const int count = COUNT[task->kind];
    for (int b = 0; b < blocks; ++b) {
        const size_t n = (size_t)b * task->points, o = (size_t)b * task->rim;
        const size_t m = (size_t)b * task->priors;
        const Block block = {points + 3 * n,  rays + 3 * n, noise + n,        used + n,
                             outline + 2 * o, inverse + o,  rows + m * count, values + m};
        double *p = parameters + (size_t)b * count, damping = 1e-3, step[MOST], trial[MOST];
        Found here, there;
        look(task, &block, p, &here);
        for (int k = 0; k < trials; ++k) {
            double longest = 0.0;
            step_down(count, damping, &here, step);
            for (int i = 0; i < count; ++i) {
                trial[i] = p[i] + step[i];
                longest = larger(longest, fabs(step[i]));
            }
            for (int i = 0; i < extents; ++i) {
                double *wide = trial + extent[i];
                *wide = smaller(larger(*wide, limits[0]), limits[1]);
            }
            look(task, &block, trial, &there);
            if (there.cost <= here.cost + 1e-9) {
                const int small = longest < enough || here.cost - there.cost < gain;
                memcpy(p, trial, sizeof(double) * count);
                here = there;
                if (small) break;
                damping = larger(0.1 * damping, 1e-6);
            } else {
                damping *= 10.0;
                if (!(damping < most_damping)) break;
            }
        }
        if (offs) distances(task, &block, p, offs + n);
        cost[b] = here.cost;
        for (int i = 0; i < count; ++i)
            for (int j = 0; j < count; ++j)
                information[((size_t)b * count + i) * count + j] =
                    here.information[MOST * (i > j ? i : j) + (i > j ? j : i)];
    }
}
