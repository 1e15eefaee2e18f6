/* rheolog schema: prints the JSON schema of scene files, or the tables of docs/scenes.md. */
#include "cli/schema.h"

#include "cli/cli.h"

static int run(int argc, char **argv)
{
    bool markdown = false;
    const cli_option options[] = {
        {"--markdown", NULL, NULL, CLI_FLAG, &markdown},
        {0},
    };
    const int status = cli_parse(&cli_schema, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    if (argc > 0 && !markdown)
        return cli_usage(&cli_schema, "takes no operand without --markdown; got \"%s\"", argv[0]);
    for (int i = 0; i < argc; i++)
        if (!cli_schema_has_table(argv[i]))
            return cli_usage(&cli_schema, "there is no table of \"%s\"", argv[i]);
    if (!markdown)
        cli_schema_json();
    else if (argc == 0)
        cli_schema_markdown(NULL);
    for (int i = 0; i < argc; i++)
        cli_schema_markdown(argv[i]);
    return CLI_DONE;
}

static const char help[] = {
#include "cli/help/schema.txt.inc"
    0};

const cli_command cli_schema = {"schema", help, run};
