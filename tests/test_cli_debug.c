/* `rheolog debug` from outside: scripts, a pipe, and a pseudo-terminal. */
#define _XOPEN_SOURCE 700
#include "cli_support.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* Runs commands from a file. */
static int debug(const char *file, const char *commands)
{
    write_file("look.txt", commands, strlen(commands));
    return run("debug %s -x look.txt --quiet", file);
}

/* Asserts that the commands succeed and print exactly this. */
static void prints(const char *file, const char *commands, const char *expected)
{
    assert_code(0, debug(file, commands));
    assert_string_equal(err, "");
    assert_string_equal(out, expected);
}

/* Asserts that the last line of a script is refused with this message. */
static void refuses(const char *file, const char *commands, const char *message)
{
    char where[64];
    unsigned line = 0;
    for (const char *c = commands; *c; c++)
        line += *c == '\n';
    assert_code(2, debug(file, commands));
    assert_in(message, err);
    snprintf(where, sizeof where, "rheolog: look.txt, line %u: ", line);
    assert_memory_equal(err, where, strlen(where));
    assert_ptr_equal(strchr(err, '\n'), err + strlen(err) - 1);
}

/* What a command printed, up to the next prompt. */
static const char *printed(const char *command)
{
    static char text[1 << 16];
    const char *at = strstr(out, command);
    assert_non_null(at);
    at = strchr(at, '\n') + 1;
    const char *end = *at == '(' ? at : strstr(at, "\n(a ");
    snprintf(text, sizeof text, "%.*s",
             end && *at != '(' ? (int)(end + 1 - at)
             : *at == '('      ? 0
                               : (int)strlen(at),
             at);
    return text;
}

static void moves_go_both_ways_and_into_steps(void **state)
{
    (void)state;
    record("a.rlog");
    prints(
        "a.rlog",
        "# looks\n\nstep\nstep 3\n  back\nback 2\ngoto 6\ngoto last\ngoto first\ngoto 3 gravity@1\nback\ngoto 3 gravity@1\n"
        "step\ngoto 5\nq\nstep\n",
        "(a 0) step\n(a 1) step 3\n(a 4)   back\n(a 3) back 2\n(a 1) goto 6\n(a 6) goto last\n(a 8) goto first\n"
        "(a 0) goto 3 gravity@1\n(a 3 gravity@1) back\n(a 2) goto 3 gravity@1\n(a 3 gravity@1) step\n(a 3) goto 5\n"
        "(a 5) q\n");
    prints("a.rlog", "step 6\nstep 5\nback 100\nquit\n",
           "(a 0) step 6\n(a 6) step 5\nstep 8 is the last\n(a 8) back 100\nstep 0 is the first\n(a 0) quit\n");
}

/* Every stage of a step, one by one, up to the state of the step. */
static void stages_lead_to_the_next_step(void **state)
{
    (void)state;
    char commands[2048] = "goto 4\n", hash[64];
    record("a.rlog");
    for (int i = 0; i < 60; i++)
        strcat(commands, "stage\n");
    assert_code(0, debug("a.rlog", commands));
    assert_in("(a 4) stage\n(a 5 ", out);
    assert_in("(a 5 gravity@1) stage\n", out);
    assert_in("(a 5) stage\n(a 6 ", out);
    char *end = strstr(out, "(a 5) stage\n");
    unsigned stages = 0;
    for (const char *at = strstr(out, "(a 4) stage\n"); at < end; at = strchr(at, '\n') + 1)
        stages++;
    rheo_world *world = checkpoint_at("a.rlog", 5);
    snprintf(hash, sizeof hash, "hash          %016llx\n", (unsigned long long)rheo_world_hash(world));
    rheo_world_destroy(world);
    strcpy(commands, "goto 4\n");
    for (unsigned i = 0; i < stages; i++)
        strcat(commands, "stage\n");
    strcat(commands, "print\nquit\n");
    assert_code(0, debug("a.rlog", commands));
    assert_in("(a 5) print\n", out);
    assert_in(hash, out);
}

