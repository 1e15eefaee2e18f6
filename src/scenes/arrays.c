/*
 * The arrays of a scene: shapes, walls, vibrators and the curve of the history. The room of an array that the scene owns
 * is at least its item count, rounded up to a power of two. So adding an item reallocates only at powers of two.
 */
#include "scenes/arrays.h"

#include <stdlib.h>
#include <string.h>

#include "core/error.h"
#include "thickening/weights.h"

/*
 * Makes room for one more item. If `array` is not `owned`, the array of the scene, its items are copied into a new
 * array of the scene. Returns the array of the scene; NULL: no memory.
 */
static void *room_for_one(const void *array, void *owned, uint32_t count, size_t size)
{
    size_t room = 1;
    if (array && array == owned && count & (count - 1))
        return owned;
    while (room <= count)
        room *= 2;
    void *larger = array == owned ? realloc(owned, room * size) : malloc(room * size);
    if (larger && array != owned) {
        memcpy(larger, array, count * size);
        free(owned);
    }
    return larger;
}

static rheo_result check_room(uint32_t count, uint32_t limit, const char *items, rheo_error *error)
{
    return count < limit ? RHEO_OK
                         : rheo__fail(error, RHEO_ERROR_ARGUMENT, "a scene has at most %u %s", limit, items);
}

rheo_result rheo_scene_add_fill(rheo_scene *scene, const rheo_fill *fill, rheo_error *error)
{
    RHEO__TRY(check_room(scene->fill_count, RHEO_MAX_FILLS, "shapes", error));
    rheo_fill *array = room_for_one(scene->fill, scene->owned.fill, scene->fill_count, sizeof *array);
    if (!array)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for another shape");
    scene->fill = scene->owned.fill = array;
    array[scene->fill_count++] = *fill;
    return RHEO_OK;
}

rheo_result rheo_scene_add_wall(rheo_scene *scene, const rheo_wall *wall, rheo_error *error)
{
    RHEO__TRY(check_room(scene->world.walls.count, RHEO_MAX_WALLS, "walls", error));
    rheo_wall *array =
        room_for_one(scene->world.walls.plane, scene->owned.plane, scene->world.walls.count, sizeof *array);
    if (!array)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for another wall");
    scene->world.walls.plane = scene->owned.plane = array;
    array[scene->world.walls.count++] = *wall;
    return RHEO_OK;
}

rheo_result rheo_scene_add_vibrator(rheo_scene *scene, double x, double z, rheo_error *error)
{
    const uint32_t count = scene->world.vibrators.count;
    RHEO__TRY(check_room(count, RHEO_MAX_VIBRATORS, "vibrators", error));
    double(*array)[2] = room_for_one(scene->world.vibrators.position, scene->owned.position, count, sizeof *array);
    if (!array)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for another vibrator");
    scene->owned.position = array;
    scene->world.vibrators.position = (const double(*)[2])array;
    array[count][0] = x;
    array[count][1] = z;
    scene->world.vibrators.count++;
    return RHEO_OK;
}

rheo_result rheo_scene_add_curve_point(rheo_scene *scene, double age, double weight, rheo_error *error)
{
    const uint32_t count = scene->world.history.curve_count;
    RHEO__TRY(check_room(count, RHEO_MAX_CURVE_POINTS, "points of history.curve", error));
    rheo_curve_point *array = room_for_one(scene->world.history.curve, scene->owned.curve, count, sizeof *array);
    if (!array)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for another point of history.curve");
    scene->world.history.curve = scene->owned.curve = array;
    array[count] = (rheo_curve_point){age, weight};
    RHEO__TRY(rheo__curve_check_point(array, count, error));
    scene->world.history.curve_count++;
    return RHEO_OK;
}

bool rheo__scene_reserve(rheo_scene *scene, uint32_t fills, uint32_t walls, uint32_t vibrators)
{
    scene->fill = scene->owned.fill = calloc(fills, sizeof *scene->owned.fill);
    scene->world.walls.plane = scene->owned.plane = calloc(walls, sizeof *scene->owned.plane);
    scene->owned.position = calloc(vibrators, sizeof *scene->owned.position);
    scene->world.vibrators.position = (const double(*)[2])scene->owned.position;
    return scene->owned.fill && scene->owned.plane && scene->owned.position;
}

void rheo_scene_release(rheo_scene *scene)
{
    if (scene->fill == scene->owned.fill) {
        scene->fill_count = 0;
        scene->fill = NULL;
    }
    if (scene->world.walls.plane == scene->owned.plane) {
        scene->world.walls.count = 0;
        scene->world.walls.plane = NULL;
    }
    if (scene->world.vibrators.position == (const double(*)[2])scene->owned.position) {
        scene->world.vibrators.count = 0;
        scene->world.vibrators.position = NULL;
    }
    if (scene->world.history.curve == scene->owned.curve) {
        scene->world.history.curve_count = 0;
        scene->world.history.curve = NULL;
    }
    free(scene->owned.curve);
    free(scene->owned.fill);
    free(scene->owned.plane);
    free(scene->owned.position);
    memset(&scene->owned, 0, sizeof scene->owned);
}
