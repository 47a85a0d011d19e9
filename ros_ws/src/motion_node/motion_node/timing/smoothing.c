/* SPDX-License-Identifier: Apache-2.0
 *
 * What smoothing.py says, for one way after the other.
 */
#include <math.h>
#include <stdlib.h>

typedef struct {
    int points, joints;
    const double *times, *positions, *velocities; /* of one way */
    const double *before;                         /* the velocity at its beginning */
    double *passed;                               /* integral of the positions up to each point */
} Cubic;

static void integrate(Cubic *way) {
    const int n = way->joints;
    for (int j = 0; j < n; ++j) way->passed[j] = 0.0;
    for (int i = 0; i + 1 < way->points; ++i) {
        const double h = way->times[i + 1] - way->times[i];
        const double *p = way->positions + i * n, *v = way->velocities + i * n;
        for (int j = 0; j < n; ++j)
            way->passed[(i + 1) * n + j] = way->passed[i * n + j] + h * (p[j] + p[j + n]) / 2 +
                                           h * h * (v[j] - v[j + n]) / 12;
    }
}

/* Positions and their integral at a time, which is in or behind the interval that is given. */
static void at(const Cubic *way, double time, int *interval, double *x, double *whole) {
    const int n = way->joints, last = way->points - 1;
    while (*interval < last && time >= way->times[*interval + 1]) ++*interval;
    const int i = *interval;
    const double *p = way->positions + i * n, *v = way->velocities + i * n;
    if (time < 0.0 || i == last) {
        const double late = time - way->times[i];
        for (int j = 0; j < n; ++j) {
            const double speed = i == last ? 0.0 : way->before[j];
            x[j] = p[j] + late * speed;
            whole[j] = way->passed[i * n + j] + late * (p[j] + late * speed / 2);
        }
        return;
    }
    const double h = way->times[i + 1] - way->times[i], u = (time - way->times[i]) / h;
    for (int j = 0; j < n; ++j) {
        const double rise = p[j + n] - p[j], begin = h * v[j], end = h * v[j + n];
        const double square = 3 * rise - 2 * begin - end, cube = begin + end - 2 * rise;
        x[j] = p[j] + u * (begin + u * (square + u * cube));
        whole[j] = way->passed[i * n + j] +
                   h * u * (p[j] + u * (begin / 2 + u * (square / 3 + u * cube / 4)));
    }
}

/* By how much a way must be slower for the cubics between its points to keep the limits. */
static double slower(int count, int joints, const double *moments, const double *positions,
                     const double *velocities, const double *velocity,
                     const double *acceleration) {
    double steepest = 0.0, fastest = 0.0;
    for (int k = 0; k + 1 < count; ++k) {
        const double span = moments[k + 1] - moments[k];
        for (int j = 0; j < joints; ++j) {
            const int here = k * joints + j, next = here + joints;
            const double mean = (positions[next] - positions[here]) / span;
            const double begin = velocities[here], end = velocities[next];
            const double linear = 6 * mean - 4 * begin - 2 * end;
            const double square = 3 * (begin + end - 2 * mean);
            const double change = fmax(fabs(linear), fabs(linear + 2 * square));
            double speed = fmax(fabs(begin), fabs(end));
            /* The velocity's extremes are at the ends, or where the acceleration is zero. */
            if (speed + change > velocity[j] && square != 0.0) {
                const double share = -linear / (2 * square);
                if (share > 0.0 && share < 1.0)
                    speed = fmax(speed, fabs(begin + 0.5 * share * linear));
            }
            steepest = fmax(steepest, change / span / acceleration[j]);
            fastest = fmax(fastest, speed / velocity[j]);
        }
    }
    return fmax(1.0, fmax(sqrt(steepest), fastest));
}

/* See `_means` in smoothing.py. All arrays by rows, those of ways one behind the other.
 *
 * Returns 0, or -1 without memory. */
int smooth(int ways, int points, int joints, const double *times, const double *positions,
           const double *velocities, const double *before, double window, const int *counts,
           const double *velocity, const double *acceleration, double *moments, double *means,
           double *rates, double *factors) {
    double *room = malloc(((size_t)points * joints + 4 * joints) * sizeof(double));
    if (!room) return -1;
    double *x = room, *whole = x + joints, *early = whole + joints;
    double *early_whole = early + joints;
    for (int w = 0; w < ways; ++w) {
        const size_t skip = (size_t)w * points;
        Cubic way = {points, joints, times + skip, positions + skip * joints,
                     velocities + skip * joints, before, early_whole + joints};
        integrate(&way);
        const double end = way.times[points - 1];
        const int count = counts[w];
        int late_in = 0, early_in = 0;
        for (int k = 0; k < count; ++k) {
            const double time = k * ((end + window) / (count - 1));
            moments[k] = time;
            at(&way, time, &late_in, x, whole);
            at(&way, time - window, &early_in, early, early_whole);
            for (int j = 0; j < joints; ++j) {
                means[k * joints + j] = (whole[j] - early_whole[j]) / window;
                rates[k * joints + j] = (x[j] - early[j]) / window;
            }
        }
        const int last = (count - 1) * joints;
        for (int j = 0; j < joints; ++j) {
            means[j] = way.positions[j] - window / 2 * before[j];
            rates[j] = before[j];
            means[last + j] = way.positions[(points - 1) * joints + j];
            rates[last + j] = 0.0;
        }
        moments[count - 1] = end + window;
        factors[w] = slower(count, joints, moments, means, rates, velocity, acceleration);
        moments += count;
        means += count * joints;
        rates += count * joints;
    }
    free(room);
    return 0;
}
