/* SPDX-License-Identifier: Apache-2.0
 *
 * What depth_gaps.py says, pixel by pixel; to the last bit what its numpy does.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Depth for pixels without one; see `fill`.
 *
 * depth, filled: (h, w); wanted: pixels without depth that have any near by, (h, w); steps: down
 * and right to those that are looked at, the nearest first, (m, 2); costs: of each, (m). */
void fill(int height, int width, const float *depth, const unsigned char *wanted,
          const unsigned char *rgb, int steps, const int *step, const float *costs,
          float likeness, float *filled) {
    const size_t size = (size_t)height * width;
    const unsigned char *next = wanted, *end = wanted + size;
    memcpy(filled, depth, sizeof(float) * size);
    while (next < end && (next = memchr(next, 1, end - next))) {
        const int at = (int)(next++ - wanted), row = at / width, column = at % width;
        const unsigned char *own = rgb + 3 * at;
        float least = likeness;
        for (int k = 0; k < steps && costs[k] < least; ++k) {
            const int i = row + step[2 * k], j = column + step[2 * k + 1];
            if (i < 0 || i >= height || j < 0 || j >= width) continue;
            const int there = i * width + j;
            if (isnan(depth[there])) continue;
            const unsigned char *other = rgb + 3 * there;
            const float difference =
                costs[k] + (float)(abs(other[0] - own[0]) + abs(other[1] - own[1]) +
                                   abs(other[2] - own[2]));
            if (difference < least) {
                least = difference;
                filled[at] = depth[there];
            }
        }
    }
}
