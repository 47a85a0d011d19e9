// SPDX-License-Identifier: Apache-2.0
// Moves that parts of the blocks need at least, see part_bounds.py and group_tables.py.
//
// A pattern of a group of k blocks is its composition (how many stand on each place) times k!, plus
// the rank of its permutation (the blocks' labels from the first place to the last). Labels ascend
// in the goal, whose permutation is 0, and places are ordered by their heights there, so that all
// goals of one shape share a table of distances.

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_PLACES = 16, MOST_IN_GROUP = 8, MOST_GROUPS = 4, MOST_BLOCKS = 64, NO_MOVE = 0xffff };

typedef unsigned __int128 Key;

// All patterns of groups of one size.
typedef struct {
    int places, size, compositions, permutations;
    const uint16_t *turned;      // [from * size + to][permutation]: after a label goes there
    const uint16_t *after;       // [composition][source * places + target]: the composition, NO_MOVE
    const uint8_t *turn;         // there: the row of `turned`
    const uint8_t *heights;      // [composition][place]
    const int32_t *before;       // [place][left][height]: compositions that come before
    const uint8_t *const *tables;  // of a goal's composition with descending heights: distances
} Patterns;

typedef struct {
    const Patterns *patterns;
    uint8_t place[MOST_PLACES];  // the group's own number of each place
    uint32_t start, goal;        // patterns
    const uint8_t *distances[2]; // to the goal, to the start
    int shift, bits;             // of its pattern in a key
} Group;

static int rank(const uint8_t *labels, int size) {
    uint32_t left = (1u << size) - 1;
    int number = 0;
    for (int i = 0; i < size; i++) {
        number = number * (size - i) + __builtin_popcount(left & ((1u << labels[i]) - 1));
        left &= ~(1u << labels[i]);
    }
    return number;
}

static void unrank(int number, int size, uint8_t *labels) {
    uint8_t digits[MOST_IN_GROUP];
    for (int i = size - 1; i >= 0; i--) {
        digits[i] = number % (size - i);
        number /= size - i;
    }
    uint32_t left = (1u << size) - 1;
    for (int i = 0; i < size; i++) {
        uint32_t rest = left;
        for (int j = 0; j < digits[i]; j++) rest &= rest - 1;
        labels[i] = __builtin_ctz(rest);
        left &= ~(1u << labels[i]);
    }
}

void fill_turned(int size, int permutations, uint16_t *turned) {
    uint8_t labels[MOST_IN_GROUP], other[MOST_IN_GROUP];
    for (int number = 0; number < permutations; number++) {
        unrank(number, size, labels);
        for (int from = 0; from < size; from++)
            for (int to = 0; to < size; to++) {
                memcpy(other, labels, size);
                if (from < to) memmove(other + from, other + from + 1, to - from);
                else memmove(other + to + 1, other + to, from - to);
                other[to] = labels[from];
                turned[(size_t)(from * size + to) * permutations + number] = rank(other, size);
            }
    }
}

// Breadth-first, the permutations of one composition together; `some` has room for all of them.
void fill_distances(const Patterns *p, uint32_t from, uint8_t *distances, uint16_t *some) {
    int ways = p->places * p->places, any = 1;
    memset(distances, 255, (size_t)p->compositions * p->permutations);
    distances[from] = 0;
    for (int depth = 0; any; depth++) {
        any = 0;
        for (int c = 0; c < p->compositions; c++) {
            const uint8_t *row = distances + (size_t)c * p->permutations;
            int count = 0;
            for (int i = 0; i < p->permutations; i++) {
                some[count] = i;
                count += row[i] == depth;
            }
            if (!count) continue;
            any = 1;
            for (int way = c * ways; way < (c + 1) * ways; way++) {
                if (p->after[way] == NO_MOVE) continue;
                uint8_t *to = distances + (size_t)p->after[way] * p->permutations;
                const uint16_t *turned = p->turned + (size_t)p->turn[way] * p->permutations;
                for (int i = 0; i < count; i++) {
                    uint8_t *value = to + turned[some[i]];
                    if (*value > depth + 1) *value = depth + 1;
                }
            }
        }
    }
}

