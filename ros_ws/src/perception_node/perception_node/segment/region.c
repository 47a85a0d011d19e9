/* SPDX-License-Identifier: Apache-2.0
 *
 * What region.py says, pixel by pixel.
 */
#include <stddef.h>
#include <stdint.h>

/* Points of pixels, and whether they are in a box; see `points_by_numpy`. Images by rows.
 *
 * across: what a column adds to a pixel's ray, (3, w); down: what a row adds, (h, 3); low, high:
 * corners of the box, which is open below, (3); found: (3, h, w). */
void points(int height, int width, const float *depth, const float *across, const float *down,
            const float *origin, const float *low, const float *high, float *found,
            uint8_t *inside) {
    const size_t size = (size_t)height * width;
    for (int row = 0; row < height; ++row) {
        const float *far = depth + (size_t)row * width;
        float *x = found + (size_t)row * width, *y = x + size, *z = y + size;
        for (int i = 0; i < 3; ++i) {
            float *restrict out = x + i * size;
            const float *beside = across + (size_t)i * width;
            const float below = down[3 * row + i], from = origin[i];
            for (int n = 0; n < width; ++n) out[n] = (below + beside[n]) * far[n] + from;
        }
        uint8_t *restrict in = inside + (size_t)row * width;
        for (int n = 0; n < width; ++n)
            in[n] = (z[n] < high[2]) & (x[n] > low[0]) & (x[n] < high[0]) & (y[n] > low[1]) &
                    (y[n] < high[1]);
    }
}
