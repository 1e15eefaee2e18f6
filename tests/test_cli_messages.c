/* What the program says: advice that works when it is followed, the same words everywhere, and how it ends on Ctrl-C. */
#define _XOPEN_SOURCE 700
#include "cli_support.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* Runs the command that stands in the output on its own line after `before`. */
static int run_suggested(const char *before, const char *with)
{
    char line[512];
    const char *at = strstr(out, before);
    if (!at || !(at = strstr(at, "\n    rheolog ")))
        fail_msg("no command after \"%s\" in:\n%s", before, out);
    at += strlen("\n    rheolog ");
    snprintf(line, sizeof line, "%.*s", (int)strcspn(at, "\n"), at);
    assert_in(with, line);
    return run("%s", line);
}

static void assert_not_in(const char *part, const char *text)
{
    if (strstr(text, part))
        fail_msg("\"%s\" is in:\n%s", part, text);
}

/* ---- Advice ---- */

static void the_command_that_diff_suggests_works(void **state)
{
    (void)state;
    record("a.rlog");
    falsify_step("a.rlog", "forged.rlog", 5);
    /* One of the two is not reproduced: the other one is shown. */
    assert_code(1, run("diff a.rlog forged.rlog"));
    assert_code(0, run_suggested("next:", "inspect a.rlog --step 5 --stage"));
    assert_code(1, run("diff forged.rlog a.rlog"));
    assert_code(0, run_suggested("next:", "inspect a.rlog --step 5 --stage"));
    /* Neither is, but both are up to there. */
    falsify_step_by("a.rlog", "other.rlog", 5, 2);
    assert_code(1, run("diff forged.rlog other.rlog"));
    assert_code(0, run_suggested("next:", "inspect forged.rlog --step 4"));
    /* Nor up to there. */
    falsify_step("a.rlog", "early.rlog", 2);
    falsify_step("early.rlog", "both.rlog", 5);
    assert_code(1, run("diff early.rlog both.rlog"));
    assert_in("differs at step 5", out);
    assert_code(0, run_suggested("next:", "info early.rlog both.rlog"));
}

static void suggested_commands_quote_file_names(void **state)
{
    (void)state;
    static const char name[] = "a b$(c).rlog";
    record("a.rlog");
    falsify_step("a.rlog", name, 5);
    assert_code(1, run("verify '%s'", name));
    assert_code(0, run_suggested("next:", "inspect 'a b$(c).rlog' --step 4"));
    assert_code(1, run("diff '%s' a.rlog", name));
    assert_code(0, run_suggested("next:", "inspect a.rlog --step 5"));
    falsify_step_by("a.rlog", "other.rlog", 5, 2);
    assert_code(1, run("diff '%s' other.rlog", name));
    assert_code(0, run_suggested("next:", "inspect 'a b$(c).rlog' --step 4"));
    run("run %s --steps 60 --set scheme=sequential --set fluid.stiffness=900 -o '%s' --force --quiet", scene, name);
    assert_code(1, run("doctor '%s'", name));
    assert_in("\n  rheolog inspect 'a b$(c).rlog' --step ", out);
    assert_in("\n  rheolog checkpoint 'a b$(c).rlog' --step ", out);
    run("run %s --steps 60 --set scheme=sequential --set fluid.stiffness=900 -o '%s' --force --quiet", scene, name);
    assert_in(": `rheolog doctor 'a b$(c).rlog'`", err);
    assert_code(2, run("run '%s'", name));
    assert_in("`rheolog run --from 'a b$(c).rlog'`", err);
    remove(name);
    /* A name that begins like an option. */
    falsify_step("a.rlog", "-x.rlog", 5);
    assert_code(1, run("verify ./-x.rlog"));
    assert_code(0, run_suggested("next:", "inspect ./-x.rlog --step 4"));
    assert_code(1, run("verify -- -x.rlog"));
    assert_code(0, run_suggested("next:", "inspect ./-x.rlog --step 4"));
    remove("-x.rlog");
}