static uint32_t composition(const Patterns *p, const uint8_t *heights) {
    int left = p->size, number = 0;
    for (int place = 0; place < p->places; place++) {
        number += p->before[(place * (p->size + 1) + left) * (p->size + 1) + heights[place]];
        left -= heights[place];
    }
    return number;
}

static void sort_by(uint8_t *blocks, int count, const uint16_t *value) {
    for (int i = 1; i < count; i++)
        for (int j = i; j > 0 && value[blocks[j]] < value[blocks[j - 1]]; j--) {
            uint8_t other = blocks[j];
            blocks[j] = blocks[j - 1];
            blocks[j - 1] = other;
        }
}

// Moves that some blocks need by themselves; spots are place * MOST_BLOCKS + level, at start and
// goal. Fills `group`, but for the distances to the start and the key's bits.
int set_group(const Patterns *p, const uint8_t *blocks, const uint16_t *start, const uint16_t *goal,
              Group *group) {
    uint8_t heights[2][MOST_PLACES] = {{0}}, own[2][MOST_PLACES], order[MOST_PLACES];
    uint8_t at_goal[MOST_IN_GROUP], at_start[MOST_IN_GROUP], label[MOST_BLOCKS];
    uint16_t along[2][MOST_BLOCKS];
    for (int i = 0; i < p->size; i++) {
        heights[0][start[blocks[i]] / MOST_BLOCKS]++;
        heights[1][goal[blocks[i]] / MOST_BLOCKS]++;
    }
    for (int i = 0; i < p->places; i++) {
        int j = i;
        for (; j > 0 && heights[1][i] > heights[1][order[j - 1]]; j--) order[j] = order[j - 1];
        order[j] = i;
    }
    for (int i = 0; i < p->places; i++) {
        group->place[order[i]] = i;
        for (int end = 0; end < 2; end++) own[end][i] = heights[end][order[i]];
    }
    for (int i = 0; i < p->size; i++) {
        int block = blocks[i];
        at_goal[i] = at_start[i] = block;
        for (int end = 0; end < 2; end++) {
            int spot = (end ? goal : start)[block];
            along[end][block] = group->place[spot / MOST_BLOCKS] * MOST_BLOCKS + spot % MOST_BLOCKS;
        }
    }
    sort_by(at_start, p->size, along[0]);
    sort_by(at_goal, p->size, along[1]);
    for (int i = 0; i < p->size; i++) label[at_goal[i]] = i;
    for (int i = 0; i < p->size; i++) at_start[i] = label[at_start[i]];
    uint32_t shape = composition(p, own[1]);
    group->patterns = p;
    group->start = composition(p, own[0]) * p->permutations + rank(at_start, p->size);
    group->goal = shape * p->permutations;
    group->distances[0] = p->tables[shape];
    return group->distances[0][group->start];
}

static int drawn(uint64_t *state, int below) {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return (int)(((*state >> 32) * (uint64_t)below) >> 32);
}

// The order of blocks whose cuts into groups have the largest sum that exchanges of two blocks
// lead to, from several random orders; returns the sum.
int best_split(int count, const Patterns *const *patterns, int blocks, uint8_t *order,
               const uint16_t *start, const uint16_t *goal, int restarts, int exchanges) {
    uint64_t random = 0x9E3779B97F4A7C15u;
    uint8_t now[MOST_BLOCKS], group_of[MOST_BLOCKS];
    int first[MOST_BLOCKS], moves[MOST_BLOCKS], best = -1;
    Group group;
    for (int g = 0, at = 0; g < count; g++) {
        first[g] = at;
        for (int i = 0; i < patterns[g]->size; i++) group_of[at++] = g;
    }
    memcpy(now, order, blocks);
    for (int trial = 0; trial < restarts; trial++) {
        for (int i = blocks - 1; i > 0; i--) {
            int j = drawn(&random, i + 1), other = now[i];
            now[i] = now[j];
            now[j] = other;
        }
        int sum = 0;
        for (int g = 0; g < count; g++)
            sum += moves[g] = set_group(patterns[g], now + first[g], start, goal, &group);
        for (int step = 0; step <= exchanges; step++) {
            if (sum > best) {
                best = sum;
                memcpy(order, now, blocks);
            }
            int i = drawn(&random, blocks), j = drawn(&random, blocks);
            int a = group_of[i], b = group_of[j], block = now[i];
            if (a == b) continue;
            now[i] = now[j];
            now[j] = block;
            int in_a = set_group(patterns[a], now + first[a], start, goal, &group);
            int in_b = set_group(patterns[b], now + first[b], start, goal, &group);
            if (in_a + in_b >= moves[a] + moves[b]) {
                sum += in_a + in_b - moves[a] - moves[b];
                moves[a] = in_a;
                moves[b] = in_b;
            } else {
                now[j] = now[i];
                now[i] = block;
            }
        }
    }
    return best;
}

