/*
 * Reads the options of a command: `--name VALUE`, `--name=VALUE`, `-o VALUE` and `-oVALUE`. Options and operands can
 * be mixed; `--` ends the options.
 */
#include "cli/cli.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

bool cli_number_from(const char *text, uint64_t *value)
{
    if (!*text || strspn(text, "0123456789") != strlen(text))
        return false;
    errno = 0;
    const unsigned long long number = strtoull(text, NULL, 10);
    *value = number;
    return errno == 0;
}

/* Reads 512, 64K, 20M, 5G or 1T, or the same with KiB and so on: at least 1, in powers of 1024. */
static bool size_from(const char *text, uint64_t *bytes)
{
    static const char units[] = "KMGT";
    const size_t digits = strspn(text, "0123456789");
    char number[32];
    if (digits >= sizeof number)
        return false;
    snprintf(number, sizeof number, "%.*s", (int)digits, text);
    if (!cli_number_from(number, bytes) || *bytes == 0)
        return false;
    const char *unit = text[digits] ? strchr(units, text[digits]) : NULL;
    if (text[digits] && (!unit || (text[digits + 1] && strcmp(text + digits + 1, "iB") != 0)))
        return false;
    const unsigned shift = unit ? 10 * (unsigned)(unit - units + 1) : 0;
    if (*bytes > UINT64_MAX >> shift)
        return false;
    *bytes <<= shift;
    return true;
}

int cli_split_setting(const cli_command *command, const char *text, char *key, size_t size, const char **value)
{
    const char *equals = strchr(text, '=');
    if (!equals || equals == text || !equals[1])
        return cli_usage(command, "--set needs KEY=VALUE, e.g. fluid.support=4; got \"%s\"", text);
    static const char *const LISTS[] = {"fluid.shapes",   "walls.planes",  "walls.boxes", "vibrators.positions",
                                        "vibrators.grid", "history.curve", "obstacles"};
    for (size_t i = 0; i < sizeof LISTS / sizeof *LISTS; i++)
        if (strlen(LISTS[i]) == (size_t)(equals - text) && strncmp(text, LISTS[i], strlen(LISTS[i])) == 0)
            return cli_usage(command, "--set cannot change %s: only a scene file can, see `rheolog schema`",
                             LISTS[i]);
    snprintf(key, size, "%.*s", (int)(equals - text < 4096 ? equals - text : 4096), text);
    *value = equals + 1;
    return CLI_DONE;
}

/* The options of every command besides --help. */
static bool quiet;
static const cli_option COMMON[] = {{"--quiet", NULL, NULL, CLI_FLAG, &quiet}, {0}};

bool cli_quiet(void)
{
    return quiet;
}

const char *cli_did_you_mean(const char *word, const char *nearest, char text[CLI_SUGGESTION])
{
    text[0] = 0;
    if (rheo_is_near_word(word, nearest))
        snprintf(text, CLI_SUGGESTION, "; did you mean \"%s\"?", nearest);
    return text;
}

static const char *nearest_option(const cli_option *options, const char *name, const char *nearest)
{
    for (const cli_option *o = options; o->name; o++)
        nearest = rheo_nearest_word(name, (const char *const[]){nearest, o->name}, 2);
    return nearest;
}

static int unknown_option(const cli_command *command, const cli_option *options, const char *text)
{
    char name[64];
    snprintf(name, sizeof name, "%.*s", (int)strcspn(text, "="), text);
    if (strcmp(name, "--kernels") == 0)
        return cli_usage(command, "--kernels is now called --simd");
    const char *nearest = nearest_option(options, name, nearest_option(COMMON, name, "--help"));
    if (text[1] == '-' && rheo_is_near_word(name, nearest))
        return cli_usage(command, "unknown option %s; did you mean %s?", text, nearest);
    return cli_usage(command, "unknown option %s", text);
}

/* Finds the option at the start of `text`. *value is the text after "=" or after the letter; NULL: none. */
static const cli_option *find_option(const cli_option *options, const char *text, const char **value)
{
    *value = NULL;
    for (const cli_option *o = options; o->name; o++) {
        const size_t length = strlen(o->name);
        if (strncmp(text, o->name, length) == 0 && (text[length] == 0 || text[length] == '=')) {
            *value = text[length] ? text + length + 1 : NULL;
            return o;
        }
        if (o->letter && strncmp(text, o->letter, 2) == 0) {
            *value = text[2] ? text + 2 : NULL;
            return o;
        }
    }
    return NULL;
}

static int take(const cli_command *command, const cli_option *option, const char *value)
{
    switch (option->kind) {
    case CLI_FLAG:
        *(bool *)option->target = true;
        break;
    case CLI_TEXT:
        *(const char **)option->target = value;
        break;
    case CLI_OPTIONAL:
    case CLI_NUMBER: {
        cli_number *number = option->target;
        if (!cli_number_from(value, &number->value))
            return cli_usage(command, "%s needs a whole number, 0 or more; got \"%s\"", option->name, value);
        number->given = true;
        break;
    }
    case CLI_SIZE: {
        cli_number *bytes = option->target;
        if (!size_from(value, &bytes->value))
            return cli_usage(
                command,
                "%s needs a size such as 500M or 20G: a whole number of bytes, or of K, M, G or T (powers "
                "of 1024); got \"%s\"",
                option->name, value);
        bytes->given = true;
        break;
    }
    case CLI_LIST: {
        cli_list *list = option->target;
        if (list->count == CLI_MAX_LIST)
            return cli_usage(command, "%s is given more than %d times", option->name, CLI_MAX_LIST);
        list->item[list->count++] = value;
        break;
    }
    }
    return CLI_GO_ON;
}

int cli_parse(const cli_command *command, const cli_option *options, int *argc, char **argv)
{
    int operands = 0;
    bool ended = false;
    for (int i = 0; i < *argc; i++) {
        char *text = argv[i];
        if (ended || text[0] != '-' || text[1] == 0) {
            argv[operands++] = text;
            continue;
        }
        if (strcmp(text, "--") == 0) {
            ended = true;
            continue;
        }
        if (strcmp(text, "--help") == 0 || strcmp(text, "-h") == 0) {
            fputs(command->help, stdout);
            return CLI_DONE;
        }
        const char *value = NULL;
        const cli_option *option = find_option(options, text, &value);
        if (!option)
            option = find_option(COMMON, text, &value);
        if (!option)
            return unknown_option(command, options, text);
        if (option->kind == CLI_FLAG && value)
            return cli_usage(command, "%s takes no value; got \"%s\"", option->name, value);
        if (option->kind == CLI_OPTIONAL && !value) {
            uint64_t number;
            value = i + 1 < *argc && cli_number_from(argv[i + 1], &number) ? argv[++i] : "1";
        }
        if (option->kind != CLI_FLAG && !value) {
            if (i + 1 == *argc)
                return cli_usage(command, "%s needs a value: %s %s", text, text, option->argument);
            value = argv[++i];
        }
        const int status = take(command, option, value);
        if (status != CLI_GO_ON)
            return status;
    }
    *argc = operands;
    cli_watch();
    return CLI_GO_ON;
}