static void the_commands_that_verify_suggests_work(void **state)
{
    (void)state;
    record("a.rlog");
    falsify_step("a.rlog", "forged.rlog", 5);
    assert_code(1, run("verify forged.rlog"));
    assert_code(0, run_suggested("next:", "inspect forged.rlog --step 4"));
    remove("new.rlog");
    assert_code(1, run("verify forged.rlog"));
    assert_code(1, run_suggested("if the change is meant", "rerecord forged.rlog -o new.rlog")); /* NEW differs */
    assert_code(0, run("verify new.rlog"));
    assert_code(1, run("verify forged.rlog"));
    assert_in("\n    rheolog bless forged.rlog new.rlog --because \"...\"\n", out);
    remove("new.rlog");
}

static void a_truncated_run_is_said_to_go_on(void **state)
{
    (void)state;
    static const char says[] = "the command that made it, with --continue, goes on from there";
    record("a.rlog");
    size_t size;
    const char *bytes = read_bytes("a.rlog", &size);
    write_file("torn.rlog", bytes, size - 5);
    assert_code(2, run("verify torn.rlog"));
    assert_in(says, out);
    assert_code(2, run("verify torn.rlog --json"));
    assert_in(says, out);
    assert_code(0, run("info torn.rlog"));
    assert_in(says, out);
    assert_code(0, run("log torn.rlog"));
    assert_in(says, out);
    run("doctor torn.rlog");
    assert_in(says, err);
    /* It does. */
    assert_code(0, run("run %s --steps 8 -o torn.rlog --continue --quiet", scene));
    assert_files_same("a.rlog", "torn.rlog");
    /* A checkpoint has no such command, and a golden recording is not to be continued. */
    assert_code(0, run("checkpoint a.rlog --step 4 -o torn.rlog --force"));
    bytes = read_bytes("torn.rlog", &size);
    write_file("torn.rlog", bytes, size - 5);
    assert_code(2, run("verify torn.rlog"));
    assert_not_in(says, out);
    remove("golden.rlog");
    assert_code(0, run("bless golden.rlog a.rlog --because \"a test\""));
    bytes = read_bytes("golden.rlog", &size);
    write_file("golden.rlog", bytes, size - 5);
    assert_code(2, run("verify golden.rlog"));
    assert_not_in(says, out);
    remove("golden.rlog");
}

static void a_pointer_of_git_lfs_is_only_to_be_fetched(void **state)
{
    (void)state;
    static const char pointer[] = "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n";
    write_file("lfs.rlog", pointer, sizeof pointer - 1);
    assert_code(2, run("verify lfs.rlog"));
    assert_in("`git lfs pull` fetches it\n", out);
    assert_not_in("restore", out);
}

/* Every report has the reason that a person is shown. */
static void reports_say_why_a_file_is_unreadable(void **state)
{
    (void)state;
    static char junit[1 << 16];
    record("a.rlog");
    mkdir("folder.rlog", 0777);
    static const char *const commands[] = {"verify folder.rlog", "diff a.rlog none.rlog"};
    static const char *const reasons[] = {"unreadable: cannot read folder.rlog: it is a folder, not a file",
                                          "unreadable: cannot read none.rlog: No such file or directory"};
    for (size_t i = 0; i < 2; i++) {
        assert_code(2, run("%s", commands[i]));
        assert_in(reasons[i], out);
        assert_string_equal(err, "");
        assert_code(2, run("%s --json", commands[i]));
        assert_in(reasons[i], out);
        assert_code(2, run("%s --tap --github --junit report.xml", commands[i]));
        assert_in(reasons[i], out);
        assert_in(reasons[i], err);
        read_file("report.xml", junit, sizeof junit);
        assert_in(reasons[i], junit);
    }
    assert_code(2, run("doctor folder.rlog --json"));
    assert_in("\"why\": \"cannot read folder.rlog: it is a folder, not a file\"", out);
    if (json_scenes) {
        write_file("bad.json", "{\"gravityy\": 3}", 15);
        assert_code(2, run("check bad.json --json"));
        assert_in("unknown key; did you mean \\\"gravity\\\"?", out);
    }
    rmdir("folder.rlog");
}

/* ---- Words ---- */

