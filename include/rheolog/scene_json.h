/*
 * Scenes as JSON files, as the program reads and writes them. These functions are in a library of their own,
 * librheolog-scene-json (pkg-config rheolog-scene-json), because they need jansson.
 */
#ifndef RHEOLOG_SCENE_JSON_H
#define RHEOLOG_SCENE_JSON_H

#include "rheolog/scene.h"

#ifdef __cplusplus
extern "C" {
#endif

/* clang-format off */
/**
 * @page scene_files The form of scene files
 *
 * A scene file is one object. A missing key has its default value; {} is an empty scene. In every object, "$schema" and
 * "comment" may have any value and are ignored.
 *
 *     "scene", "about"    name, and one line about the scene; the default name is that of the file
 *     "model"             "thickening" (default) or "melting". Defaults depend on the model. Keys of other models are
 *                         refused. "model" may be anywhere in the file
 *     "step", "gravity", "seed", "steps", "particles", "settle": {"time", ...}, "fluid": {"support", ...}, ...
 *                         parameters: "fluid": {"support": 4} is fluid.support. Vectors are [x, y, z]. Choices are
 *                         words in quotes. history.window and history.lag are steps, or times such as "2.5 s"
 *     "fluid": {"shapes"} list of shapes such as {"sphere": {"centre": [0, 1, 0], "radius": 4}}. Particles are numbered
 *                         in this order. rheo_shape_at() lists the shapes and their members. The path of a mesh is
 *                         relative to the folder of the scene file
 *     "materials"         list of {"name", "springs": {"stiffness", "plasticity", "yield_ratio"},
 *                         "history": {"stiffness", "onset"}}, of which only the name is required. "material" of a shape
 *                         is such a name
 *     "walls": {"planes"} list of {"point", "normal"}; the normal points to the fluid
 *     "walls": {"boxes"}  list of {"min", "max", "open": ["top", ...]}. A box consists of the planes bottom, top, left
 *                         (-x), right, back (-z) and front, except those in "open"
 *     "obstacles"         list of obstacles such as {"box": {"position": [0, 3, 0], "size": [8, 2, 1], "spin": [0, 2, 0]}};
 *                         the shapes are sphere, box, cylinder and mesh, and the keys the parameters that a shape has
 *                         (rheo_obstacle_parameter_at()). A mesh has a "file" too, whose path is as that of a shape
 *     "vibrators": {"positions"}  list of [x, z]
 *     "history": {"curve"}        list of [age, weight], ages ascending
 *     "vibrators": {"grid"}       {"min": [x, z], "max": [x, z], "spacing"}. There is a vibrator in the middle of every
 *                                 cell; x varies fastest
 */
/* clang-format on */

/** Largest scene file. Unit: bytes. */
#define RHEO_MAX_SCENE_BYTES ((size_t)64 << 20)

/**
 * Reads a scene file. The scene is to be released (rheo_scene_release()); an error leaves it as it was. Each shape is
 * checked here, and the whole by rheo_scene_check() or rheo_scene_create_world(). RHEO_ERROR_FILE: the file cannot be
 * read. RHEO_ERROR_ARGUMENT: it is no scene; the message begins with "file:line: ". RHEO_ERROR_MEMORY.
 */
RHEO_API rheo_result rheo_scene_read_json(const char *path, rheo_scene *scene, rheo_error *error);
/**
 * Reads a scene from the text of a file. `file_name` stands in messages, names a scene that has no name, and its
 * folder is that of the meshes. It need not exist. Errors as in rheo_scene_read_json().
 */
RHEO_API rheo_result rheo_scene_from_json(const char *text, size_t size, const char *file_name, rheo_scene *scene,
                                          rheo_error *error);

/**
 * Writes a scene file that reads back to the same bits. It is written beside `path` and then renamed; a symbolic link
 * stays, and the file that it leads to is replaced. The path of a
 * mesh is written as it counts from the folder of the file, or whole if the mesh is in another folder. RHEO_ERROR_FILE:
 * it cannot be written. RHEO_ERROR_ARGUMENT: the file exists and `force` is false, or the whole path of a mesh is too
 * long for a scene. RHEO_ERROR_MEMORY.
 */
RHEO_API rheo_result rheo_scene_write_json(const rheo_scene *scene, const char *path, bool force, rheo_error *error);
/** Writes a scene as text, with the paths of meshes as they are, to be released with free(). NULL: no memory. */
RHEO_API char *rheo_scene_to_json(const rheo_scene *scene);

#ifdef __cplusplus
}
#endif
#endif
