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

/* Whether inverse depths bend by more than a share; see `without_edges`. edge: (h, w). */
int bends(int height, int width, const float *depth, float limit, unsigned char *edge) {
    const size_t size = (size_t)height * width;
    float *inverse = malloc(sizeof(float) * (size + width)), *bend = inverse + size;
    if (!inverse) return -1;
    for (size_t n = 0; n < size; ++n) {
        const float over = 1.0f / depth[n];
        inverse[n] = isnan(depth[n]) ? 0.0f : over;
    }
    for (int row = 0; row < height; ++row) {
        const float *at = inverse + (size_t)row * width, *far = depth + (size_t)row * width;
        const float *above = at - width, *below = at + width;
        unsigned char *restrict out = edge + (size_t)row * width;
        bend[0] = bend[width - 1] = 0.0f;
        for (int n = 1; n < width - 1; ++n) bend[n] = fabsf(at[n - 1] - 2.0f * at[n] + at[n + 1]);
        if (row > 0 && row < height - 1)
            for (int n = 0; n < width; ++n) {
                const float across = fabsf(above[n] - 2.0f * at[n] + below[n]);
                bend[n] = across > bend[n] ? across : bend[n];
            }
        for (int n = 0; n < width; ++n) out[n] = bend[n] * far[n] > limit;
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
