/* SPDX-License-Identifier: Apache-2.0
 *
 * What evidence.py says of the ends of a block; see `_ends`.
 */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

/* Images by rows, (h, w). points: (4 h w, 2) at most, of the four directions one after another;
 * shared: how many lie on the line of each; reach: see REACH in evidence.py. Returns how many there
 * are, or -1 without memory. */
int ends(int height, int width, const uint8_t *mask, const uint8_t *goes_on, const double *depth,
         double in_front, double noise, int reach, double *points, double *shared) {
    int found = 0, *lines = malloc(sizeof(int) * (height > width ? height : width));
    if (!lines) return -1;
    for (int way = 0; way < 4; ++way) {
        const int across = way >= 2, step = way & 1 ? 1 : -1, begin = found;
        const int beside = across ? step : step * width, count = across ? width : height;
        for (int n = 0; n < count; ++n) lines[n] = 0;
        for (int row = 0; row < height; ++row)
            for (int column = 0; column < width; ++column) {
                const int at = row * width + column, line = across ? column : row;
                if (!mask[at] || line + step < 0 || line + step >= count) continue;
                if (mask[at + beside] || goes_on[at + beside]) continue;
                const double own = isnan(depth[at]) ? 0.0 : depth[at];
                int next = at + beside;
                for (int n = 2; n <= reach && isnan(depth[next]); ++n) {
                    if (line + n * step < 0 || line + n * step >= count) break;
                    next = at + n * beside;
                }
                if (mask[next]) next = at + beside;
                if (goes_on[next] && !isnan(depth[next])) continue;
                if (depth[at] - depth[next] > in_front + 4.0 * noise * (own * own)) continue;
                points[2 * found] = column + (across ? 0.5 * step : 0.0);
                points[2 * found + 1] = row + (across ? 0.0 : 0.5 * step);
                shared[found++] = line;
                ++lines[line];
            }
        for (int n = begin; n < found; ++n) shared[n] = lines[(int)shared[n]];
    }
    free(lines);
    return found;
}
