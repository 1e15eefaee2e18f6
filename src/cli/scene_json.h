/*
 * Scenes read from and written as JSON. Part of the program, not of the library, which does without a JSON parser.
 */
#ifndef CLI_SCENE_JSON_H
#define CLI_SCENE_JSON_H

#include "cli/json_writer.h"
#include "rheolog/scene.h"

/* clang-format off */
/*
 * ---- JSON ----
 *
 * A scene file is one object. Every key may be left out and has its default then; {} is an empty scene.
 *
 *   "scene", "about"      its name and one line about it; a scene without a name is called after its file
 *   "model"               "thickening" (the default) or "melting", wherever in the file it stands: the defaults are the
 *                         model's, and what the other model alone has is refused
 *   "step", "gravity", "seed", "steps", "particles", "settle": {"time", ...}, "fluid": {"support", ...}, ...
 *                         the parameters: "fluid": {"support": 4} is fluid.support. Vectors are [x, y, z], choices are
 *                         words in quotes, history.window is a number of steps or a time as "2.5 s"
 *   "fluid": {"shapes"}   a list of shapes; particles are numbered in its order:
 *                           {"block": {"min", "max"}}
 *                           {"sphere": {"centre", "radius"}}
 *                           {"mesh": {"file", "height", "position"}}: "bunny", which is built in, or the path of an
 *                             .obj or .ply file, a relative one from the folder of the scene file; made so high if
 *                             that is not 0; position is the middle of the underside of what bounds it
 *                           {"letters": {"text", "height", "depth", "position"}}: block letters along x, deep along z
 *                         and in each of them "velocity", "jitter", and of the model melting "temperature" (a number,
 *                         or [lowest particle, highest particle]) and "hydrostatic" (true; false: at rest density)
 *   "walls": {"planes"}   a list of {"point", "normal"}; the fluid is where the normal points to
 *   "walls": {"boxes"}    a list of {"min", "max", "open": ["top", ...]}: containers, made of the planes bottom, top,
 *                         left (-x), right, back (-z), front but those that are open
 *   "vibrators": {"positions"}  a list of [x, z]
 *   "vibrators": {"grid"}   {"min": [x, z], "max": [x, z], "spacing"}: a vibrator in the middle of every cell, x first
 */
/* clang-format on */

/* Largest scene file that the program reads, bytes. */
#define CLI_MAX_SCENE_BYTES ((size_t)64 << 20)

/* `file_name` stands in front of messages, as `file:line: `, and names a scene that has no name of its own.
 */
rheo_result cli_scene_from_json(const char *text, size_t size, const char *file_name, rheo_scene *scene,
                                rheo_error *error);
/* The scene as JSON, from malloc, which reads back to the same bits; NULL if there is no memory. */
char *cli_scene_to_json(const rheo_scene *scene);

/* The value of a parameter, given as rheo_scene_get() writes it. */
void cli_json_parameter(cli_json *json, const char *key, const rheo_parameter *parameter, const char *value);

#endif
