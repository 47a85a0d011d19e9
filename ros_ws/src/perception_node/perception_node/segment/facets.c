/* SPDX-License-Identifier: Apache-2.0
 *
 * What facets.py says, pixel by pixel; see there. Images by rows.
 */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

/* The look of colours; see `Look`. reds, greens, blues: (n); chroma: (3, n), light: (n). */
void look(int count, const uint8_t *reds, const uint8_t *greens, const uint8_t *blues, float dark,
          float *restrict chroma, float *restrict light) {
    float logarithm[3 * 255 + 1];
    for (int sum = 0; sum <= 3 * 255; ++sum) logarithm[sum] = logf((float)sum + 3.0f * dark);
    float *red = chroma, *green = chroma + count, *blue = chroma + 2 * (size_t)count;
    for (int n = 0; n < count; ++n) light[n] = logarithm[reds[n] + greens[n] + blues[n]];
#pragma omp simd
    for (int n = 0; n < count; ++n) {
        const float r = (float)reds[n] + dark, g = (float)greens[n] + dark;
        const float b = (float)blues[n] + dark, total = r + g + b;
        red[n] = r / total;
        green[n] = g / total;
        blue[n] = b / total;
    }
}

/* Whether pixels of a row look like those `step` further on, with no jump of depth between. */
static void same(int count, int step, const float *chroma, size_t size, const float *light,
                 const float *depth, const float *steps, uint8_t *restrict linked) {
    const float *red = chroma, *green = red + size, *blue = green + size;
    const float hue = steps[0], bright = steps[1], far = steps[2];
    for (int n = 0; n < count; ++n) {
        const float r = red[n] - red[n + step], g = green[n] - green[n + step];
        const float b = blue[n] - blue[n + step];
        linked[n] = (r * r + g * g + b * b < hue) &
                    (fabsf(light[n] - light[n + step]) < bright) &
                    !(fabsf(depth[n] - depth[n + step]) > far);
    }
}

/* Which neighbours look alike, with no jump of depth between them; see `find_facets`.
 *
 * chroma: (3, h, w); steps: of chroma, squared, light and depth; down: (h - 1, w), right:
 * (h, w - 1). */
void links(int height, int width, const float *chroma, const float *light, const float *depth,
           const float *steps, uint8_t *down, uint8_t *right) {
    const size_t size = (size_t)height * width;
    for (int row = 0; row < height; ++row) {
        const size_t at = (size_t)row * width;
        if (row < height - 1)
            same(width, width, chroma + at, size, light + at, depth + at, steps, down + at);
        same(width - 1, 1, chroma + at, size, light + at, depth + at, steps, right + at - row);
    }
}

/* Which pixels of a row can be of one block with those `step` further on. */
static void near(int count, int step, const float *height, const float *depth, const float *steps,
                 uint8_t *restrict linked) {
    const float far = steps[0], high = steps[1], lid = steps[2];
    for (int n = 0; n < count; ++n) {
        const float jump = fabsf(depth[n] - depth[n + step]);
        const float climb = fabsf(height[n] - height[n + step]);
        linked[n] = !(jump > far) | ((climb < high) & (jump < lid));
    }
}

/* Which neighbours can be of one block; see `on_one_body`. heights: over the table, (h, w); steps:
 * of depth, of a lid's height, of a lid's depth. */
void bodies(int height, int width, const float *heights, const float *depth, const float *steps,
            uint8_t *down, uint8_t *right) {
    for (int row = 0; row < height; ++row) {
        const size_t at = (size_t)row * width;
        if (row < height - 1) near(width, width, heights + at, depth + at, steps, down + at);
        near(width - 1, 1, heights + at, depth + at, steps, right + at - row);
    }
}

/* Which pixels are in the middle of a square of one facet; see `uniform`.
 *
 * before, after: how far the square reaches to both sides. Returns -1 without memory. */
