/* `rheolog --version`: the version and the build, as text or, for reports of faults and scripts, as JSON. */
#include <string.h>
#include <zlib.h>

#include "cli/build_flags.h"
#include "cli/cli.h"

static void print_json(void)
{
    static const char *const FLAGS[] = {CLI_FLAGS};
    rheo__json json = {.file = stdout};
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "version", rheo_version());
    rheo__json_text(&json, "build", rheo_build());
    rheo__json_text(&json, "compiler", cli_compiler());
    rheo__json_begin_list(&json, "flags");
    for (size_t i = 0; i < sizeof FLAGS / sizeof *FLAGS; i++)
        rheo__json_text(&json, NULL, FLAGS[i]);
    rheo__json_end_list(&json);
    rheo__json_text(&json, "real", cli_real());
    rheo__json_text(&json, "machine", strrchr(rheo_build(), ',') + 2);
    rheo__json_begin_list(&json, "simd");
    for (uint32_t i = 0; rheo_simd_available(i); i++)
        rheo__json_text(&json, NULL, rheo_simd_available(i));
    rheo__json_end_list(&json);
    rheo__json_text(&json, "simd_in_use", rheo_simd());
    rheo__json_text(&json, "zlib", zlibVersion());
    rheo__json_text(&json, "jansson", CLI_JANSSON);
    rheo__json_text(&json, "libpng", CLI_LIBPNG);
    rheo__json_text(&json, "libedit", CLI_LIBEDIT);
    rheo__json_end_object(&json);
}

static void print_text(void)
{
    printf("rheolog %s\n%s\nsimd:", rheo_version(), rheo_build());
    for (uint32_t i = 0; rheo_simd_available(i); i++)
        printf(" %s", rheo_simd_available(i));
    printf(" (in use: %s)\n", rheo_simd());
}

int cli_version(int argc, char **argv)
{
    const bool asks_json = argc > 0 && strcmp(argv[0], "--json") == 0;
    if (argc > 1 || (argc == 1 && !asks_json))
        return cli_fail(CLI_BAD, "--version takes no argument but --json; got \"%s\"", argv[asks_json]);
    if (asks_json)
        print_json();
    else
        print_text();
    return CLI_DONE;
}
