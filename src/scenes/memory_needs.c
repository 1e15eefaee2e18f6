/*
 * Estimates the memory that a scene needs, before anything is made. The fields of the state are counted, and what the
 * stages need is estimated by the model from the neighbours of a particle inside the fluid.
 */
#include "core/strict.h"
#include "scenes/making.h"
#include "world/emitters.h"

/* Flat fields are there twice: stages that fail are undone. */
static double flat_bytes(rheo__fields fields)
{
    double bytes = 0;
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++) {
        const rheo__field *field = &rheo__field_table[f];
        if ((fields >> f & 1) && field->storage == RHEO__FLAT && field->location == RHEO_LOCATION_PARTICLE)
            bytes += 2.0 * (double)rheo__element_size(field->element) * field->components;
    }
    return bytes;
}

/* Rows that a ring takes while it is filled: a long one grows, and is there twice while it does. */
static double ring_rows(double length, double filled)
{
    double rows = rheo__smaller(length, RHEO__RING_ROWS), most = rows;
    while (rows < rheo__smaller(filled, length)) {
        const double larger = rheo__smaller(2 * rows, length);
        most = rows + larger;
        rows = larger;
    }
    return most;
}

/* Rows of the history in this many steps. */
static double history_rows(const rheo_world_def *def, uint32_t features, uint64_t steps)
{
    const double all = (double)rheo__world_memory_rows(def, features), ring = rheo__world_ring_rows(def, features);
    return ring > 0 ? all - ring + ring_rows(ring, (double)steps) : all;
}

/* Neighbours of a particle with fluid all around it. */
static double neighbours_of(const rheo_world_def *def, double particles)
{
    const double ratio = rheo__def_support(def) / def->fluid.spacing;
    return rheo__smaller(4.0 / 3 * 3.14159265358979323846 * ratio * ratio * ratio, particles);
}

rheo_result rheo_scene_memory(const rheo_scene *scene, uint64_t steps, rheo_memory *memory, rheo_error *error)
{
    rheo_world_def def;
    rheo__filling filling = {0};
    *memory = (rheo_memory){0};
    RHEO__TRY(rheo__scene_check_parameters(scene, &def, error));
    const rheo_result result = rheo__filling_open(&filling, scene, error);
    if (result == RHEO_OK) {
        const rheo__model_type *type = rheo__model(def.model);
        const uint32_t features = rheo__world_features(&def);
        double of_particle = 0, of_neighbour = 0;
        def.fluid.spacing = filling.spacing;
        memory->emitted = steps ? (uint64_t)rheo__emitted_until(&def, (double)(steps - 1) * def.step)
                                : 0; /* as the last step begins */
        const double particles = (double)filling.count + (double)memory->emitted;
        if (type->working_memory)
            type->working_memory(&def, &of_particle, &of_neighbour);
        memory->particles = filling.count;
        memory->history = particles * 3 * (double)sizeof(rheo_real) * history_rows(&def, features, steps);
        memory->neighbours = particles * of_neighbour * neighbours_of(&def, particles);
        memory->all = memory->history + memory->neighbours +
                      particles * (of_particle + flat_bytes(rheo__world_fields(&def, features)));
    }
    rheo__filling_close(&filling);
    return result;
}
