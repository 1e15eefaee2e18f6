/* The code that the examples of golden tests guard (my_scene.h). */
#include "my_scene.h"

/* The tests of the examples build them once more with another speed, which must be noticed. */
#ifndef MY_SCENE_SPEED
#define MY_SCENE_SPEED -10
#endif

enum { WIDTH = 10, HEIGHT = 5, COUNT = WIDTH * HEIGHT * WIDTH };

rheo_result my_scene_create(rheo_world **world, rheo_error *error)
{
    static const rheo_wall floor = {.point = {0, 0, 0}, .normal = {0, 1, 0}};
    static rheo_real position[COUNT][3];
    rheo_world_def def = rheo_default_world_def();
    const double spacing = def.fluid.spacing;
    for (int i = 0; i < COUNT; i++) {
        position[i][0] = (rheo_real)(spacing * (i % WIDTH));
        position[i][1] = (rheo_real)(spacing * (.5 + i / (WIDTH * WIDTH)));
        position[i][2] = (rheo_real)(spacing * (i / WIDTH % WIDTH));
    }
    def.particles.count = COUNT;
    def.particles.position = position[0];
    def.walls.count = 1;
    def.walls.plane = &floor;
    def.ball.radius = 3;
    def.ball.position[0] = def.ball.position[2] = .5 * spacing * (WIDTH - 1);
    def.ball.position[1] = spacing * HEIGHT + 4;
    def.ball.velocity[1] = MY_SCENE_SPEED;
    return rheo_world_create(&def, world, error);
}

rheo_result my_scene_act(rheo_world *world, rheo_error *error)
{
    const double kick[3] = {200, 0, 0};
    if (rheo_world_step_count(world) == 20)
        return rheo_world_push_body(world, 0, kick, NULL, error);
    if (rheo_world_step_count(world) == 40)
        return rheo_world_set(world, "gravity", "[3, -9, 0]", error);
    return RHEO_OK;
}
