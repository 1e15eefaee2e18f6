/*
 * Size of the states that `run --full` stores, compared with raw values and with zlib -9.
 *
 *   bench/full F.rlog [EVERY]      F.rlog: recorded with --full; EVERY: use every EVERY-th step only (default 10)
 *
 * Prints CSV: step, particles, bytes per particle for positions, velocities and springs (raw, zlib -9, recorded), and
 * the means at the end. The recording also contains bodies, vibrators and the hashes of the step.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "rheolog/rheolog.h"

static _Noreturn void give_up(const char *message)
{
    fprintf(stderr, "full: %s\n", message);
    exit(1);
}

/* Copies the values of the fields that every state has, field by field. */
static unsigned char *values_of(const rheo_world *world, size_t *size)
{
    static const char *const names[] = {"position", "velocity", "spring_ends", "spring_rest_length"};
    unsigned char *bytes = NULL;
    *size = 0;
    rheo_field_info info;
    for (uint32_t f = 0; rheo_world_field(world, f, &info) == RHEO_OK; f++)
        for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
            if (strcmp(info.name, names[n]) != 0)
                continue;
            unsigned char *more = realloc(bytes, *size + info.bytes + 1);
            if (!more || rheo_world_field_read(world, f, more + *size, info.bytes) != RHEO_OK)
                give_up("no memory");
            bytes = more;
            *size += info.bytes;
        }
    return bytes;
}

static size_t zlib_size(const unsigned char *bytes, size_t size)
{
    uLongf room = compressBound((uLong)size);
    unsigned char *to = malloc(room);
    if (!to || compress2(to, &room, bytes, (uLong)size, 9) != Z_OK)
        give_up("no memory");
    free(to);
    return room;
}

int main(int argc, char **argv)
{
    rheo_recording *recording;
    rheo_player *player;
    rheo_error error = {""};
    const unsigned long every = argc > 2 ? strtoul(argv[2], NULL, 10) : 10;
    if (argc < 2 || every == 0)
        give_up("usage: full F.rlog [EVERY]");
    if (rheo_recording_open(argv[1], &recording, &error) != RHEO_OK ||
        rheo_player_open(recording, NULL, &player, &error) != RHEO_OK)
        give_up(error.message);
    const rheo_recording_info info = rheo_recording_get_info(recording);
    if (!info.full || info.last_step == info.first_step)
        give_up("the recording has no states of steps; record with --full");
    puts("step,particles,raw,zlib9,recorded");
    double raw_sum = 0, zlib_sum = 0, recorded = 0, steps = 0;
    for (uint64_t step = info.first_step + every; step <= info.last_step; step += every) {
        if (rheo_player_seek(player, step, &error) != RHEO_OK)
            give_up(error.message);
        const rheo_world *world = rheo_player_world(player);
        size_t size;
        unsigned char *bytes = values_of(world, &size);
        const double particles = rheo_world_particle_count(world);
        const double raw = (double)size / particles, packed = (double)zlib_size(bytes, size) / particles;
        recorded = (double)info.step_bytes / (double)(info.last_step - info.first_step) / particles;
        printf("%llu,%.0f,%.2f,%.2f,%.2f\n", (unsigned long long)step, particles, raw, packed, recorded);
        raw_sum += raw;
        zlib_sum += packed;
        steps++;
        free(bytes);
    }
    printf("mean,,%.2f,%.2f,%.2f\n", raw_sum / steps, zlib_sum / steps, recorded);
    fprintf(stderr, "raw/recorded %.2f, zlib9/recorded %.2f\n", raw_sum / steps / recorded,
            zlib_sum / steps / recorded);
    rheo_player_close(player);
    rheo_recording_close(recording);
    return 0;
}
