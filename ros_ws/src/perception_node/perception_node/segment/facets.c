/* SPDX-License-Identifier: Apache-2.0
 *
 * What facets.py says, pixel by pixel; see there. Images by rows.
 */
#include <math.h>
#include <stddef.h>
#include <stdint.h>

/* The look of colours; see `Look`. rgb: (h, w, 3); chroma: (3, h, w), light: (h, w). */
void look(int height, int width, const uint8_t *rgb, float dark, float *chroma, float *light) {
    const size_t size = (size_t)height * width;
    float logarithm[3 * 255 + 1];
    for (int sum = 0; sum <= 3 * 255; ++sum) logarithm[sum] = logf((float)sum + 3.0f * dark);
    for (int row = 0; row < height; ++row) {
        const uint8_t *code = rgb + 3 * (size_t)row * width;
        float *restrict red = chroma + (size_t)row * width;
        float *restrict green = red + size, *restrict blue = green + size;
        float *bright = light + (size_t)row * width;
        for (int n = 0; n < width; ++n) {
            red[n] = code[3 * n];
            green[n] = code[3 * n + 1];
            blue[n] = code[3 * n + 2];
            bright[n] = logarithm[code[3 * n] + code[3 * n + 1] + code[3 * n + 2]];
        }
        for (int n = 0; n < width; ++n) {
            const float r = red[n] + dark, g = green[n] + dark, b = blue[n] + dark;
            const float total = r + g + b;
            red[n] = r / total;
            green[n] = g / total;
            blue[n] = b / total;
        }
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

/* Sums over the pixels of each facet; see `Sums`.
 *
 * ids: (n), 0 for those of no facet; points, chroma: (3, n); few: a facet with fewer sure pixels has all of them counted.
 * pixels, sure_ones: (F); colors: of chroma and light, (F, 4); centres: means of the points that
 * count, (F, 3); spreads: of their products, xx xy xz yy yz zz, (F, 6). All zero at first. */
void sums(int count, int facets, const int32_t *ids, const uint8_t *sure, const float *points,
          const float *chroma, const float *light, int few, int64_t *pixels, int64_t *sure_ones,
          double *colors, double *centres, double *spreads) {
    for (int n = 0; n < count; ++n) {
        const int32_t id = ids[n];
        if (!id) continue;
        ++pixels[id];
        sure_ones[id] += sure[n] != 0;
        for (int i = 0; i < 3; ++i) colors[4 * id + i] += chroma[(size_t)i * count + n];
        colors[4 * id + 3] += light[n];
    }
    for (int pass = 0; pass < 2; ++pass) {
        for (int n = 0; n < count; ++n) {
            const int32_t id = ids[n];
            if (!id || (!sure[n] && sure_ones[id] >= few)) continue;
            const float point[3] = {points[n], points[count + n], points[2 * (size_t)count + n]};
            double *centre = centres + 3 * id, *spread = spreads + 6 * id;
            if (!pass) {
                for (int i = 0; i < 3; ++i) centre[i] += point[i];
                continue;
            }
            const double x = point[0] - centre[0], y = point[1] - centre[1], z = point[2] - centre[2];
            spread[0] += x * x;
            spread[1] += x * y;
            spread[2] += x * z;
            spread[3] += y * y;
            spread[4] += y * z;
            spread[5] += z * z;
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
