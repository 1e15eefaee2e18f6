/* The keys of scene files that are no parameters and no shapes: the schema and docs/scenes.md are made of them. */
#include "cli/schema.h"

const char *const cli_sides[CLI_SIDES] = {"bottom", "top", "left", "right", "back", "front"};

#define ANY .minimum = -CLI_UNBOUNDED

static const cli_scene_key plane[] = {
    {"point", 3, "L", true, ANY, .meaning = "a point of the plane"},
    {"normal", 3, "1", true, ANY, .meaning = "points to the side of the fluid; any length but 0"},
};
static const cli_scene_key box[] = {
    {"min", 3, "L", true, ANY, .meaning = "lowest corner"},
    {"max", 3, "L", true, ANY, .meaning = "highest corner"},
    {"open", 0, "", false, ANY, .meaning = "sides without a wall; by default none"},
};
static const cli_scene_key grid[] = {
    {"min", 2, "L", true, ANY, .meaning = "lowest x and z"},
    {"max", 2, "L", true, ANY, .meaning = "highest x and z"},
    {"spacing", 1, "L", true, .above_minimum = true,
     .meaning = "distance of vibrators; the first is half of it inside"},
};

#define KEYS(keys) .key = keys, .key_count = sizeof(keys) / sizeof *(keys)
#define LIST_OF(most_) .most = most_

static const cli_scene_object objects[] = {
    {"walls", "planes", LIST_OF(RHEO_MAX_WALLS), KEYS(plane), .meaning = "walls, each an infinite plane"},
    {"walls", "boxes", LIST_OF(RHEO_MAX_WALLS), KEYS(box),
     .meaning = "boxes that the fluid is inside of: one wall for each side that is not open"},
    {"vibrators", "positions", LIST_OF(RHEO_MAX_VIBRATORS), .bound = CLI_UNBOUNDED, .parts = "[x, z], L",
     .meaning = "places of vibrators"},
    {"vibrators", "grid", KEYS(grid), .meaning = "vibrators on a grid"},
    {"history", "curve", .least = 2, LIST_OF(RHEO_MAX_CURVE_POINTS), .bound = 1e12, .parts = "[age, weight], T and 1",
     .meaning = "weights of past velocities by their age, in place of order, window and weights; ages ascend"},
};

const cli_scene_object *cli_scene_object_at(size_t index)
{
    return index < sizeof objects / sizeof *objects ? &objects[index] : NULL;
}
