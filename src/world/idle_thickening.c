/* Warns of parameters of the thickening model that are set, but have no effect beside the others. */
#include <stdio.h>
#include <string.h>

#include "world/model_thickening.h"

static bool no_positions(const rheo_world_def *def)
{
    return def->scheme != RHEO_SCHEME_POSITIONS;
}

static bool no_solver(const rheo_world_def *def)
{
    return def->scheme != RHEO_SCHEME_SEQUENTIAL;
}

static bool no_ball(const rheo_world_def *def)
{
    return !(def->ball.radius > 0);
}

static bool stress_moves(const rheo_world_def *def)
{
    return def->plates.control == RHEO_PLATES_STRESS;
}

static bool velocity_moves(const rheo_world_def *def)
{
    return def->plates.control == RHEO_PLATES_VELOCITY;
}

/* Paths, or beginnings of paths, that have no effect if `idle`. */
static const struct {
    bool (*idle)(const rheo_world_def *def);
    const char *path, *why;
} ROWS[] = {
    {velocity_moves, "plates.stress", "plates.control is velocity; set it to stress"},
    {stress_moves, "plates.velocity", "plates.control is stress; set it to velocity"},
    {stress_moves, "plates.amplitude", "plates.control is stress; set it to velocity"},
    {stress_moves, "plates.frequency", "plates.control is stress; set it to velocity"},
    {no_positions, "positions.", "only scheme positions has it"},
    {no_ball, "ball.push", "there is no ball; set ball.radius"},
    {no_solver, "springs.solver", "only scheme sequential has it"},
};

void rheo__thickening_warn_of_idle(const rheo_world_def *def)
{
    const rheo_world_def usual = rheo_default_world_def();
    for (size_t i = 0; i < sizeof ROWS / sizeof *ROWS; i++) {
        if (!ROWS[i].idle(def))
            continue;
        const rheo_parameter *p;
        for (size_t k = 0; (p = rheo_parameter_at(k)) != NULL; k++) {
            char value[96], other[96], text[256];
            if (strncmp(p->path, ROWS[i].path, strlen(ROWS[i].path)) != 0 ||
                rheo_world_def_get(def, p->path, value, sizeof value) != RHEO_OK ||
                rheo_world_def_get(&usual, p->path, other, sizeof other) != RHEO_OK || strcmp(value, other) == 0)
                continue;
            snprintf(text, sizeof text, "%s is %.64s, without effect: %s", p->path, value, ROWS[i].why);
            def->log.message(text, def->log.user);
        }
    }
}
