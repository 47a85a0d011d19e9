/* SPDX-License-Identifier: Apache-2.0
 *
 * What region.py says, pixel by pixel.
 */
#include <stdint.h>

/* Points of pixels, and whether they are in a box; see `points_by_numpy`. Images by rows.
 *
 * across: what a column adds to a pixel's ray, (w, 3); down: what a row adds, (h, 3); low, high:
 * corners of the box, which is open below, (3). */
void points(int height, int width, const float *depth, const float *across, const float *down,
            const float *origin, const double *low, const double *high, float *found,
            uint8_t *inside) {
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column) {
            const int at = row * width + column;
            float *point = found + 3 * at;
            for (int i = 0; i < 3; ++i) {
                const float ray = down[3 * row + i] + across[3 * column + i];
                point[i] = ray * depth[at] + origin[i];
            }
            inside[at] = (point[2] < high[2]) & (point[0] > low[0]) & (point[0] < high[0]) &
                         (point[1] > low[1]) & (point[1] < high[1]);
        }
}
