/* SPDX-License-Identifier: Apache-2.0
 *
 * What facets.py says, pixel by pixel; see there. Images by rows.
 */
#include <math.h>
#include <stdint.h>

/* The look of colours; see `Look`. rgb: (n, 3); chroma: (n, 3), light: (n). */
void look(int count, const uint8_t *rgb, float dark, float *chroma, float *light) {
    float logarithm[3 * 255 + 1];
    for (int sum = 0; sum <= 3 * 255; ++sum) logarithm[sum] = logf((float)sum + 3.0f * dark);
    for (int n = 0; n < count; ++n, rgb += 3, chroma += 3) {
        const int sum = rgb[0] + rgb[1] + rgb[2];
        const float red = rgb[0] + dark, green = rgb[1] + dark, blue = rgb[2] + dark;
        const float total = red + green + blue;
        chroma[0] = red / total;
        chroma[1] = green / total;
        chroma[2] = blue / total;
        light[n] = logarithm[sum];
    }
}

static int same(const float *chroma, const float *light, const float *depth, int a, int b,
                const float *steps) {
    const float *one = chroma + 3 * a, *other = chroma + 3 * b;
    const float red = one[0] - other[0], green = one[1] - other[1], blue = one[2] - other[2];
    return (red * red + green * green + blue * blue < steps[0]) &
           (fabsf(light[a] - light[b]) < steps[1]) & !(fabsf(depth[a] - depth[b]) > steps[2]);
}

/* Which neighbours look alike, with no jump of depth between them; see `find_facets`.
 *
 * steps: of chroma, squared, light and depth; down: (h - 1, w), right: (h, w - 1). */
void links(int height, int width, const float *chroma, const float *light, const float *depth,
           const float *steps, uint8_t *down, uint8_t *right) {
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column) {
            const int at = row * width + column;
            if (row < height - 1) down[at] = same(chroma, light, depth, at, at + width, steps);
            if (column < width - 1)
                right[at - row] = same(chroma, light, depth, at, at + 1, steps);
        }
}

/* Which neighbours can be of one block; see `on_one_body`. steps: of depth, of a lid's height, of a
 * lid's depth. */
void bodies(int height, int width, const float *points, const float *depth, const float *steps,
            uint8_t *down, uint8_t *right) {
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column)
            for (int axis = 0; axis < 2; ++axis) {
                if (axis ? column == width - 1 : row == height - 1) continue;
                const int at = row * width + column, other = at + (axis ? 1 : width);
                const float jump = fabsf(depth[at] - depth[other]);
                const float climb = fabsf(points[3 * at + 2] - points[3 * other + 2]);
                const int near = !(jump > steps[0]) | ((climb < steps[1]) & (jump < steps[2]));
                *(axis ? right + at - row : down + at) = (uint8_t)near;
            }
}

/* Sums over the pixels of each facet; see `Sums`.
 *
 * ids: (n), 0 for those of no facet; few: a facet with fewer sure pixels has all of them counted.
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
        for (int i = 0; i < 3; ++i) colors[4 * id + i] += chroma[3 * n + i];
        colors[4 * id + 3] += light[n];
    }
    for (int pass = 0; pass < 2; ++pass) {
        for (int n = 0; n < count; ++n) {
            const int32_t id = ids[n];
            if (!id || (!sure[n] && sure_ones[id] >= few)) continue;
            const float *point = points + 3 * n;
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