/* Gives a command to the program on a terminal of this width, and reads what it prints there. False: no terminals. */
static bool on_terminal(const char *arguments, int columns)
{
    char command[1024];
    size_t used = 0;
    ssize_t got;
    const int terminal = posix_openpt(O_RDWR | O_NOCTTY);
    if (terminal < 0 || grantpt(terminal) != 0 || unlockpt(terminal) != 0)
        return false;
    snprintf(command, sizeof command, "COLUMNS=%d '%s' %s >%s 2>&1", columns, getenv("RHEOLOG"), arguments,
             ptsname(terminal));
    const int slave = open(ptsname(terminal), O_RDWR | O_NOCTTY); /* so that reading ends only with the program */
    fflush(stdout);
    const pid_t pid = fork();
    if (pid == 0)
        _exit(WEXITSTATUS(system(command)));
    assert_true(slave >= 0 && pid > 0);
    bool ended = false;
    while (!ended) { /* what was written before the end is still there after it */
        struct pollfd ready = {.fd = terminal, .events = POLLIN};
        ended = waitpid(pid, NULL, WNOHANG) == pid;
        while (poll(&ready, 1, 20) == 1 && used + 1 < sizeof out &&
               (got = read(terminal, out + used, sizeof out - 1 - used)) > 0)
            used += (size_t)got;
    }
    out[used] = 0;
    close(slave);
    close(terminal);
    return true;
}

/* Text is wrapped at the width of the terminal, but commands are not, so that they can be copied. */
static void long_lines_are_wrapped_on_a_terminal(void **state)
{
    (void)state;
    enum { COLUMNS = 80 };
    static const char *const cases[] = {"doctor ill.rlog", "info ill.rlog", "log ill.rlog",
                                        "check bowling-ball-small --set fluid.stiffness=1e12"};
    run("run %s --steps 30 --set scheme=sequential --set fluid.stiffness=900 -o ill.rlog --force --quiet", scene);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        int lines = 0;
        if (!on_terminal(cases[i], COLUMNS))
            skip();
        for (const char *line = strtok(out, "\r\n"); line; line = strtok(NULL, "\r\n"), lines++)
            if (strlen(line) > COLUMNS && !strstr(line, "  rheolog "))
                fail_msg("%s: %s", cases[i], line);
        assert_true(lines > 2);
    }
}

/* On a terminal, progress is one line that is written anew five times a second; elsewhere lines have no such marks. */
static void progress_is_written_over_on_a_terminal_only(void **state)
{
    (void)state;
    char command[128] = "";
    out[0] = 0;
    for (int steps = 60; !strstr(out, "\r\033[Kstep "); steps *= 4) { /* until it takes long enough */
        assert_true(steps < 10000);
        snprintf(command, sizeof command,
                 "run bowling-ball-small --set settle.time=0 --steps %d -o progress.rlog --force", steps);
        if (!on_terminal(command, 80))
            skip();
    }
    const char *last = out; /* the line is cleared at the end */
    for (const char *next = out; (next = strstr(next, "\r\033[K")); next++)
        last = next;
    assert_true(strncmp(last, "\r\033[Kstep ", 9) != 0);
    assert_code(0, run("%s", command));
    assert_null(strchr(err, '\033'));
    remove("progress.rlog");
}

static void unlike_words_are_not_suggested(void **state)
{
    (void)state;
    record("a.rlog");
    static const char *const cases[][2] = {
        {"run xyz", "The built-in ones: bowling-ball, "},
        {"check xyz", "The built-in ones: bowling-ball, "},
        {"run bowling-ball --set xyz=3", "`rheolog scenes --parameters` lists them"},
        {"export a.rlog -o x --format picture", "The formats: vtp"},
        {"metrics a.rlog --columns xyz", "--list lists them"},
        {"inspect a.rlog --step 3 --stage xyz", "Its stages: "},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_code(2, run("%s", cases[i][0]));
        assert_one_message(cases[i][1]);
        assert_not_in("did you mean", err);
    }
    if (json_scenes) {
        write_file("unlike.json", "{\"xyzzy\": 3}", 12);
        assert_code(2, run("run unlike.json"));
        assert_one_message("unknown key; `rheolog schema` has them all");
        assert_not_in("did you mean", err);
    }
    assert_code(2, run("run bowling-ball --set balls=3")); /* the group of a parameter */
    assert_one_message("did you mean \"ball.");
}