static void print_shows_what_inspect_shows(void **state)
{
    (void)state;
    static char things[1 << 16], all[1 << 16];
    record("a.rlog");
    assert_code(0, run("inspect a.rlog --step 5 --particle 4"));
    snprintf(all, sizeof all, "%.*s", (int)(strstr(out, "\nparticle 4\n") - out), out);
    snprintf(things, sizeof things, "%s", strstr(out, "\nparticle 4\n"));
    assert_code(
        0, debug("a.rlog", "goto 5\nprint\npr particle 4\nprint ball\nprint max_speed\nprint particle 4\nquit\n"));
    assert_string_equal(printed("(a 5) print\n"), all);
    assert_string_equal(printed("(a 5) pr particle 4\n"), things);
    assert_memory_equal(printed("print ball\n"), "ball   ", 7);
    assert_memory_equal(printed("print max_speed\n"), "  max_speed   ", 14);
    assert_string_equal(printed("(a 5) print particle 4\n"), things);
    assert_code(0, run("inspect a.rlog --step 5 --stage gravity@1 --top 2"));
    snprintf(things, sizeof things, "%s", strstr(out, "\ndensest"));
    assert_code(0, debug("a.rlog", "goto 5 gravity@1\ntop 2\nprint max_speed\nquit\n"));
    assert_string_equal(printed("top 2\n"), things);
    assert_in("at the end of step 4:\n  max_speed", out);
}

static void searches_go_there_and_when_stays(void **state)
{
    (void)state;
    record("a.rlog");
    prints(
        "a.rlog", "until step >= 5\nback until step < 3\nwhen step > 6\nb until step < 3\nquit\n",
        "(a 0) until step >= 5\nstep 5: step is 5\n(a 5) back until step < 3\nstep 2: step is 2\n(a 2) when step > 6\n"
        "step 7: step is 7\nstep 8: step is 8\n(a 2) b until step < 3\nstep 1: step is 1\n(a 1) quit\n");
    assert_code(0, debug("a.rlog", "goto 3 gravity@1\nuntil particle 4: speed >= 0\nquit\n"));
    assert_in("step 3: particle 4: speed is ", out);
    assert_in("(a 3) quit\n", out);
    refuses("a.rlog", "goto 2\nuntil step > 100\n", "does not hold in steps 3 to 8");
    refuses("a.rlog", "goto 2\nback until step > 100\n", "does not hold in steps 0 to 1");
    refuses("a.rlog", "when step > 100\n", "does not hold in steps 0 to 8");
    refuses("a.rlog", "goto last\nuntil step > 1\n", "step 8 is the last");
    refuses("a.rlog", "back until step > 1\n", "step 0 is the first");
    refuses("a.rlog", "until stepp > 1\n", "did you mean \"step\"");
    refuses("a.rlog", "until\n", "needs a condition");
}

/* The same numbers as `rheolog track`. */
static void track_prints_a_table(void **state)
{
    (void)state;
    char y[32], number[80];
    record("a.rlog");
    assert_code(0, run("track a.rlog --ball --field y --from 3 --to 3"));
    const char *last = strrchr(out, ',') + 1;
    rheo_number_brief(number_at(&last), 6, y);
    assert_code(
        0, debug("a.rlog",
                 "goto 3\ntrack ball y 2\ntrack ball y -3\ntrack ball y\ntrack particle 4 derivative 1\nquit\n"));
    snprintf(number, sizeof number, "\n       3  %14s\n       4  ", y);
    assert_in(number, out);
    assert_in("(a 3) track ball y -3\n    step               y\n       1  ", out);
    assert_memory_equal(strrchr(printed("track ball y\n"), '8') - 7, "       8", 8);
    assert_in("    step    derivative.x    derivative.y    derivative.z\n       3  ", out);
    assert_in("(a 3) quit\n", out);
    refuses("a.rlog", "track ball y 0\n", "number of steps");
    refuses("a.rlog", "track ball yy\n", "there is no field \"yy\"");
    refuses("a.rlog", "track ball\n", "needs a field, one of: x, y, z");
    refuses("a.rlog", "track\n", "needs an item and a field");
    refuses("a.rlog", "track particle 99999999 y\n", "there is no particle 99999999");
    refuses("a.rlog", "track spring 1:1 stretch\n", "two different ids");
}

