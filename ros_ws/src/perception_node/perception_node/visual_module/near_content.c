/* SPDX-License-Identifier: Apache-2.0
 *
 * What near_content.py moves about in memory.
 */
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* Squares with what is around them in an empty image; see `_surrounded`.
 *
 * patch: (n, own, own, channels); empty: (rows, width, channels); begins: of the larger squares in
 * it, and of the patches in those, rows and columns, (n, 4); around: (n, side, side, channels). */
void surrounded(int count, int own, int side, int width, int channels, const float *patch,
                const float *empty, const int *begins, float *around) {
    const size_t pixel = sizeof(float) * channels;
    for (int n = 0; n < count; ++n, begins += 4) {
        float *out = around + (size_t)n * side * side * channels;
        const float *mine = patch + (size_t)n * own * own * channels;
        for (int row = 0; row < side; ++row) {
            float *line = out + (size_t)row * side * channels;
            const float *bare = empty + ((size_t)(begins[0] + row) * width + begins[1]) * channels;
            const int inner = row - begins[2];
            if (inner < 0 || inner >= own) {
                memcpy(line, bare, pixel * side);
                continue;
            }
            const int left = begins[3], right = left + own;
            memcpy(line, bare, pixel * left);
            memcpy(line + (size_t)left * channels, mine + (size_t)inner * own * channels,
                   pixel * own);
            memcpy(line + (size_t)right * channels, bare + (size_t)right * channels,
                   pixel * (side - right));
        }
    }
}

/* Where images are not zero; see `ends_by_numpy`. images: (n, channels, h, w); first, last: rows and
 * columns, the last ones those after it, (n, 2). */
void content(int count, int channels, int height, int width, const float *images, int64_t *first,
             int64_t *last) {
    for (int n = 0; n < count; ++n, first += 2, last += 2) {
        int top = height, bottom = 0, left = width, right = 0;
        for (int channel = 0; channel < channels; ++channel)
            for (int row = 0; row < height; ++row, images += width) {
                int some = 0;
                for (int column = 0; column < width; ++column) some |= images[column] != 0.0f;
                if (!some) continue;
                int begin = 0, end = width;
                while (images[begin] == 0.0f) ++begin;
                while (images[end - 1] == 0.0f) --end;
                top = row < top ? row : top;
                bottom = row >= bottom ? row + 1 : bottom;
                left = begin < left ? begin : left;
                right = end > right ? end : right;
            }
        first[0] = bottom ? top : 0;
        first[1] = bottom ? left : 0;
        last[0] = bottom ? bottom : height;
        last[1] = bottom ? right : width;
    }
}