static void one_is_singular(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("run %s --steps 1 -o one.rlog --force --quiet", scene));
    assert_code(0, run("verify one.rlog"));
    assert_in("same: 1 step from step 0 on", out);
    assert_code(0, run("diff one.rlog one.rlog"));
    assert_in("same: 1 step\n", out);
    assert_code(1, run("diff a.rlog one.rlog"));
    assert_in("the 1 step that both have agrees\n", out);
    assert_code(0, run("run %s --steps 2 -o one.rlog --continue --quiet", scene));
    assert_in("of which it had 1 step\n", out);
    assert_code(2, run("run %s --steps 1 -o a.rlog --continue", scene));
    assert_in("it has 8 steps, more than the 1 of", err);
    if (json_scenes) {
        static const char lone[] =
            "{\"steps\": 1, \"fluid\": {\"shapes\": [{\"block\": {\"min\": [0, 0, 0], \"max\": "
            "[2, 2, 2]}}]}, \"walls\": {\"planes\": [{\"point\": [0, 0, 0], "
            "\"normal\": [0, 1, 0]}]}}";
        write_file("lone.json", lone, sizeof lone - 1);
        assert_code(0, run("run lone.json -o lone.rlog --force --quiet"));
        assert_code(0, run("log lone.rlog"));
        assert_in(", 1 particle\n", out);
        assert_in("1 wall, 0 vibrators\n", out);
        assert_code(0, run("checkpoint lone.rlog --step 1 -o at.rlog --force"));
        assert_in(", 1 particle, hash", out);
    }
}

static void every_command_takes_quiet(void **state)
{
    (void)state;
    static const char *const commands[] = {
        "scenes --quiet",         "check bowling-ball-small --quiet",
        "verify a.rlog --quiet",  "diff a.rlog a.rlog --quiet",
        "doctor a.rlog --quiet",  "rerecord a.rlog -o new.rlog --force --quiet",
        "info a.rlog --quiet",    "bless golden.rlog a.rlog --because it --quiet",
        "log a.rlog --quiet",     "checkpoint a.rlog --step 2 -o at.rlog --force --quiet",
        "inspect a.rlog --quiet", "export a.rlog -o folder --format csv --force --quiet",
        "metrics a.rlog --quiet", "run --from a.rlog --steps 1 --quiet"};
    record("a.rlog");
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
        assert_code(0, run("%s", commands[i]));
        assert_string_equal(err, "");
        assert_true(strlen(out) > 0);
    }
    remove("golden.rlog");
    assert_code(2, run("info a.rlog --quite"));
    assert_one_message("did you mean --quiet?");
    assert_code(2, run("info a.rlog --quiet=yes"));
    assert_one_message("takes no value");
}

/* Also where the library reports what it found in the file. */
static void messages_name_the_file(void **state)
{
    (void)state;
    record("a.rlog");
    falsify_step("a.rlog", "forged.rlog", 5);
    static const char *const commands[] = {"inspect %s --step 8",
                                           "checkpoint %s --step 8 -o x.rlog",
                                           "export %s -o folder --format csv --force",
                                           "run --from %s",
                                           "inspect %s --step 9",
                                           "checkpoint %s --step 9 -o x.rlog",
                                           "run --from %s@9",
                                           "export %s --step 9 -o folder --format csv",
                                           "inspect %s --stage viscosity --step 9"};
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
        const int code = run(commands[i], "forged.rlog");
        assert_int_equal(code, i < 4 ? 1 : 2);
        assert_one_message("forged.rlog");
    }
}

/* ---- Options of run that contradict each other ---- */