static void errors_name_the_line_and_end_the_script(void **state)
{
    (void)state;
    record("a.rlog");
    refuses("a.rlog", "step\n# no\n\nfly\n", "there is no command \"fly\"");
    assert_string_equal(out, "(a 0) step\n(a 1) fly\n");
    refuses("a.rlog", "step\ns\n", "\"s\" may be step, stage, set, save");
    refuses("a.rlog", "stepp\n", "did you mean \"step\"");
    refuses("a.rlog", "step x\n", "needs a number of steps");
    refuses("a.rlog", "goto last\nstep\n", "step 8 is the last");
    refuses("a.rlog", "back\n", "step 0 is the first");
    refuses("a.rlog", "goto 9\n", "there is no step 9; a.rlog has 0 to 8");
    refuses("a.rlog", "goto\n", "needs a step, first or last");
    refuses("a.rlog", "goto 3 gravty\n", "did you mean \"gravity\"");
    refuses("a.rlog", "goto last\nstage\n", "no step after 8");
    refuses("a.rlog", "print max_sped\n", "did you mean \"max_speed\"");
    refuses("a.rlog", "print particle x\n", "needs an id");
    refuses("a.rlog", "print particle 99999999\n", "there is no particle 99999999");
    refuses("a.rlog", "print spring 3\n", "two different ids");
    refuses("a.rlog", "top x\n", "needs a whole number");
    refuses("a.rlog", "set fluid.stifness 3\n", "fluid.stiffness");
    refuses("a.rlog", "set step\n", "needs a parameter and a value");
    refuses("a.rlog", "set settle.time 3\n", "only to create a scene");
    refuses("a.rlog", "goto 3 gravity@1\nset step 0.01\n", "between steps");
    refuses("a.rlog", "goto 3 gravity@1\nsave new.rlog\n", "between steps");
    refuses("a.rlog", "diff\n", "needs a fork");
    refuses("a.rlog", "original\n", "needs a fork");
    refuses("a.rlog", "save\n", "needs a file");
    refuses("a.rlog", "save a.rlog\n", "a.rlog");
    refuses("a.rlog", "info x\n", "takes no arguments");
    refuses("a.rlog", "help x\n", "there is no command \"x\"");
    assert_int_equal(access("new.rlog", F_OK), -1);
    assert_code(2, run("debug a.rlog -x none.txt"));
    assert_one_message("none.txt");
    assert_code(2, run("debug none.rlog"));
    assert_one_message("none.rlog");
    assert_code(2, run("debug"));
    assert_one_message("one recording");
}

/* An error from the recording keeps its exit code. */
static void a_step_that_does_not_repeat_is_not_entered(void **state)
{
    (void)state;
    record("a.rlog");
    falsify_step("a.rlog", "a5.rlog", 5);
    assert_code(1, debug("a5.rlog", "step 4\nstep\n"));
    assert_in("look.txt, line 2: a5.rlog", err);
    assert_in("step 5", err);
    assert_int_equal(system("printf 'step 4\\nstep\\nback\\n' | \"$RHEOLOG\" debug a5.rlog >out.txt 2>err.txt"), 0);
    read_file("out.txt", out, sizeof out);
    assert_string_equal(out, "(a5 0) step 4\n(a5 4) step\n(a5 4) back\n(a5 3) \n");
}

