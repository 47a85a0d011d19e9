/* SPDX-License-Identifier: Apache-2.0
 *
 * What reachability.py says, for one path after the other.
 */
#include <math.h>
#include <stdlib.h>

static double smaller(double one, double other) { return one < other ? one : other; }

/* x = s'^2 at the points of paths; see `_squares` in reachability.py. All arrays by rows.
 *
 * first: x at the beginning, or below zero: as great as can be.
 * Returns 0, 1 if x at the beginning is too great, or -1 without memory. */
int squares(int paths, int points, int joints, const double *slopes, const double *bends,
            const double *velocity, const double *acceleration, double step, double first,
            double greatest, double tiny, double far, double rounding, double *found) {
    const int rows = 2 * joints;
    double *room = malloc(((size_t)2 * rows + 1) * points * sizeof(double));
    if (!room) return -1;
    double *slope = room, *reach = slope + (size_t)rows * points;
    double *can = reach + (size_t)rows * points;
    int result = 0;
    for (int path = 0; path < paths && result == 0; ++path) {
        const double *q1 = slopes + (size_t)path * points * joints;
        const double *q2 = bends + (size_t)path * points * joints;
        double *x = found + (size_t)path * points;
        for (int i = points - 1; i >= 0; --i) {
            double most = INFINITY;
            for (int j = 0; j < joints; ++j)
                most = smaller(most, velocity[j] / fabs(q1[i * joints + j]));
            most = smaller(most * most, greatest);
            if (i == points - 1) {
                can[i] = most;
                continue;
            }
            double *a = slope + (size_t)i * rows, *b = reach + (size_t)i * rows;
            for (int r = 0; r < rows; ++r) {
                const int j = r % joints, begin = i * joints + j, end = begin + joints;
                const double limit = acceleration[j];
                const double rise = (r < joints ? q1[begin] : q1[end]) / (2.0 * step);
                const double there = r < joints ? rise : rise + q2[end];
                const double here = r < joints ? q2[begin] - rise : -rise;
                if (fabs(there) <= tiny * (fabs(here) + 1.0)) {
                    most = smaller(most, limit / (fabs(here) + tiny));
                    a[r] = 0.0;
                    b[r] = far;
                } else {
                    a[r] = -here / there;
                    b[r] = limit / fabs(there);
                }
            }
            /* Every lower bound of the next x is below every upper one, and none below zero. */
            for (int r = 0; r < rows; ++r) {
                double bound = a[r] < 0.0 ? b[r] / -a[r] : b[r] / tiny;
#pragma omp simd reduction(min : bound)
                for (int s = 0; s < r; ++s) {
                    const double apart = fabs(a[s] - a[r]);
                    const double both = (b[s] + b[r]) / (apart > tiny ? apart : tiny);
                    bound = both < bound ? both : bound;
                }
                most = smaller(most, bound);
                most = smaller(most, (can[i + 1] + b[r]) / (a[r] > 0.0 ? a[r] : tiny));
            }
            can[i] = most;
        }
        x[0] = first < 0.0 ? can[0] : first;
        if (x[0] > can[0] * (1.0 + rounding)) result = 1;
        for (int i = 0; i < points - 1; ++i) {
            const double *a = slope + (size_t)i * rows, *b = reach + (size_t)i * rows;
            double highest = can[i + 1];
            for (int r = 0; r < rows; ++r) highest = smaller(highest, a[r] * x[i] + b[r]);
            x[i + 1] = highest > 0.0 ? highest : 0.0;
        }
    }
    free(room);
    return result;
}