static void options_without_effect_are_refused(void **state)
{
    (void)state;
    static const char *const cases[][2] = {
        {"--steps 1 --force", "--force needs -o F.rlog"},
        {"--steps 1 --continue", "--continue needs -o F.rlog"},
        {"--steps 1 --full", "--full needs -o F.rlog"},
        {"--steps 1 --keyframes 3", "--keyframes needs -o F.rlog"},
        {"--steps 1 --continue --force -o x.rlog", "give one of them"},
        {"--write-scene --force", "leave --force out"},
        {"--write-scene --continue", "leave --continue out"},
        {"--write-scene --full", "leave --full out"},
        {"--write-scene --keyframes 3", "leave --keyframes out"},
        {"--write-scene -o x.rlog", "leave -o out"},
        {"--write-scene --until-unhealthy", "leave --until-unhealthy out"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_code(2, run("run %s %s", scene, cases[i][0]));
        assert_one_message(cases[i][1]);
    }
    assert_code(2, run("run --write-scene --from a.rlog"));
    assert_one_message("leave --from out");
    assert_int_equal(file_size("x.rlog"), -1);
}

/* ---- Ctrl-C ---- */

static void wait_ms(long ms)
{
    nanosleep(&(struct timespec){ms / 1000, ms % 1000 * 1000000}, NULL);
}

/* Sends a signal after some time; returns the exit code, or minus the signal that ended the program. */
static int interrupt_after(long ms, const char *arguments)
{
    char command[1024];
    snprintf(command, sizeof command, "exec \"$RHEOLOG\" %s >out.txt 2>err.txt", arguments);
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        execl("/bin/sh", "sh", "-c", command, (char *)NULL);
        _exit(127);
    }
    wait_ms(ms);
    int status;
    assert_int_equal(kill(child, SIGINT), 0);
    assert_int_equal(waitpid(child, &status, 0), child);
    read_file("out.txt", out, sizeof out);
    read_file("err.txt", err, sizeof err);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

/* The first signal may come before the program can receive it; then a later one does. */
static int interrupt(const char *arguments)
{
    int code = -SIGINT;
    for (long ms = 20; code == -SIGINT && ms < 20000; ms *= 2)
        code = interrupt_after(ms, arguments);
    return code;
}

static void no_files_of(const char *pattern)
{
    char command[256];
    snprintf(command, sizeof command, "ls -d %s >/dev/null 2>&1", pattern);
    if (system(command) == 0)
        fail_msg("there is %s", pattern);
}

static void an_interrupted_command_leaves_nothing(void **state)
{
    (void)state;
    assert_code(0,
                run("run bowling-ball-small --set settle.time=0 --steps 400 --keyframes 1000 -o long.rlog --quiet"));
    static const char *const commands[] = {
        "rerecord long.rlog -o left.rlog",
        "bless left.rlog long.rlog --because it",
        "checkpoint long.rlog --step 400 -o left.rlog",
        "inspect long.rlog",
        "export long.rlog -o left --format csv",
        "run bowling-ball -o left.rlog", /* while it settles */
        "run --from long.rlog --steps 1 -o left.rlog",
    };
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
        assert_code(4, interrupt(commands[i]));
        assert_string_equal(out, "");
        if (!strstr(err, "stopped while ") && !strstr(err, "interrupted after 0 of 1 step"))
            fail_msg("%s: %s", commands[i], err);
        no_files_of("left.rlog* left/*");
    }
}

static void an_interrupted_run_says_how_to_go_on(void **state)
{
    (void)state;
    char command[512];
    const char *const settled = "run bowling-ball-small --set settle.time=0 --steps 100000 --quiet -o night.rlog";
    for (int force = 0; force < 2; force++) {
        snprintf(command, sizeof command, "%s%s", settled, force ? " --force" : "");
        int code = 0;
        for (long ms = 200; code == 0 || code == -SIGINT || !strstr(err, "interrupted after "); ms *= 2) {
            remove("night.rlog");
            code = interrupt_after(ms, command);
        }
        assert_code(4, code);
        assert_in(force ? "; the same command with --continue instead of --force goes on\n"
                        : "; the same command with --continue goes on\n",
                  err);
    }
}

