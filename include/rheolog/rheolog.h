/*
 * rheolog: history-dependent non-Newtonian particle fluids, stepped in fixed steps, the same to the last bit on
 * any machine, recorded so that a run can be replayed, compared, resumed and taken apart.
 *
 *   rheo_scene scene;                              a built-in scene or your own: scene.h
 *   rheo_world_create(&def, &world, &error);       a world from a definition: world.h
 *   rheo_world_step(world, &error);                one fixed step
 *   rheo_recorder_open(...), rheo_verify(...);     recordings: record.h
 *   rheo_same("golden.rlog", ...);                 the same physics where bits differ? same.h
 *   rheo_player_find(player, "ball: y < 8", ...);  searching them: find.h
 *   rheo_player_why(player, 81, NULL, 17, "velocity", ...);  who changed a particle: why.h
 *   rheo_world_surface(...), rheo_world_export(...);   surfaces, files, pictures: view.h
 *   rheo_plot_write(&plot, "a.svg", ...);          plots of curves: plot.h
 *   rheo_history_weights(q, count, weights);       fractional derivatives on their own: history.h
 */
#ifndef RHEOLOG_RHEOLOG_H
#define RHEOLOG_RHEOLOG_H

#include "rheolog/base.h"
#include "rheolog/history.h"
#include "rheolog/world.h"
#include "rheolog/scene.h"
#include "rheolog/record.h"
#include "rheolog/find.h"
#include "rheolog/why.h"
#include "rheolog/same.h"
#include "rheolog/view.h"
#include "rheolog/plot.h"

#endif
