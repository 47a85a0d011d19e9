/* SPDX-License-Identifier: Apache-2.0
 *
 * What light.py says of each name in each shade and light; to the last bit what its numpy does.
 */
#include <stddef.h>

static float smaller(float one, float other) { return one < other ? one : other; }

/* Squared distances of a block from all names, with what is mirrored as costs least; see
 * `_put_diffuse`.
 *
 * product, squares: (lights, sheens, shades, names); length: (lights); sheen_cost: (sheens);
 * diffuse: (shades, lights, blocks, names), of which that of one block is written. */
void put_diffuse(int lights, int sheens, int shades, int blocks, int names, int block,
                 const float *product, const float *squares, const float *length,
                 const float *sheen_cost, float *diffuse) {
    const size_t plain = (size_t)shades * names;
    for (int light = 0; light < lights; ++light)
        for (int shade = 0; shade < shades; ++shade) {
            float *least = diffuse + (((size_t)shade * lights + light) * blocks + block) * names;
            for (int sheen = 0; sheen < sheens; ++sheen) {
                const size_t at = ((size_t)light * sheens + sheen) * plain + (size_t)shade * names;
                for (int name = 0; name < names; ++name) {
                    float cost = product[at + name] + squares[at + name];
                    cost += length[light];
                    cost = (cost > 0.0f ? cost : 0.0f) + sheen_cost[sheen];
                    least[name] = sheen ? smaller(cost, least[name]) : cost;
                }
            }
        }
}

/* Costs by the shade of the scene; see `_of_scene`.
 *
 * count: of lights, blocks and names together; diffuse, costs: (shades, count); metal: (count);
 * apart: of a shade that is 0 to `reach` steps away. */
void of_scene(int shades, int count, int reach, const float *diffuse, const float *metal,
              const float *apart, float *costs) {
    for (int scene = 0; scene < shades; ++scene) {
        float *cost = costs + (size_t)scene * count;
        for (int n = 0; n < count; ++n) cost[n] = metal[n];
        for (int own = scene - reach; own <= scene + reach; ++own) {
            if (own < 0 || own >= shades) continue;
            const float more = apart[own < scene ? scene - own : own - scene];
            const float *mine = diffuse + (size_t)own * count;
            for (int n = 0; n < count; ++n) cost[n] = smaller(cost[n], mine[n] + more);
        }
    }
}