/* Regression: a run that ended while it settled printed no JSON, nor did one whose disk was full. */
static void a_run_always_prints_its_json(void **state)
{
    (void)state;
    char command[1024];
    static const char *const refused[][2] = {
        {"run --json", "needs a scene"},
        {"run nowhere --json", "unknown scene"},
        {"run bowling-ball-small --json -o no-folder/a.rlog", "there is no folder no-folder"},
        {"run bowling-ball-small --json --set fluid.spacing=-1", "fluid.spacing"},
        {"run --from nowhere.rlog --json", "cannot read nowhere.rlog"},
        {"run bowling-ball-small --json --simd none", "none"},
    };
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
        assert_code(2, run("%s", refused[i][0]));
        assert_string_equal(value_of("outcome"), "\"refused\"");
        assert_in(refused[i][1], strstr(out, "\"reason\": "));
        assert_ptr_equal(strchr(out, '\n'), out + strlen(out) - 1);
    }
    assert_code(4, interrupt("run bowling-ball --json -o left.rlog"));
    assert_string_equal(value_of("outcome"), "\"interrupted\"");
    assert_in("\"reason\": \"stopped while settling", out);
    assert_in("\"file\": \"left.rlog\"", out);
    no_files_of("left.rlog");
    for (long blocks = 1; blocks <= 16001; blocks += 16000) { /* within the first keyframe, and after it */
        snprintf(command, sizeof command,
                 "trap '' XFSZ; ulimit -f %ld; exec \"$RHEOLOG\" run bowling-ball-small --set settle.time=0 --steps "
                 "5000 -o left.rlog --full --quiet --json >out.txt 2>err.txt",
                 blocks);
        remove("left.rlog");
        assert_int_equal(WEXITSTATUS(system(command)), 3);
        read_file("out.txt", out, sizeof out);
        assert_string_equal(value_of("outcome"), "\"failed\"");
        assert_in("\"reason\": \"cannot write left.rlog", out);
        assert_int_equal(strtol(value_of("steps"), NULL, 10) > 0, blocks > 1);
    }
    remove("left.rlog");
}

/* Regression: a file that appeared while the scene settled was a failure of the system. */
static void a_file_that_appears_while_a_scene_settles_is_not_replaced(void **state)
{
    (void)state;
    remove("late.rlog");
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        execl("/bin/sh", "sh", "-c", "exec \"$RHEOLOG\" run bowling-ball -o late.rlog >out.txt 2>err.txt",
              (char *)NULL);
        _exit(127);
    }
    for (err[0] = 0; !strstr(err, "settling"); wait_ms(5))
        read_file("err.txt", err, sizeof err);
    write_file("late.rlog", "\x89RLOG", 5);
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 2);
    read_file("err.txt", err, sizeof err);
    assert_in("late.rlog exists; give --force to replace it, or another name", err);
    assert_int_equal(file_size("late.rlog"), 5);
    remove("late.rlog");
}

/* What is no file that could be written is found before the scene settles, and is bad input. */
static void odd_outputs_are_bad_input(void **state)
{
    (void)state;
    record("a.rlog");
    remove("dangling");
    assert_int_equal(symlink("nowhere/at/all", "dangling"), 0);
    assert_true(mkdir("folder", 0777) == 0 || errno == EEXIST);
    static const char *const commands[][2] = {
        {"run bowling-ball -o dangling --continue", "dangling is a link that leads to no file"},
        {"run bowling-ball -o dangling --force", "dangling is a link that leads to no file"},
        {"run bowling-ball -o /dev/null --continue", "/dev/null is no regular file, so it cannot be continued"},
        {"run bowling-ball -o folder --force", "folder is a folder"},
        {"bless folder a.rlog --because why", "folder is a folder"},
        {"bless folder a.rlog --because why --shrink", "folder is a folder"},
        {"bless dangling a.rlog --because why", "dangling is a link that leads to no file"},
        {"checkpoint a.rlog --step 1 -o dangling --force", "dangling is a link that leads to no file"},
        {"checkpoint a.rlog --step 1 -o /dev/null --force", "/dev/null is no regular file"},
        {"rerecord a.rlog -o /dev/null --force", "/dev/null is no regular file"},
        {"rerecord a.rlog -o folder --force", "folder is a folder"},
    };
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
        assert_code(2, run("%s", commands[i][0]));
        assert_one_message(commands[i][1]);
    }
    if (geteuid() != 0) { /* root may write anything */
        assert_int_equal(chmod("a.rlog", 0444), 0);
        assert_code(2, run("run %s --steps 8 -o a.rlog --continue", scene));
        assert_one_message("cannot continue a.rlog: Permission denied");
        chmod("a.rlog", 0644);
    }
    assert_code(0, run("run %s --steps 1 -o /dev/null --force --quiet", scene));
    remove("dangling");
    rmdir("folder");
}

