/* Copies worlds at their start; see error_start.h. */
#include "cli/error_start.h"

#include <stdlib.h>
#include <string.h>

void cli_start_release(cli_start *s)
{
    free(s->position);
    free(s->velocity);
    free(s->density);
    free(s->temperature);
    free(s->material);
    free(s->ends);
    free(s->rest_length);
}

static bool has_field(const rheo_world *world, const char *name)
{
    rheo_field_info info;
    for (uint32_t f = 0; rheo_world_field(world, f, &info) == RHEO_OK; f++)
        if (strcmp(info.name, name) == 0)
            return true;
    return false;
}

rheo_result cli_start_springs(rheo_world_def *def, uint32_t **ends, rheo_real **rest_length, const rheo_world *world,
                              rheo_error *error)
{
    const size_t count = rheo_world_spring_count(world);
    rheo_spring *spring = malloc((count + 1) * sizeof *spring);
    *ends = malloc((2 * count + 1) * sizeof **ends);
    *rest_length = malloc((count + 1) * sizeof **rest_length);
    rheo_result result = RHEO_ERROR_MEMORY;
    if (spring && *ends && *rest_length)
        result = rheo_world_springs(world, spring, count);
    for (size_t k = 0; k < count && result == RHEO_OK; k++) {
        (*ends)[2 * k] = spring[k].a;
        (*ends)[2 * k + 1] = spring[k].b;
        (*rest_length)[k] = spring[k].rest_length;
    }
    free(spring);
    if (result != RHEO_OK)
        snprintf(error->message, sizeof error->message, "no memory for %zu springs", count);
    def->particles.spring_count = (uint32_t)count;
    def->particles.spring_ends = *ends;
    def->particles.spring_rest_length = *rest_length;
    return result;
}

rheo_result cli_start_copy(cli_start *s, const rheo_world *world, rheo_error *error)
{
    const size_t n = rheo_world_particle_count(world), bytes = 3 * n * sizeof *s->position;
    *s = (cli_start){.def = *rheo_world_definition(world)};
    rheo_particle_state *state = malloc(n * sizeof *state + 1);
    s->position = malloc(bytes + 1);
    s->velocity = malloc(bytes + 1);
    s->density = malloc(bytes + 1);
    s->temperature = malloc(bytes + 1);
    s->material = malloc(n * sizeof *s->material + 1);
    const bool enough = state && s->position && s->velocity && s->density && s->temperature && s->material;
    rheo_result result = enough ? rheo_world_particles(world, state, NULL) : RHEO_ERROR_MEMORY;
    if (result == RHEO_OK) {
        memcpy(s->position, rheo_world_positions(world), bytes);
        memcpy(s->velocity, rheo_world_velocities(world), bytes);
        for (size_t i = 0; i < n; i++) {
            s->density[i] = (rheo_real)state[i].density;
            s->temperature[i] = (rheo_real)state[i].temperature;
            s->material[i] = state[i].material;
        }
        const bool melting = s->def.model == RHEO_MODEL_MELTING;
        s->def.particles.count = (uint32_t)n;
        s->def.particles.position = s->position;
        s->def.particles.velocity = s->velocity;
        s->def.particles.density = melting ? s->density : NULL;
        s->def.particles.temperature = has_field(world, "temperature") ? s->temperature : NULL;
        s->def.particles.material = s->def.materials.count ? s->material : NULL;
        if (!melting)
            result = cli_start_springs(&s->def, &s->ends, &s->rest_length, world, error);
    } else {
        snprintf(error->message, sizeof error->message, "no memory for a copy of %zu particles", n);
    }
    free(state);
    return result;
}