// Keys plus one in open addressing; 0 is a free slot.
typedef struct {
    Key *slots;
    size_t room, count;
} Set;

static size_t slot_of(const Set *set, Key key) {
    uint64_t x = (uint64_t)key ^ (uint64_t)(key >> 64) * 0x9E3779B97F4A7C15u;
    x = (x ^ x >> 32) * 0xd6e8feb86659fd93u;
    x = (x ^ x >> 29) * 0xd6e8feb86659fd93u;
    size_t slot = (x ^ x >> 32) & (set->room - 1);
    while (set->slots[slot] && set->slots[slot] != key + 1) slot = (slot + 1) & (set->room - 1);
    return slot;
}

static int set_up(Set *set, size_t room) {
    set->room = room;
    set->count = 0;
    set->slots = calloc(room, sizeof(Key));
    return set->slots != NULL;
}

// 1: it is new; 0: it is known; -1: no memory.
static int add(Set *set, Key key) {
    if (5 * set->count >= 3 * set->room) {
        Set larger;
        if (!set_up(&larger, set->room * 2)) return -1;
        for (size_t i = 0; i < set->room; i++)
            if (set->slots[i]) larger.slots[slot_of(&larger, set->slots[i] - 1)] = set->slots[i];
        larger.count = set->count;
        free(set->slots);
        *set = larger;
    }
    size_t slot = slot_of(set, key);
    if (set->slots[slot]) return 0;
    set->slots[slot] = key + 1;
    set->count++;
    return 1;
}

typedef struct {
    Key *keys;
    size_t count, room;
} Layer;

static int append(Layer *layer, Key key) {
    if (layer->count == layer->room) {
        size_t room = layer->room ? layer->room * 2 : 1024;
        Key *keys = realloc(layer->keys, room * sizeof(Key));
        if (!keys) return 0;
        layer->keys = keys;
        layer->room = room;
    }
    layer->keys[layer->count++] = key;
    return 1;
}

// The states of a part: the lowest bits of a key say of which group every block is, from the first
// place to the last, `width` bits each; the groups' patterns follow.
typedef struct {
    int places, groups, blocks, width;
    const Group *group;
} Part;

enum { NONE, MEETING, NO_MEMORY };