/* The fork is the run that `run --from` makes, can be gone back in, and leaves the recording as it is. */
static void a_fork_is_a_run_of_its_own(void **state)
{
    (void)state;
    static char before[1 << 20], after[1 << 20];
    record("a.rlog");
    remove("fork.rlog");
    remove("b.rlog");
    read_file("a.rlog", before, sizeof before);
    assert_code(0, run("run --from a.rlog@3 --set fluid.stiffness=250 --steps 7 -o b.rlog --force --quiet"));
    assert_code(0, debug("a.rlog",
                         "goto 3\nset fluid.stiffness 250\nstep 7\nback 6\nback\nstep\nstage\nstep 2\n"
                         "until step >= 10\ngoto last\nsave fork.rlog\nlog\nback until step < 5\noriginal\nquit\n"));
    assert_string_equal(err, "");
    assert_in("(a 3) set fluid.stiffness 250\na fork begins at step 3; the recording does not change\n(a 3*) step 7\n"
              "(a 10*) back 6\n(a 4*) back\n(a 3*) step\n(a 4*) stage\n(a 5* ",
              out);
    assert_in(
        "(a 6*) until step >= 10\nstep 10: step is 10\n(a 10*) goto last\n(a 10*) save fork.rlog\nfork.rlog: the fork, step 3 to 10\n",
        out);
    assert_in("step 4      fluid.stiffness was set to 250; before, it was ", out);
    assert_in("(a 10*) back until step < 5\nstep 4: step is 4\n(a 4*) original\n(a 3) quit\n", out);
    read_file("a.rlog", after, sizeof after);
    assert_memory_equal(before, after, sizeof before);
    assert_code(0, run("verify fork.rlog"));
    assert_code(0, run("diff fork.rlog b.rlog"));
}

/* `stage` makes the next step of a fork, and shows it stage by stage; each step in the fork can be changed again. */
static void a_fork_goes_on_with_stages_and_changes(void **state)
{
    (void)state;
    record("a.rlog");
    remove("fork.rlog");
    assert_code(0, debug("a.rlog",
                         "goto 3\nset fluid.stiffness 250\nstage\nback\ngoto last\nset fluid.stiffness 260\nstep 3\n"
                         "save fork.rlog\ngoto 6\nset fluid.stiffness 270\n"));
    assert_in("(a 3*) stage\n(a 4* ", out);
    assert_in("(a 3*) goto last\n(a 4*) set fluid.stiffness 260\n(a 4*) step 3\n(a 7*) save", out);
    assert_in("(a 6*) set fluid.stiffness 270\na fork begins at step 6, in place of the one before; ", out);
    assert_code(2, run("debug a.rlog -x look.txt")); /* fork.rlog exists; nothing after that line was run */
    assert_null(strstr(out, "goto 6"));
    assert_code(0, run("verify fork.rlog"));
    assert_code(0, run("log fork.rlog"));
    assert_in("step 4      fluid.stiffness was set to 250", out);
    assert_in("step 5      fluid.stiffness was set to 260", out);
}

static void diff_lists_the_fields_that_differ(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, debug("a.rlog",
                         "goto 3\nset fluid.stiffness 250\ndiff\nstep 2\ndiff\nback 2\nset fluid.stiffness 250\n"
                         "step\ndiff\nquit\n"));
    assert_in("fluid.stiffness = 300 in the recording, 250 in the fork\n"
              "step 3: the states have the same bits\n",
              out);
    assert_in(
        "step 5: items that differ, the largest difference, and its ratio to the field's largest value\n  position  ",
        out);
    refuses("a.rlog", "goto 8\nset fluid.stiffness 250\nstep\ndiff\n", "ends with step 8");
    refuses("a.rlog", "goto 3\nset fluid.stiffness 250\nstage\ndiff\n", "ends of steps");
    refuses("a.rlog", "goto 3\nset fluid.stiffness 250\nstep\ngoto 2\n", "there is no step 2; the fork has 3 to 4");
    refuses("a.rlog", "set fluid.stiffness 250\nuntil step > 100\n",
            "does not hold in steps 1 to 8, as far as the recording goes");
}

static void save_writes_the_state(void **state)
{
    (void)state;
    record("a.rlog");
    remove("state.rlog");
    assert_code(0, debug("a.rlog", "goto 5\nsave state.rlog\ninfo\nlog\nhelp\nhelp set\nquit\n"));
    assert_in("state.rlog: the state of step 5, hash ", out);
    assert_in("\nkeyframes   1", out);
    assert_in("\nends        complete, after step 8\n", out);
    assert_in("\nquit                          end\n", out);
    assert_in("set PARAMETER VALUE: begin a fork", out);
    assert_code(0, run("checkpoint a.rlog --step 5 -o other.rlog --force"));
    assert_files_same("state.rlog", "other.rlog");
}