/* A file that ends in its first keyframe is begun again, and whoever continues it is told. */
static void a_file_without_a_whole_keyframe_is_begun_again(void **state)
{
    (void)state;
    record("whole.rlog");
    size_t size;
    write_file("torn.rlog", read_bytes("whole.rlog", &size), 3000);
    assert_code(2, run("run %s --steps 8 --keyframes 3 -o torn.rlog --continue", scene));
    assert_in("it has no whole keyframe, so it would be begun again, but it does not begin as this run", err);
    assert_int_equal(file_size("torn.rlog"), 3000);
    assert_code(0, run("run %s --steps 8 -o torn.rlog --continue", scene));
    assert_in("torn.rlog had no whole keyframe yet: it is begun again", err);
    assert_code(0, run("verify torn.rlog"));
    assert_code(0, run("run %s --steps 9 -o torn.rlog --continue", scene));
    if (strstr(err, "begun again"))
        fail_msg("%s", err);
    remove("torn.rlog");
}

static void an_interrupted_continuation_says_that_the_file_is_unchanged(void **state)
{
    (void)state;
    size_t size, now;
    static const char command[] = "run bowling-ball-small --set particles=1500 --set settle.time=0 --steps 3000 "
                                  "--keyframes 3000 -o far.rlog --continue --quiet";
    remove("far.rlog");
    assert_code(0,
                run("run bowling-ball-small --set particles=1500 --set settle.time=0 --steps 2999 --keyframes 3000 "
                    "-o far.rlog --quiet"));
    char *bytes = read_bytes("far.rlog", &size), *kept = malloc(size);
    memcpy(kept, bytes, size);
    assert_code(4, interrupt(command));
    assert_in("rheolog: cannot continue far.rlog: stopped while simulating", err);
    assert_in("; the file is unchanged\n", err);
    assert_memory_equal(read_bytes("far.rlog", &now), kept, size);
    assert_int_equal(now, size);
    free(kept);
    remove("far.rlog");
}

static void a_scene_file_without_text_is_said_to_be_so(void **state)
{
    (void)state;
    if (!json_scenes)
        skip();
    static const struct {
        const char *text;
        size_t size;
        const char *message;
    } cases[] = {
        {"", 0, "none.json:1: there is no text; a scene file holds an object {...}"},
        {" \n\t", 3, "none.json:1: there is no text; a scene file holds an object {...}"},
        {"\xEF\xBB\xBF", 3, "none.json:1: there is no text; a scene file holds an object {...}"},
        {"{\n\"a\": \0 1}", 10,
         "none.json:2: there is a byte 0, as in a binary file or in UTF-16; a scene file is text"},
        {"\xFF\xFE{\0}\0", 6, "none.json:1: there is a byte 0"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        write_file("none.json", cases[i].text, cases[i].size);
        assert_code(2, run("check none.json"));
        assert_one_message(cases[i].message);
    }
    remove("none.json");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_command_that_diff_suggests_works),
        cmocka_unit_test(suggested_commands_quote_file_names),
        cmocka_unit_test(the_commands_that_verify_suggests_work),
        cmocka_unit_test(a_truncated_run_is_said_to_go_on),
        cmocka_unit_test(a_pointer_of_git_lfs_is_only_to_be_fetched),
        cmocka_unit_test(reports_say_why_a_file_is_unreadable),
        cmocka_unit_test(long_lines_are_wrapped_on_a_terminal),
        cmocka_unit_test(progress_is_written_over_on_a_terminal_only),
        cmocka_unit_test(unlike_words_are_not_suggested),
        cmocka_unit_test(one_is_singular),
        cmocka_unit_test(every_command_takes_quiet),
        cmocka_unit_test(messages_name_the_file),
        cmocka_unit_test(options_without_effect_are_refused),
        cmocka_unit_test(an_interrupted_command_leaves_nothing),
        cmocka_unit_test(an_interrupted_run_says_how_to_go_on),
        cmocka_unit_test(a_run_always_prints_its_json),
        cmocka_unit_test(a_file_that_appears_while_a_scene_settles_is_not_replaced),
        cmocka_unit_test(odd_outputs_are_bad_input),
        cmocka_unit_test(a_file_without_a_whole_keyframe_is_begun_again),
        cmocka_unit_test(an_interrupted_continuation_says_that_the_file_is_unchanged),
        cmocka_unit_test(a_scene_file_without_text_is_said_to_be_so),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
