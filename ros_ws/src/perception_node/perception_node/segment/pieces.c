/* SPDX-License-Identifier: Apache-2.0
 *
 * What pieces.py says, pixel by pixel; see there. Images by rows.
 */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

static int32_t root_of(int32_t *parent, int32_t at) {
    while (parent[at] != at) at = parent[at] = parent[parent[at]];
    return at;
}

static int32_t joined(int32_t *parent, int32_t one, int32_t other) {
    one = root_of(parent, one);
    other = root_of(parent, other);
    if (one < other) return parent[other] = one;
    return parent[one] = other;
}

/* Which neighbours have the same number; see `links_of`. */
void of_one(int height, int width, const int32_t *ids, uint8_t *restrict down,
            uint8_t *restrict right) {
    for (int row = 0; row < height; ++row) {
        const int32_t *own = ids + (size_t)row * width, *below = own + width;
        uint8_t *under = down + (size_t)row * width, *beside = right + (size_t)row * (width - 1);
        if (row < height - 1)
            for (int n = 0; n < width; ++n) under[n] = (own[n] == below[n]) & (own[n] > 0);
        for (int n = 0; n < width - 1; ++n) beside[n] = (own[n] == own[n + 1]) & (own[n] > 0);
    }
}

/* Numbers of the pieces that linked pixels make, by their first pixels; see `connected`.
 *
 * ids: (h, w), 0 for what is no pixel. Returns how many there are, with that of no pixel, or -1. */
int connected(int height, int width, const uint8_t *pixels, const uint8_t *down,
              const uint8_t *right, int32_t *ids) {
    int32_t *parent = malloc(sizeof(int32_t) * ((size_t)height * width + 1)), count = 1;
    if (!parent) return -1;
    parent[0] = 0;
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column) {
            const int at = row * width + column;
            ids[at] = 0;
            if (!pixels[at]) continue;
            const int32_t above = row && down[at - width] ? ids[at - width] : 0;
            const int32_t left = column && right[at - row - 1] ? ids[at - 1] : 0;
            if (above && left)
                ids[at] = above == left ? above : joined(parent, above, left);
            else if (above || left)
                ids[at] = above + left;
            else {
                parent[count] = count;
                ids[at] = count++;
            }
        }
    /* A root is the least of its piece, so it has its number before the others need it. */
    int32_t found = 1;
    for (int32_t n = 1; n < count; ++n) parent[n] = parent[n] == n ? found++ : parent[parent[n]];
    for (int at = 0; at < height * width; ++at) ids[at] = parent[ids[at]];
    free(parent);
    return found;
}

typedef struct {
    uint64_t key; /* 0 where there is none: no facet has the number 0 */
    int64_t length;
} Border;

static void add_border(Border *borders, uint32_t mask, int32_t one, int32_t other) {
    const uint64_t low = one < other ? one : other, high = one < other ? other : one;
    const uint64_t key = low << 32 | high;
    uint32_t at = (uint32_t)((key * 0x9E3779B97F4A7C15u) >> 32) & mask;
    while (borders[at].key && borders[at].key != key) at = (at + 1) & mask;
    borders[at].key = key;
    ++borders[at].length;
}

/* Pairs of facets that meet, and how often; see `borders`. In no order.
 *
 * found: (most, 3). Returns how many there are, more than `most` if that is too few; -1 without
 * memory. */
int borders(int height, int width, int numberings, const int32_t *ids, int most, int64_t *found) {
    uint32_t meet = 0, size = 64;
    const int pixels = height * width;
    for (int pass = 0; pass < 2; ++pass) {
        Border *all = NULL;
        if (pass) {
            while (size < 2 * meet) size *= 2;
            all = calloc(size, sizeof(Border));
            if (!all) return -1;
        }
        for (int n = 0; n < numberings; ++n)
            for (int row = 0; row < height; ++row)
                for (int column = 0; column < width; ++column) {
                    const int32_t *at = ids + (size_t)n * pixels + row * width + column;
                    const int32_t mine = at[0];
                    if (!mine) continue;
                    for (int axis = 0; axis < 2; ++axis) {
                        if (axis ? column == width - 1 : row == height - 1) continue;
                        const int32_t theirs = at[axis ? 1 : width];
                        if (!theirs || theirs == mine) continue;
                        if (pass)
                            add_border(all, size - 1, mine, theirs);
                        else
                            ++meet;
                    }
                }
        if (!pass) continue;
        int count = 0;
        for (uint32_t at = 0; at < size; ++at) {
            if (!all[at].key) continue;
            if (count < most) {
                found[3 * count] = (int64_t)(all[at].key >> 32);
                found[3 * count + 1] = (int64_t)(all[at].key & 0xFFFFFFFFu);
                found[3 * count + 2] = all[at].length;
            }
            ++count;
        }
        free(all);
        return count;
    }
    return -1;
}

