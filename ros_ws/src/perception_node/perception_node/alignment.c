/* SPDX-License-Identifier: Apache-2.0
 *
 * What alignment.py says, pixel by pixel; to the last bit what its numpy does.
 */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

static int within(int at, int end) { return at < 0 ? 0 : at < end ? at : end - 1; }

/* Where the evenest pixel near by is that each of some pixels resembles; see `sharpened`.
 *
 * rgb: (h, w, 3); span: how uneven each pixel's neighbourhood is, (h, w); at: the pixels, (n);
 * steps: down and right to those that are looked at, the nearest first, (m, 2); best: (n). */
void resembled(int height, int width, const unsigned char *rgb, const unsigned char *span, int count,
               const long long *at, int steps, const int *step, long long *best) {
    for (int n = 0; n < count; ++n) {
        const int row = (int)(at[n] / width), column = (int)(at[n] % width);
        const unsigned char *own = rgb + 3 * at[n];
        int least = 32000;
        best[n] = 0;
        for (int k = 0; k < steps; ++k) {
            const long long there = (long long)within(row + step[2 * k], height) * width +
                                    within(column + step[2 * k + 1], width);
            const unsigned char *other = rgb + 3 * there;
            const int score = 2 * span[there] + abs(other[0] - own[0]) + abs(other[1] - own[1]) +
                              abs(other[2] - own[2]);
            if (score < least) {
                least = score;
                best[n] = there;
                if (!least) break;
            }
        }
    }
}

/* Depth for pixels without one; see `fill`.
 *
 * depth, filled: (h, w); near: whether any depth is near by, (h, w); steps: as above, without the pixel itself; costs: of each, (m). */
void fill(int height, int width, const float *depth, const unsigned char *near,
          const unsigned char *rgb, int steps, const int *step, const float *costs,
          float likeness, float *filled) {
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column) {
            const int at = row * width + column;
            filled[at] = depth[at];
            if (!near[at] || !isnan(depth[at])) continue;
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

/* Whether inverse depths bend by more than a share; see `without_edges`. edge: (h, w). */
int bends(int height, int width, const float *depth, float limit, unsigned char *edge) {
    float *inverse = malloc(sizeof(float) * height * width);
    if (!inverse) return -1;
    for (int n = 0; n < height * width; ++n) inverse[n] = isnan(depth[n]) ? 0.0f : 1.0f / depth[n];
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column) {
            const int n = row * width + column;
            const float *at = inverse + n;
            float bend = 0.0f;
            if (column > 0 && column < width - 1) bend = fabsf(at[-1] - 2.0f * at[0] + at[1]);
            if (row > 0 && row < height - 1)
                bend = fmaxf(bend, fabsf(at[-width] - 2.0f * at[0] + at[width]));
            edge[n] = bend * depth[n] > limit;
        }
    free(inverse);
    return 0;
}

/* Gives back what was measured where depth did not move; see `_settle`.
 *
 * found: how many pixels are near edges, and how many of them were measured on the other side. */
void settle(int count, float step, float edge, float nothing, float *filled, const float *measured,
            const float *inner, int64_t *found) {
    for (int n = 0; n < count; ++n) {
        const float far = filled[n], own = measured[n], apart = fabsf(own - far);
        const int both = isnan(inner[n]) && !isnan(own) && !isnan(far);
        found[0] += both;
        found[1] += both && apart > step;
        if (isnan(far) || (both && apart <= edge)) filled[n] = own;
        if (filled[n] == nothing) filled[n] = NAN;
    }
}