static void a_pipe_reads_as_a_session(void **state)
{
    (void)state;
    record("a.rlog");
    assert_int_equal(system("printf 'step\\n\\nfly\\nback' | \"$RHEOLOG\" debug a.rlog >out.txt 2>err.txt"), 0);
    read_file("out.txt", out, sizeof out);
    read_file("err.txt", err, sizeof err);
    assert_string_equal(out, "(a 0) step\n(a 1) \n(a 2) fly\n(a 2) back\n(a 1) \n");
    assert_string_equal(err, "rheolog: there is no command \"fly\" (help lists them)\n");
}

/* ---- The page ---- */

/* The session of docs/debugging.md is what the program prints. */
static void the_session_of_the_page_is_true(void **state)
{
    (void)state;
    static char page[1 << 18], session[1 << 14], commands[1 << 12];
    char path[4096];
    if (sizeof(rheo_real) != sizeof(float))
        skip(); /* the page is of a build for float */
    snprintf(path, sizeof path, "%s/../../docs/debugging.md", getenv("SCENES"));
    read_file(path, page, sizeof page);
    const char *at = strstr(page, "$ rheolog debug bad.rlog\n");
    assert_non_null(at);
    at = strchr(at, '\n') + 1;
    snprintf(session, sizeof session, "%.*s", (int)(strstr(at, "```") - at), at);
    for (const char *line = session; *line; line = strchr(line, '\n') + 1)
        if (strncmp(line, "(bad ", 5) == 0)
            strncat(commands, strstr(line, ") ") + 2, strcspn(strstr(line, ") ") + 2, "\n") + 1);
    assert_in("step", commands);
    remove("good.rlog");
    remove("fork.rlog");
    assert_code(
        0, run("run bowling-ball-small --set step=0.07 --set substeps=2 --steps 60 -o bad.rlog --force --quiet"));
    prints("bad.rlog", commands, session);
}

/* ---- A terminal ---- */

static int terminal;
static char shown[1 << 16]; /* and not yet waited for */

/* Takes in what the program has written. False: nothing in this time. */
static bool take_in(int milliseconds)
{
    struct pollfd p = {.fd = terminal, .events = POLLIN};
    const size_t length = strlen(shown);
    if (poll(&p, 1, milliseconds) != 1)
        return false;
    const ssize_t got = read(terminal, shown + length, sizeof shown - 1 - length);
    if (got <= 0)
        return false;
    shown[length + (size_t)got] = 0;
    return true;
}

/* Waits until the program has shown a text, and goes past that. False: it shows nothing more for this time. */
static bool shows(const char *text, int milliseconds)
{
    char *at;
    while (!(at = strstr(shown, text)))
        if (!take_in(milliseconds))
            return false;
    at += strlen(text);
    memmove(shown, at, strlen(at) + 1);
    return true;
}

static void wait_for(const char *text)
{
    if (!shows(text, 100000))
        fail_msg("the terminal shows \"%s\" and not \"%s\"", shown, text);
}

static void type(const char *keys)
{
    assert_int_equal(write(terminal, keys, strlen(keys)), strlen(keys));
}

/*
 * Presses a key until it has its effect: a Ctrl-C right before the program reads is lost, and so is a Ctrl-D while it does not.
 */
static void press_until(const char *key, const char *text)
{
    for (int i = 0; i < 200; i++) {
        type(key);
        if (shows(text, 500))
            return;
    }
    fail_msg("the terminal shows \"%s\" and not \"%s\"", shown, text);
}

/*
 * Ends the session by Ctrl-D. One that is typed before the program reads is a zero in its line (the kernel then still gathers
 * lines), and behind a character Ctrl-D does not end it: so Ctrl-U first empties the line.
 */
