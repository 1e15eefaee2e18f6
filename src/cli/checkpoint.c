/* rheolog checkpoint: writes the exact state at a step of a recording to a file that runs can start from. */
#include "cli/cli.h"

static int write_checkpoint(const char *file, rheo_recording *recording, uint64_t step, const char *path, bool force)
{
    const rheo_recording_info info = rheo_recording_get_info(recording);
    rheo_error error = {""};
    rheo_world *world = NULL;
    cli_watch_signals();
    cli_watch_name(file);
    rheo_result result = rheo_recording_world(recording, step, NULL, &world, &error);
    if (result != RHEO_OK)
        return cli_file_error(file, result, &error);
    const uint64_t particles = rheo_world_particle_count(world);
    result = rheo_world_save(world, info.scene, path, force, &error);
    if (result == RHEO_OK)
        printf("%s: step %llu of %s, %u particle%s, hash %016llx\n", path, (unsigned long long)step,
               info.scene[0] ? info.scene : "a scene without a name", (unsigned)particles, cli_plural(particles),
               (unsigned long long)rheo_world_hash(world));
    rheo_world_destroy(world);
    return result == RHEO_OK ? CLI_DONE : cli_error(result, &error);
}

static int run(int argc, char **argv)
{
    const char *output = NULL;
    bool force = false;
    cli_number step = {false, 0};
    const cli_option options[] = {
        {"--step", NULL, "N", CLI_NUMBER, &step},
        {"--output", "-o", "C.rlog", CLI_TEXT, &output},
        {"--force", NULL, NULL, CLI_FLAG, &force},
        {0},
    };
    int status = cli_parse(&cli_checkpoint, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    if (argc != 1)
        return cli_usage(&cli_checkpoint, "needs one recording; got %d", argc);
    if (!step.given)
        return cli_usage(&cli_checkpoint, "needs --step N: which state to write");
    if (!output)
        return cli_usage(&cli_checkpoint, "needs -o C.rlog: the file to write");
    if ((status = cli_check_output(output, force ? RHEO_OUTPUT_REPLACE : RHEO_OUTPUT_NEW)) != CLI_DONE)
        return status;
    if (cli_same_file(argv[0], output))
        return cli_fail(CLI_BAD, "%s is read and cannot be written by -o too", argv[0]);
    rheo_recording *recording = NULL;
    if ((status = cli_open_recording(argv[0], &recording)) != CLI_DONE)
        return status;
    status = cli_check_step(argv[0], recording, "--step", step.value);
    if (status == CLI_DONE)
        status = write_checkpoint(argv[0], recording, step.value, output, force);
    rheo_recording_close(recording);
    return status;
}

static const char help[] = {
#include "cli/help/checkpoint.txt.inc"
    0};

const cli_command cli_checkpoint = {"checkpoint", help, run};