// States after every move of one whose distances to the other end are at most `left`, as far as
// they are new: added to a set and a layer; or, where `other` is given, whether one is in it.
static int expand(const Part *part, Key key, int end, int left, Set *seen, Layer *next,
                  const Set *other) {
    int places = part->places, width = part->width, last[MOST_PLACES + 1] = {0}, bound = 0;
    int composition[MOST_GROUPS], permutation[MOST_GROUPS], moves[MOST_GROUPS];
    for (int g = 0; g < part->groups; g++) {
        const Group *group = part->group + g;
        uint32_t pattern = (uint32_t)(key >> group->shift) & ((1u << group->bits) - 1);
        composition[g] = pattern / group->patterns->permutations;
        permutation[g] = pattern % group->patterns->permutations;
        bound += moves[g] = group->distances[end][pattern];
        const uint8_t *heights = group->patterns->heights + composition[g] * places;
        for (int place = 0; place < places; place++) last[place + 1] += heights[group->place[place]];
    }
    for (int place = 0; place < places; place++) last[place + 1] += last[place];
    uint64_t colours = (uint64_t)key & (((uint64_t)1 << part->blocks * width) - 1);
    for (int source = 0; source < places; source++) {
        if (last[source + 1] == last[source]) continue;
        int from = last[source + 1] - 1, g = colours >> from * width & ((1 << width) - 1);
        const Group *group = part->group + g;
        const Patterns *p = group->patterns;
        int most = left - (bound - moves[g]);
        for (int target = 0; target < places; target++) {
            if (target == source) continue;
            int way = (composition[g] * places + group->place[source]) * places
                      + group->place[target];
            uint32_t pattern = p->after[way] * (uint32_t)p->permutations
                               + p->turned[(size_t)p->turn[way] * p->permutations + permutation[g]];
            if (group->distances[end][pattern] > most) continue;
            // The blocks between slip by one.
            int to = target > source ? last[target + 1] - 1 : last[target + 1];
            int low = from < to ? from : to, length = from < to ? to - from : from - to;
            uint64_t between = ((uint64_t)1 << length * width) - 1;
            uint64_t slip = colours >> (low + (from < to)) * width & between;
            uint64_t all = ((uint64_t)1 << (length + 1) * width) - 1;
            uint64_t turned = (colours & ~(all << low * width))
                              | slip << (low + (from > to)) * width | (uint64_t)g << to * width;
            Key mask = ((Key)1 << group->bits) - 1;
            Key after = (key ^ colours) & ~(mask << group->shift);
            after |= (Key)pattern << group->shift | turned;
            if (other) {
                if (other->slots[slot_of(other, after)]) return MEETING;
            } else {
                int new = add(seen, after);
                if (new < 0 || (new && !append(next, after))) return NO_MEMORY;
            }
        }
    }
    return NONE;
}

// Moves that a part needs, from both ends as in patterns_both_ends.py: is there a plan of so many,
// of one more, …? Until it is found, or `enough` are proven, or `go_on`, which is told of every
// `chunk` expansions, says 0. Returns 0 where there was no memory.
int part_bound(const Part *part, uint64_t start_colours, uint64_t goal_colours, int enough,
               int chunk, int (*go_on)(int), int *proven) {
    Key ends[2] = {start_colours, goal_colours};
    Set seen[2] = {{0}};
    Layer last[2] = {{0}}, next = {0};
    int bound = 0, expanded = 0, memory = 1, answer = NONE;
    for (int g = 0; g < part->groups; g++) {
        const Group *group = part->group + g;
        ends[0] |= (Key)group->start << group->shift;
        ends[1] |= (Key)group->goal << group->shift;
        bound += group->distances[0][group->start];
    }
    for (int end = 0; end < 2; end++) memory &= set_up(&seen[end], 1 << 12);
    while (memory && ends[0] != ends[1] && bound < enough) {
        int depths[2] = {0, 0};
        for (int end = 0; end < 2; end++) {
            memset(seen[end].slots, 0, seen[end].room * sizeof(Key));
            seen[end].count = last[end].count = 0;
            memory &= add(&seen[end], ends[end]) > 0 && append(&last[end], ends[end]);
        }
        for (answer = NONE; memory && answer == NONE && depths[0] + depths[1] < bound;) {
            int end = last[0].count > last[1].count;
            const Set *other = depths[0] + depths[1] + 1 == bound ? &seen[!end] : NULL;
            if (!last[end].count) break;
            next.count = 0;
            for (size_t i = 0; answer == NONE && i < last[end].count; i++) {
                answer = expand(part, last[end].keys[i], end, bound - depths[end] - 1, &seen[end],
                                &next, other);
                if (++expanded % chunk == 0 && answer == NONE && !go_on(chunk)) goto done;
            }
            Layer used = last[end];
            last[end] = next;
            next = used;
            depths[end]++;
        }
        memory &= answer != NO_MEMORY;
        if (answer == MEETING) break;
        bound++;
    }
done:
    for (int end = 0; end < 2; end++) {
        free(seen[end].slots);
        free(last[end].keys);
    }
    free(next.keys);
    *proven = bound;
    return memory;
}