int uniform(int height, int width, const int32_t *ids, int before, int after, uint8_t *inner) {
    /* In how many rows up to this one a column's pixels are each amid equal ones of their row, and
     * of one facet. */
    int *rows = calloc((size_t)height * width, sizeof(int));
    if (!rows) return -1;
    for (int row = 0; row < height; ++row) {
        const int32_t *own = ids + (size_t)row * width;
        int *many = rows + (size_t)row * width;
        for (int begin = 0, end; begin < width; begin = end) {
            for (end = begin + 1; end < width && own[end] == own[begin];) ++end;
            const int first = begin ? begin + before : 0, last = end < width ? end - after : width;
            for (int n = first; n < last; ++n)
                many[n] = 1 + (row && own[n - width] == own[n] ? many[n - width] : 0);
        }
    }
    for (int row = 0; row < height; ++row) {
        const int bottom = row + after < height ? row + after : height - 1;
        const int least = bottom - (row > before ? row - before : 0) + 1;
        const int *many = rows + (size_t)bottom * width;
        uint8_t *out = inner + (size_t)row * width;
        for (int n = 0; n < width; ++n) out[n] = many[n] >= least;
    }
    free(rows);
    return 0;
}

/* Sums over the pixels of each facet; see `Sums`.
 *
 * ids: (h, w), 0 for those of no facet; points, chroma: (3, h, w); strides: how far their channels
 * and rows are from one another, then the rows of light and sure; few: a facet with fewer sure
 * pixels has all of them counted.
 * pixels, sure_ones: (F); colors: of chroma and light, (F, 4); centres: means of the points that
 * count, (F, 3); spreads: of their products, xx xy xz yy yz zz, (F, 6). All zero at first. */
void sums(int height, int width, int facets, const int32_t *ids, const float *points,
          const float *chroma, const float *light, const uint8_t *sure, const int64_t *strides,
          int few, int64_t *pixels, int64_t *sure_ones, double *colors, double *centres,
          double *spreads) {
    for (int row = 0; row < height; ++row) {
        const int32_t *own = ids + (size_t)row * width;
        const float *hue = chroma + row * strides[3], *bright = light + row * strides[4];
        const uint8_t *known = sure + row * strides[5];
        for (int n = 0; n < width; ++n) {
            const int32_t id = own[n];
            if (!id) continue;
            ++pixels[id];
            sure_ones[id] += known[n] != 0;
            for (int i = 0; i < 3; ++i) colors[4 * id + i] += hue[i * strides[2] + n];
            colors[4 * id + 3] += bright[n];
        }
    }
    for (int pass = 0; pass < 2; ++pass) {
        for (int row = 0; row < height; ++row) {
            const int32_t *own = ids + (size_t)row * width;
            const float *at = points + row * strides[1];
            const uint8_t *known = sure + row * strides[5];
            for (int n = 0; n < width; ++n) {
                const int32_t id = own[n];
                if (!id || (!known[n] && sure_ones[id] >= few)) continue;
                double *centre = centres + 3 * id, *spread = spreads + 6 * id;
                if (!pass) {
                    for (int i = 0; i < 3; ++i) centre[i] += at[i * strides[0] + n];
                    continue;
                }
                const double x = at[n] - centre[0], y = at[strides[0] + n] - centre[1];
                const double z = at[2 * strides[0] + n] - centre[2];
                spread[0] += x * x;
                spread[1] += x * y;
                spread[2] += x * z;
                spread[3] += y * y;
                spread[4] += y * z;
                spread[5] += z * z;
            }
        }
        for (int id = 0; id < facets; ++id) {
            const int64_t relied = sure_ones[id] < few ? pixels[id] : sure_ones[id];
            const double share = relied ? (double)relied : 1.0;
            for (int i = 0; i < (pass ? 6 : 3); ++i)
                (pass ? spreads + 6 * id : centres + 3 * id)[i] /= share;
        }
    }
    for (int id = 0; id < facets; ++id)
        for (int i = 0; i < 4; ++i) colors[4 * id + i] /= pixels[id] ? (double)pixels[id] : 1.0;
}

/* How many pixels facets have, and how many of some; see `counts`. found: (2, F), zero at first. */
void counts(int count, const int32_t *ids, const uint8_t *some, int facets, int64_t *found) {
    int64_t *of_some = found + facets, pixels = 0, marked = 0;
    for (int n = 0; n < count; ++n) {
        ++pixels;
        marked += some[n];
        if (n + 1 < count && ids[n + 1] == ids[n]) continue;
        found[ids[n]] += pixels;
        of_some[ids[n]] += marked;
        pixels = marked = 0;
    }
}

/* Sums of chroma over a mask, in the order in which numpy adds. chroma: (3, n). */
void chromas(int count, const uint8_t *mask, const float *chroma, float *total) {
    for (int n = 0; n < count; ++n)
        if (mask[n])
            for (int i = 0; i < 3; ++i) total[i] += chroma[(size_t)i * count + n];
}
