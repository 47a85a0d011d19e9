/* SPDX-License-Identifier: Apache-2.0
 *
 * What leaks.py says, pixel by pixel; see there.
 */
#include <stdint.h>

/* The facets of pixels that are amid them; of the others 0 in `low` and `none` in `high`. */
void part(int count, const int32_t *ids, const uint8_t *inner, float none, float *low,
          float *high) {
    for (int n = 0; n < count; ++n) {
        const int own = inner[n] & (ids[n] > 0);
        const float id = (float)ids[n];
        low[n] = own ? id : 0.0f;
        high[n] = own ? id : none;
    }
}

/* Which pixels are near those; see `_wide`. */
void wide(int count, const int32_t *ids, const float *grown, const float *least,
          uint8_t *restrict out) {
    for (int n = 0; n < count; ++n) {
        const float id = (float)ids[n];
        out[n] = (ids[n] > 0) & ((grown[n] == id) | (least[n] == id));
    }
}

void owners(int count, const int32_t *ids, const int32_t *pieces, int32_t *owner) {
    for (int n = 0; n < count; ++n)
        if (pieces[n]) owner[pieces[n]] = ids[n];
}

void of_largest(int count, const int32_t *ids, const int32_t *pieces, const int32_t *largest,
                int32_t *found) {
    for (int n = 0; n < count; ++n)
        found[n] = pieces[n] && largest[ids[n]] == pieces[n] ? ids[n] : 0;
}

void beyond(int count, const int32_t *ids, const float *height, const double *low,
            const double *high, int64_t *found) {
    for (int n = 0; n < count; ++n)
        if (ids[n] && (height[n] < low[ids[n]] || height[n] > high[ids[n]])) ++found[ids[n]];
}

void kept(int count, const int32_t *ids, const uint8_t *wide, const uint8_t *leaks,
          uint8_t *restrict out) {
    for (int n = 0; n < count; ++n) out[n] = ids[n] > 0 && (wide[n] || !leaks[ids[n]]);
}