static void end_session(pid_t child)
{
    int status = -1;
    pid_t ended = 0;
    for (int i = 0; i < 600 && ended == 0; i++) {
        if (write(terminal, "\025\004", 2) != 2)
            break; /* it has ended */
        shown[0] = 0;
        take_in(100);
        ended = waitpid(child, &status, WNOHANG);
    }
    if (ended == 0) {
        kill(child, SIGKILL);
        ended = waitpid(child, &status, 0);
    }
    assert_int_equal(ended, child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
    close(terminal);
}

static pid_t open_terminal(const char *file)
{
    shown[0] = 0;
    terminal = posix_openpt(O_RDWR | O_NOCTTY);
    assert_true(terminal >= 0);
    assert_int_equal(grantpt(terminal), 0);
    assert_int_equal(unlockpt(terminal), 0);
    const char *name = ptsname(terminal);
    assert_non_null(name);
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        setsid(); /* the first terminal that it opens then sends it Ctrl-C */
        const int own = open(name, O_RDWR);
        for (int i = 0; i < 3; i++)
            dup2(own, i);
        setenv("TERM", "xterm", 1);                  /* that of vt100 fills with zeros */
        setenv("ASAN_OPTIONS", "detect_leaks=0", 1); /* libedit keeps the name of a function that was added */
        signal(SIGINT, SIG_DFL);
        execl(getenv("RHEOLOG"), "rheolog", "debug", file, "--quiet", (char *)NULL);
        _exit(127);
    }
    return child;
}

static void a_terminal_has_a_prompt_and_ctrl_c(void **state)
{
    (void)state;
    record("a.rlog");
    const pid_t child = open_terminal("a.rlog");
    wait_for("(a 0) ");
    type("step 3\n");
    wait_for("(a 3) ");
    type("\n"); /* three more */
    wait_for("(a 6) ");
    type("fly\n");
    wait_for("no command \"fly\"");
    wait_for("(a 6) ");
    type("step 2");
    wait_for("step 2");
    press_until("\003", "(a 6) "); /* gives the line up */
    type("goto 4\n");
    wait_for("(a 4) ");
    type("set fluid.stiffness 290\n");
    wait_for("(a 4*) ");
    bool interrupted = false;
    for (int wait = 250; wait <= 16000 && !interrupted; wait *= 2) { /* until then the line may not have been read */
        type("step 1000000000\n");                                   /* a fork has no end */
        nanosleep(&(struct timespec){wait / 1000, wait % 1000 * 1000000L}, NULL);
        type("\003");
        interrupted = shows("interrupted after step ", 2000 + 2 * wait);
    }
    assert_true(interrupted);
    type("original\n");
    wait_for("(a 4) ");
    end_session(child);
}

static void tab_completes_and_arrows_bring_lines_back(void **state)
{
    (void)state;
#ifndef WITH_LIBEDIT
    skip();
#else
    record("a.rlog");
    const pid_t child = open_terminal("a.rlog");
    wait_for("(a 0) ");
    type("sta\t\n");
    wait_for("(a 1 ");
    type("go\t2 grav\t\n");
    wait_for("(a 2 gravity@1) ");
    type("print max_spe\t\n");
    wait_for("  max_speed   ");
    wait_for("(a 2 gravity@1) ");
    type("goto fi\t\n");
    wait_for("(a 0) ");
    type("step 3\n");
    wait_for("(a 3) ");
    type("\033[A\n"); /* up */
    wait_for("(a 6) ");
    type("st\t");
    wait_for("  step  stage");
    wait_for("(a 6) st");
    press_until("\003", "(a 6) ");
    end_session(child);
#endif
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(moves_go_both_ways_and_into_steps),
        cmocka_unit_test(stages_lead_to_the_next_step),
        cmocka_unit_test(print_shows_what_inspect_shows),
        cmocka_unit_test(searches_go_there_and_when_stays),
        cmocka_unit_test(track_prints_a_table),
        cmocka_unit_test(errors_name_the_line_and_end_the_script),
        cmocka_unit_test(a_step_that_does_not_repeat_is_not_entered),
        cmocka_unit_test(a_fork_is_a_run_of_its_own),
        cmocka_unit_test(a_fork_goes_on_with_stages_and_changes),
        cmocka_unit_test(diff_lists_the_fields_that_differ),
        cmocka_unit_test(save_writes_the_state),
        cmocka_unit_test(a_pipe_reads_as_a_session),
        cmocka_unit_test(the_session_of_the_page_is_true),
        cmocka_unit_test(a_terminal_has_a_prompt_and_ctrl_c),
        cmocka_unit_test(tab_completes_and_arrows_bring_lines_back),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
