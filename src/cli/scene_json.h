/* Scenes as JSON files. The program reads them, because the library does not depend on a JSON parser. */
#ifndef CLI_SCENE_JSON_H
#define CLI_SCENE_JSON_H

#include "cli/json_writer.h"
#include "rheolog/scene.h"

/* clang-format off */
/*
 * A scene file is one object. A missing key has its default value; {} is an empty scene.
 *
 *   "scene", "about"    name, and one line about the scene; the default name is that of the file
 *   "model"             "thickening" (default) or "melting". Defaults depend on the model. Keys of other models are
 *                       refused. "model" may be anywhere in the file
 *   "step", "gravity", "seed", "steps", "particles", "settle": {"time", ...}, "fluid": {"support", ...}, ...
 *                       parameters: "fluid": {"support": 4} is fluid.support. Vectors are [x, y, z]. Choices are
 *                       words in quotes. history.window is a number of steps, or a time such as "2.5 s"
 *   "fluid": {"shapes"} list of shapes such as {"sphere": {"centre": [0, 1, 0], "radius": 4}}. Particles are numbered
 *                       in this order. rheo_shape_at() lists the shapes and their members. The path of a mesh is
 *                       relative to the folder of the scene file
 *   "walls": {"planes"} list of {"point", "normal"}; the normal points to the fluid
 *   "walls": {"boxes"}  list of {"min", "max", "open": ["top", ...]}. A box consists of the planes bottom, top, left
 *                       (-x), right, back (-z) and front, except those in "open"
 *   "vibrators": {"positions"}  list of [x, z]
 *   "vibrators": {"grid"}       {"min": [x, z], "max": [x, z], "spacing"}. There is a vibrator in the middle of every
 *                               cell; x varies fastest
 */
/* clang-format on */

/* Largest scene file, bytes. */
#define CLI_MAX_SCENE_BYTES ((size_t)64 << 20)

/*
 * Reads a scene. `file_name` is used in messages ("file:line: ") and as the name of a scene that has none. Each shape
 * is checked; rheo_scene_check() must check the scene.
 */
rheo_result cli_scene_from_json(const char *text, size_t size, const char *file_name, rheo_scene *scene,
                                rheo_error *error);
/* Writes a scene as JSON that reads back to the same bits. Release the text with free(). NULL: no memory. */
char *cli_scene_to_json(const rheo_scene *scene);

/* Writes the value of a parameter. The value is a text from rheo_scene_get(). */
void cli_json_parameter(cli_json *json, const char *key, const rheo_parameter *parameter, const char *value);

#endif