/* Labels for free pixels without one, from their neighbours; see `spread`.
 *
 * down, right: NULL: labels pass between all neighbours; heights: (h, w), NULL: pixels may have any
 * label; low, high: between which heights those of a label are, by label. */
int spread(int height, int width, int32_t *labels, const uint8_t *free_ones, int times,
           const uint8_t *down, const uint8_t *right, const float *heights, const double *low,
           const double *high) {
    int count = 0, pixels = height * width;
    for (int at = 0; at < pixels; ++at) count += free_ones[at] && !labels[at];
    int32_t *todo = malloc(sizeof(int32_t) * 2 * (count ? count : 1)), *given = todo + count;
    if (!todo) return -1;
    count = 0;
    for (int at = 0; at < pixels; ++at)
        if (free_ones[at] && !labels[at]) todo[count++] = at;
    for (int k = 0; k < times && count; ++k) {
        int some = 0;
        for (int n = 0; n < count; ++n) {
            const int at = todo[n], row = at / width, column = at % width;
            const int there[4] = {at + width, at - width, at + 1, at - 1};
            const int inside[4] = {row < height - 1, row > 0, column < width - 1, column > 0};
            given[n] = 0;
            for (int way = 0; way < 4 && !given[n]; ++way) {
                if (!inside[way] || !labels[there[way]]) continue;
                if (down) {
                    const int first = way & 1 ? there[way] : at;
                    if (!(way < 2 ? down[first] : right[first - row])) continue;
                }
                const int32_t label = labels[there[way]];
                if (!heights || (heights[at] > low[label] && heights[at] < high[label]))
                    given[n] = label;
            }
            some |= given[n];
        }
        if (!some) break;
        int left = 0;
        for (int n = 0; n < count; ++n) {
            if (given[n])
                labels[todo[n]] = given[n];
            else
                todo[left++] = todo[n];
        }
        count = left;
    }
    free(todo);
    return 0;
}

static void swap(float *one, float *other) {
    const float kept = *one;
    *one = *other;
    *other = kept;
}

/* The value of a rank, to whose left none is greater then (Hoare's selection). */
static float of_rank(float *values, int count, int rank) {
    int low = 0, high = count - 1;
    while (low < high) {
        const float middle = values[low + (high - low) / 2];
        int i = low, j = high;
        while (i <= j) {
            while (values[i] < middle) ++i;
            while (values[j] > middle) --j;
            if (i <= j) swap(values + i++, values + j--);
        }
        if (rank <= j)
            high = j;
        else if (rank >= i)
            low = i;
        else
            break;
    }
    return values[rank];
}

/* As numpy rounds it. */
static double quantile(float *values, int count, double share) {
    const double at = share * (count - 1), part = at - floor(at);
    const int below = (int)at;
    const float low = of_rank(values, count, below);
    if (below + 1 >= count) return low;
    float high = values[below + 1];
    for (int n = below + 2; n < count; ++n)
        if (values[n] < high) high = values[n];
    const float apart = high - low;
    return part < 0.5 ? low + apart * part : high - apart * (1.0 - part);
}

/* Quantiles of values by number; see `ends_by_number`.
 *
 * numbers: (n), 0 for what is left out; values: (axes, n); found: (shares, count, axes), changed
 * where there are values of a number. NaN counts as none. */
int quantiles(int pixels, const int32_t *numbers, int axes, const float *values, int count,
              int shares, const double *share, double *found) {
    int *begins = calloc((size_t)count + 1, sizeof(int)), numbered = 0;
    for (int n = 0; n < pixels; ++n) numbered += numbers[n] != 0;
    int *order = malloc(sizeof(int) * (numbered ? numbered : 1));
    float *own = malloc(sizeof(float) * (numbered ? numbered : 1));
    if (!begins || !order || !own) {
        free(begins);
        free(order);
        free(own);
        return -1;
    }
    for (int n = 0; n < pixels; ++n)
        if (numbers[n]) ++begins[numbers[n]];
    for (int number = 0, sum = 0; number <= count; ++number) {
        const int many = number && number < count ? begins[number] : 0;
        begins[number] = sum;
        sum += many;
    }
    for (int n = 0; n < pixels; ++n)
        if (numbers[n]) order[begins[numbers[n]]++] = n;
    /* Now each begins where the one before it did: what was its begin is its end. */
    for (int axis = 0; axis < axes; ++axis) {
        const float *mine = values + (size_t)axis * pixels;
        for (int number = 1, begin = 0; number < count; ++number) {
            int known = 0;
            for (int n = begin; n < begins[number]; ++n)
                if (!isnan(mine[order[n]])) own[known++] = mine[order[n]];
            for (int k = 0; known && k < shares; ++k)
                found[((size_t)k * count + number) * axes + axis] =
                    quantile(own, known, share[k]);
            begin = begins[number];
        }
    }
    free(begins);
    free(order);
    free(own);
    return 0;
}
