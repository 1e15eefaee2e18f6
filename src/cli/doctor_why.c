/* The chain of causes that ends a diagnosis: what `rheolog why --depth 6` finds for the particle that the diagnosis names. */
#include "cli/doctor_why.h"

#include <string.h>

#include "cli/shell.h"

/* Steps from the keyframe times particles: some seconds. More is left to `rheolog why`. */
static const uint64_t MOST_PARTICLE_STEPS = 10000000;

/* The field of the failure, if stages keep accounts of it. */
static const char *failed_field(const rheo_failure *failure)
{
    static const char *const fields[] = {"velocity", "density", "temperature", "derivative"};
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++)
        if (failure->reason == RHEO_FAILURE_NOT_FINITE && strcmp(failure->field, fields[i]) == 0)
            return fields[i];
    return "position";
}

void cli_doctor_chain_begin(const rheo_recording *recording, const rheo_diagnosis *d, cli_doctor_chain *c)
{
    const rheo_finding *cause = &d->cause;
    *c = (cli_doctor_chain){.known = false};
    if (d->healthy || (cause->id < 0 && !(d->failed && d->failure.location == RHEO_LOCATION_PARTICLE)))
        return;
    c->step = cause->id < 0 ? d->failure.step : cause->seen[0] ? cause->seen_step : cause->step;
    c->id = cause->id < 0 ? d->failure.id : (uint64_t)cause->id;
    c->field =
        d->failed && c->step == d->failure.step && c->id == d->failure.id ? failed_field(&d->failure) : "position";
    c->known = c->step > d->first_step && c->step <= d->last_step + d->failed &&
               c->id < rheo_recording_get_info(recording).particles;
}

static bool receive(void *data, const rheo_link *link)
{
    cli_doctor_chain *c = data;
    if (c->count < CLI_DOCTOR_DEPTH)
        c->link[c->count++] = *link;
    return !cli_interrupted();
}

void cli_doctor_chain_follow(rheo_recording *recording, cli_doctor_chain *c)
{
    const rheo_recording_info info = rheo_recording_get_info(recording);
    const uint64_t steps = c->step - info.first_step;
    const uint64_t distance = info.keyframe_spacing ? steps % info.keyframe_spacing + 1 : steps;
    rheo_player *player = NULL;
    rheo_error error;
    if (!c->known || distance > MOST_PARTICLE_STEPS / (info.particles + 1))
        return;
    if (rheo_player_open(recording, NULL, &player, &error) == RHEO_OK)
        c->told = rheo_player_why_chain(player, c->step, NULL, c->id, c->field, CLI_DOCTOR_DEPTH, receive, c,
                                        &c->chain, &error) == RHEO_OK &&
                  c->count > 0;
    rheo_player_close(player);
    cli_watch_end();
}

void cli_doctor_chain_text(const char *file, const cli_doctor_chain *c)
{
    char text[CLI_WHY_TEXT];
    if (!c->known)
        return;
    cli_print_command("  rheolog why", file);
    printf(" --step %llu --particle %llu", (unsigned long long)c->step, (unsigned long long)c->id);
    if (strcmp(c->field, "position") != 0)
        printf(" --field %s", c->field);
    printf(" --depth %d\n", CLI_DOCTOR_DEPTH);
    if (!c->told)
        return;
    puts("causes, each from the largest contribution to the one before:");
    for (uint32_t i = 0; i < c->count; i++)
        cli_print(stdout, 4, "  %s\n", cli_why_link_text(&c->link[i], text));
    cli_why_print_end(&c->chain);
}

void cli_doctor_chain_json(rheo__json *json, const cli_doctor_chain *c)
{
    if (c->told) {
        rheo__json_begin_list(json, "chain");
        for (uint32_t i = 0; i < c->count; i++)
            cli_why_link_json(json, &c->link[i]);
        rheo__json_end_list(json);
    } else {
        rheo__json_null(json, "chain");
    }
    rheo__json_text(json, "chain_end", c->told ? cli_why_end_name(c->chain.end) : NULL);
    rheo__json_text(json, "chain_why", c->told ? c->chain.why : NULL);
}
