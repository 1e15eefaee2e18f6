/* Shared by the files of `rheolog schema`: the keys of scene files that are no parameters and no shapes. */
#ifndef CLI_SCHEMA_H
#define CLI_SCHEMA_H

#include "rheolog/scene.h"

/* No number in a scene file is larger. */
#define CLI_UNBOUNDED 1e30

/* Meanings of keys, one line each. */
#define CLI_NAME_MEANING "name of the scene; by default that of the file"
#define CLI_ABOUT_MEANING "one line about the scene"
#define CLI_SHAPES_MEANING "shapes that are filled with particles; particles are numbered in their order"
#define CLI_MATERIALS_MEANING \
    "materials beside the main one, whose parameters are springs.* and history.*; shapes name theirs"
#define CLI_EMITTERS_MEANING "nozzles that add particles while the world runs"
#define CLI_OBSTACLES_MEANING "solids that stop the fluid, each at rest or with a given motion"
#define CLI_OBSTACLE_FILE_MEANING "\"bunny\", which is built in, or an .obj or .ply file with a closed mesh"
#define CLI_BALLS_MEANING "a further ball, up to `ball16`; its keys are those of `ball`"
#define CLI_MATERIAL_NAME_MEANING "a letter, then at most 14 letters, digits, - and _; not \"main\""

/* The sides of a box. */
enum { CLI_SIDES = 6 };
extern const char *const cli_sides[CLI_SIDES];

/* A key of an object. */
typedef struct cli_scene_key {
    const char *name;
    uint32_t numbers; /* 1, or the length of a list; 0: a list of sides of a box */
    const char *unit;
    bool required;
    double minimum; /* of each number */
    bool above_minimum;
    const char *meaning;
} cli_scene_key;

/* An object in a group, such as vibrators.grid, or the elements of a list, such as walls.planes. */
typedef struct cli_scene_object {
    const char *group, *name;
    uint32_t least, most; /* elements; most 0: no list, one object */
    const cli_scene_key *key;
    size_t key_count;  /* 0: each element is a list of two numbers */
    double bound;      /* of their absolute values */
    const char *parts; /* the two numbers with their units */
    const char *meaning;
} cli_scene_object;

/* Object by index; NULL past the last. */
const cli_scene_object *cli_scene_object_at(size_t index);

/* Prints the JSON schema of scene files (schema_json.c). */
void cli_schema_json(void);
/* Prints the table of a key in docs/scenes.md, all if NULL; whether there is one (schema_markdown.c). */
void cli_schema_markdown(const char *key);
bool cli_schema_has_table(const char *key);

#endif
