// SPDX-License-Identifier: Apache-2.0
// Shorter plans, see reinsertion.py: the same way, many times as quickly.

#include <stdint.h>
#include <string.h>

enum { MOST_PLACES = 16, MOST_BLOCKS = 64, MOST_STEPS = 1024, UNREACHED = 16000 };

typedef struct {
    uint8_t block, source, target;
} Step;

// The last move of a block on its way to a spot; the index of the one before it, or -1.
typedef struct {
    int before_it, step;
    uint8_t source, target;
} Way;

typedef struct {
    int blocks, places;
    uint64_t random;
    uint8_t place[2][MOST_BLOCKS], level[2][MOST_BLOCKS];  // at start and goal
    uint8_t stack[2][MOST_PLACES][MOST_BLOCKS], height[2][MOST_PLACES];
    // Of the block that is put back, see `with_block`.
    int16_t cost[MOST_PLACES][MOST_BLOCKS + 1];
    int last[MOST_PLACES][MOST_BLOCKS + 1];
    Way ways[MOST_STEPS * MOST_PLACES];
} Work;

static int drawn(Work *work, int below) {
    work->random ^= work->random << 13;
    work->random ^= work->random >> 7;
    work->random ^= work->random << 17;
    return (int)(((work->random >> 32) * (uint64_t)below) >> 32);
}

// The plan with a block's cheapest way among the steps of others, put between them; returns its
// length, or -1 where there is no way. Blocks that are `absent` have no steps yet.
static int with_block(Work *work, const Step *steps, int count, Step *result, int block,
                      uint64_t absent) {
    int places = work->places, top[MOST_PLACES], made = 0;
    for (int place = 0; place < places; place++) {
        int height = 0, own = -1;
        for (int level = 0; level < work->height[0][place]; level++) {
            int other = work->stack[0][place][level];
            if (other == block) own = height;
            else height += !(absent >> other & 1);
        }
        for (int level = 0; level <= height; level++) {
            work->cost[place][level] = level == own ? 0 : UNREACHED;
            work->last[place][level] = -1;
        }
        top[place] = height;
    }
    for (int i = 0; i <= count; i++) {
        int source = 0, least = UNREACHED;
        for (int place = 0; place < places; place++)
            if (work->cost[place][top[place]] < least) {
                least = work->cost[place][top[place]];
                source = place;
            }
        if (least < UNREACHED)
            for (int place = 0; place < places; place++) {
                int16_t *cost = &work->cost[place][top[place]];
                // Ways alike are drawn from, so that plans differ that are as long.
                if (*cost > least + 1
                    || (*cost == least + 1 && place != source && drawn(work, 2))) {
                    work->ways[made] = (Way){work->last[source][top[source]], i, source, place};
                    work->last[place][top[place]] = made++;
                    *cost = least + 1;
                }
            }
        if (i < count) {
            // Who stands on the block that moves is in its way.
            int target = steps[i].target;
            top[steps[i].source]--;
            top[target]++;
            work->cost[target][top[target]] = UNREACHED;
            work->last[target][top[target]] = -1;
        }
    }
    int place = work->place[1][block], level = 0;
    for (int below = 0; below < work->level[1][block]; below++)
        level += !(absent >> work->stack[1][place][below] & 1);
    int own = work->cost[place][level], from = count, to = count + own;
    if (own >= UNREACHED || to > MOST_STEPS) return -1;
    for (int way = work->last[place][level]; way >= 0; way = work->ways[way].before_it) {
        int behind = from - work->ways[way].step;
        from -= behind;
        to -= behind;
        memcpy(result + to, steps + from, behind * sizeof(Step));
        result[--to] = (Step){block, work->ways[way].source, work->ways[way].target};
    }
    memcpy(result, steps, from * sizeof(Step));
    return count + own;
}

// Blocks to take out, in the order in which they come back; returns how many.
static int choose(Work *work, int most_out, int near, int *out) {
    int number = 1 + drawn(work, most_out), some[MOST_BLOCKS], count = 0;
    int one = drawn(work, work->blocks), kept = 0;
    if (drawn(work, 2)) {
        for (int block = 0; block < work->blocks; block++) some[count++] = block;
    } else {
        int place = work->place[1][one], level = work->level[1][one];
        for (int other = level - near; other <= level + near; other++)
            if (other >= 0 && other != level && other < work->height[1][place])
                some[count++] = work->stack[1][place][other];
        out[kept++] = one;
    }
    while (kept < number && count > 0) {
        int j = drawn(work, count);
        out[kept++] = some[j];
        some[j] = some[--count];
    }
    int j = drawn(work, kept), first = out[0];
    out[0] = out[j];
    out[j] = first;
    return kept;
}

static void set_up(Work *work, int blocks, int places, const uint16_t *start, const uint16_t *goal) {
    memset(work, 0, sizeof *work);
    work->blocks = blocks;
    work->places = places;
    work->random = 0x9E3779B97F4A7C15u;
    for (int end = 0; end < 2; end++)
        for (int block = 0; block < blocks; block++) {
            int spot = (end ? goal : start)[block];
            int place = spot / MOST_BLOCKS, level = spot % MOST_BLOCKS;
            work->place[end][block] = place;
            work->level[end][block] = level;
            work->stack[end][place][level] = block;
            work->height[end][place]++;
        }
}

int room(void) { return sizeof(Work); }

// A plan that is no longer, in place of `plan`; returns its length. Spots are place * MOST_BLOCKS +
// level. `worse` of a thousand plans that are one move longer are gone on with. It ends when the
// plan has `enough` moves, when `effort` moves of plans were looked at, or when `go_on`, which is
// told of every `chunk` of them, says 0.
int shorten(Work *work, int blocks, int places, const uint16_t *start, const uint16_t *goal,
            Step *plan, int length, double enough, long effort, int most_out, int near, int worse,
            int chunk, int (*go_on)(int)) {
    Step now[MOST_STEPS], one[MOST_STEPS], other[MOST_STEPS];
    int count = length, best = length;
    long looked = 0;
    set_up(work, blocks, places, start, goal);
    memcpy(now, plan, length * sizeof(Step));
    while (best > enough && effort > 0) {
        int out[MOST_BLOCKS], number = choose(work, most_out, near, out), changed = 0;
        uint64_t absent = 0;
        effort -= (long)number * count;
        looked += (long)number * count;
        if (looked >= chunk) {
            if (!go_on(chunk)) break;
            looked -= chunk;
        }
        for (int i = 0; i < number; i++) absent |= (uint64_t)1 << out[i];
        Step *from = one, *to = other;
        for (int i = 0; i < count; i++)
            if (!(absent >> now[i].block & 1)) from[changed++] = now[i];
        for (int i = 0; i < number && changed >= 0; i++) {
            absent &= ~((uint64_t)1 << out[i]);
            changed = with_block(work, from, changed, to, out[i], absent);
            Step *used = from;
            from = to;
            to = used;
        }
        if (changed < 0 || changed > count + (drawn(work, 1000) < worse)) continue;
        memcpy(now, from, changed * sizeof(Step));
        count = changed;
        if (count < best) {
            best = count;
            memcpy(plan, now, count * sizeof(Step));
        }
    }
    return best;
}
