/* Long runs from outside: two writers on one file, files that are being written, signals, and runs that continue. */
#define _XOPEN_SOURCE 700 /* kill(), nanosleep() */
#include "cli_support.h"

#include <math.h>
#include <signal.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static void wait_a_little(void)
{
    const struct timespec pause = {0, 20000000};
    nanosleep(&pause, NULL);
}

static const int endings[] = {SIGHUP, SIGTERM, SIGINT}; /* that end a run */

/* Starts a command beside the test. */
static pid_t start_shell(const char *command)
{
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        /* The program leaves a signal ignored that is ignored already, as with nohup or in the background of a shell. */
        for (size_t i = 0; i < sizeof endings / sizeof *endings; i++)
            signal(endings[i], SIG_DFL);
        execl("/bin/sh", "sh", "-c", command, (char *)NULL);
        _exit(127);
    }
    return child;
}

/* Starts `rheolog run SCENE ARGUMENTS` beside the test. Its output goes to out.txt and err.txt. */
static pid_t start(const char *arguments)
{
    char command[4096];
    snprintf(command, sizeof command, "exec \"$RHEOLOG\" run %s %s --quiet >out.txt 2>err.txt", scene, arguments);
    return start_shell(command);
}

/* Waits until a recording has some steps: its signal handlers are installed then. */
static void wait_for_steps(const char *path, long bytes)
{
    for (int i = 0; i < 3000 && file_size(path) < bytes; i++)
        wait_a_little();
    assert_true(file_size(path) >= bytes);
}

static bool has_ended(pid_t child)
{
    siginfo_t info = {0};
    return waitid(P_PID, (id_t)child, &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid == child;
}

/* Ends it with a signal; returns its exit code, or minus the signal that ended it. */
static int end_with(pid_t child, int number)
{
    int status = 0;
    kill(child, number);
    assert_int_equal(waitpid(child, &status, 0), child);
    read_file("out.txt", out, sizeof out);
    read_file("err.txt", err, sizeof err);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

/* Runs the program without touching the output of the run that is started. */
static int beside(const char *arguments)
{
    char command[4096];
    snprintf(command, sizeof command, "\"$RHEOLOG\" %s >out2.txt 2>err2.txt", arguments);
    const int status = system(command);
    read_file("out2.txt", out, sizeof out);
    read_file("err2.txt", err, sizeof err);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

static void a_second_writer_on_a_file_is_refused(void **state)
{
    (void)state;
    record("a.rlog");
    const pid_t child = start("--steps 100000000 -o twice.rlog");
    wait_for_steps("twice.rlog", 2 * file_size("a.rlog"));
    char second[1024];
    snprintf(second, sizeof second, "run %s --steps 1 -o twice.rlog --force", scene);
    const char *const writers[] = {second, "checkpoint a.rlog --step 2 -o twice.rlog --force",
                                   "bless twice.rlog a.rlog --because \"it is mine\""};
    for (size_t i = 0; i < sizeof writers / sizeof *writers; i++) {
        assert_code(2, beside(writers[i]));
        assert_in("being written", err);
    }
    /* Meanwhile it can be read. */
    assert_code(0, beside("info twice.rlog"));
    assert_in("no: being written: ", out);
    assert_in("is being written: ", err);
    assert_in(" steps so far", err);
    assert_code(0, beside("info twice.rlog --json"));
    assert_string_equal(value_of("being_written"), "true");
    assert_code(0, beside("log twice.rlog"));
    assert_in("ends        being written: ", out);
    assert_null(strstr(out, "truncated"));
    assert_code(0, beside("log twice.rlog --json"));
    assert_in("\"ending\": \"being_written\"", out);
    beside("doctor twice.rlog");
    assert_in("is being written: ", err);
    assert_code(2, beside("verify twice.rlog"));
    assert_in("being written", out);
    assert_null(strstr(out, "truncated"));
    assert_null(strstr(out, "restore"));
    assert_code(0, beside("checkpoint twice.rlog --step 3 -o three.rlog --force"));
    assert_int_equal(end_with(child, SIGKILL), -SIGKILL);
    /* Nobody writes it any more: it is truncated. */
    assert_code(0, run("info twice.rlog --json"));
    assert_string_equal(value_of("being_written"), "false");
    assert_string_equal(value_of("complete"), "false");
    assert_in("is truncated", err);
    assert_code(0, run("run %s --steps 1 -o twice.rlog --force", scene));
    assert_code(0, run("verify twice.rlog"));
}

/* A closed terminal, a batch system and Ctrl-C leave a recording that is complete, and are told from a run gone bad. */
static void a_signal_closes_the_file_and_has_its_own_exit_code(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++) {
        remove("ended.rlog");
        const pid_t child = start("--steps 100000000 --json --set fluid.stiffness=250 -o ended.rlog");
        wait_for_steps("ended.rlog", 200000);
        assert_code(4, end_with(child, endings[i]));
        assert_in("interrupted after ", err);
        assert_string_equal(value_of("outcome"), "\"interrupted\"");
        assert_in("\"reason\": \"interrupted after ", out);
        assert_in("\"stage\": null", out);
        assert_in("\"fluid.stiffness=250\"]", out);
        assert_code(0, run("info ended.rlog --json"));
        assert_string_equal(value_of("complete"), "true");
        assert_true(strtol(value_of("steps"), NULL, 10) > 10);
    }
}

/* "Went bad" keeps its exit code, and the JSON says what, where, and with which parameters. */
static void the_json_of_a_failed_run_says_why(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("info a.rlog --json"));
    if (strcmp(value_of("real_bytes"), "4") != 0)
        skip(); /* no parameter value is large enough to overflow doubles */
    assert_code(1, run("run %s --steps 50 --set step=1e5 --set fluid.stiffness=1e29 --json --quiet", scene));
    assert_string_equal(value_of("outcome"), "\"failed\"");
    assert_in("\"reason\": \"step ", out);
    assert_null(strstr(out, "\"stage\": null"));
    assert_in("\"step=1e5\", \"fluid.stiffness=1e29\"]", out);
    assert_code(0, run("run %s --steps 1 --json", scene));
    assert_in("\"reason\": null", out);
    if (json_scenes)
        assert_in("\"set\": []", out);
}

/* ---- Continuing ---- */

/* timeout(1) sends its signal to a program and again to its group, which is one request. */
static void a_signal_that_comes_twice_at_once_is_one(void **state)
{
    (void)state;
    for (int i = 0; i < 5; i++) {
        remove("signalled.rlog");
        const pid_t child = start("--steps 100000000 -o signalled.rlog");
        wait_for_steps("signalled.rlog", file_size("a.rlog") / 2);
        const struct timespec pause = {0, 20000};
        int status;
        for (int k = 0; k < 30 && !has_ended(child); k++) {
            kill(child, SIGTERM);
            nanosleep(&pause, NULL);
        }
        assert_int_equal(waitpid(child, &status, 0), child);
        assert_true(WIFEXITED(status));
        assert_int_equal(WEXITSTATUS(status), 4);
    }
    remove("signalled.rlog");
}

/* However often a run is ended, it becomes the file of a run that was not. */
static void a_run_that_is_killed_again_and_again_ends_with_the_same_bytes(void **state)
{
    (void)state;
    static const char *const options[] = {"--keyframes 50", "--keyframes 50 --full"};
    static const int signals[] = {SIGKILL, SIGTERM, SIGKILL, SIGHUP, SIGKILL};
    for (size_t n = 0; n < 2; n++) {
        char arguments[256];
        const int steps = n ? 400 : 1200;
        assert_code(0, run("run %s --steps %d %s -o whole.rlog --force --quiet --json", scene, steps, options[n]));
        char hash[32];
        snprintf(hash, sizeof hash, "%s", value_of("hash"));
        remove("pieces.rlog");
        snprintf(arguments, sizeof arguments, "--steps %d %s -o pieces.rlog --continue", steps, options[n]);
        const long whole = file_size("whole.rlog");
        int ended = 0;
        for (int i = 0; i < 5; i++) {
            const long size = file_size("pieces.rlog") > 0 ? file_size("pieces.rlog") : 0;
            const pid_t child = start(arguments);
            for (int w = 0; w < 3000 && file_size("pieces.rlog") < size + whole / 8 && !has_ended(child); w++)
                wait_a_little();
            ended += end_with(child, signals[i]) != 0;
        }
        assert_true(ended >= 1); /* a fast machine may finish before the last signal */
        assert_code(0, run("run %s %s --json --quiet", scene, arguments));
        assert_string_equal(value_of("hash"), hash);
        assert_files_same("pieces.rlog", "whole.rlog");
        assert_code(0, run("verify pieces.rlog"));
        /* Complete: it is confirmed. */
        assert_code(0, run("run %s %s --json --quiet", scene, arguments));
        assert_string_equal(value_of("steps"), "0");
        assert_string_equal(value_of("hash"), hash);
        assert_files_same("pieces.rlog", "whole.rlog");
    }
}

static void a_run_that_filled_the_disk_is_continued(void **state)
{
    (void)state;
    char command[4096];
    assert_code(0, run("run %s --steps 60 -o whole.rlog --keyframes 7 --force --quiet", scene));
    for (int part = 0; part < 4; part++) { /* within the first keyframe, and later */
        remove("pieces.rlog");
        snprintf(command, sizeof command,
                 "trap '' XFSZ; ulimit -f %ld; exec \"$RHEOLOG\" run %s --steps 60 --keyframes 7 -o pieces.rlog "
                 "--continue --quiet >out.txt 2>err.txt",
                 file_size("whole.rlog") / 512 * part / 4 + 1, scene);
        const int status = system(command);
        assert_true(WIFEXITED(status));
        assert_int_equal(WEXITSTATUS(status), 3);
        assert_code(0, run("run %s --steps 60 --keyframes 7 -o pieces.rlog --continue --quiet", scene));
        assert_files_same("pieces.rlog", "whole.rlog");
    }
}

static void another_run_is_not_continued(void **state)
{
    (void)state;
    record("a.rlog");
    record("same.rlog");
    write_file("letter.txt", "a letter", 8);
    static const char *const cases[][2] = {
        {"--steps 7 -o a.rlog", "it has 8 steps, more than the 7"},
        {"--steps 9 -o a.rlog --set fluid.stiffness=250", "fluid.stiffness"},
        {"--steps 9 -o a.rlog --set seed=5", "cannot continue a.rlog"},
        {"--steps 9 -o a.rlog --keyframes 4", "keyframe every"},
        {"--steps 9 -o a.rlog --full", "state of every step"},
        {"--steps 9 -o a.rlog --force", "--force"},
        {"--steps 9", "-o F.rlog"},
        {"--steps 9 -o letter.txt", "cannot continue letter.txt"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_code(2, run("run %s --continue %s --quiet", scene, cases[i][0]));
        assert_one_message(cases[i][1]);
        assert_files_same("a.rlog", "same.rlog");
    }
    assert_code(2, run("run vibration --continue --steps 9 -o a.rlog --quiet"));
    assert_in("scene", err);
    assert_files_same("a.rlog", "same.rlog");
}

/* A run that began with --from and changed parameters, which are commands before its first step. */
static void a_run_from_a_recording_is_continued(void **state)
{
    (void)state;
    record("a.rlog");
    static const char set[] = "--set gravity=[0,-20,0] --set fluid.linear_viscosity=3";
    assert_code(0, run("run --from a.rlog@4 %s --steps 30 -o whole.rlog --force --quiet", set));
    for (int steps = 0; steps <= 30; steps += 10) {
        assert_code(0, run("run --from a.rlog@4 %s --steps %d -o part.rlog --force --quiet", set, steps));
        assert_code(0, run("run --from a.rlog@4 %s --steps 30 -o part.rlog --continue --quiet", set));
        assert_files_same("part.rlog", "whole.rlog");
    }
    static const char *const cases[] = {"a.rlog@4", "a.rlog@4 --set gravity=[0,-20,0]", "a.rlog@5",
                                        "a.rlog@4 --set gravity=[0,-20,0] --set fluid.linear_viscosity=2"};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_code(2, run("run --from %s --steps 40 -o part.rlog --continue --quiet", cases[i]));
        assert_one_message("cannot continue part.rlog");
        assert_files_same("part.rlog", "whole.rlog");
    }
}

/* ---- Health ---- */

/* An ill scene: one substep is too few for its pressure. */
#define ILL "--set settle.time=0 --set substeps=1 --set fluid.stiffness=5000 --set step=0.05"

/* Settling throws it about, with parameters that a state could bear. */
#define RESTLESS "--set scheme=sequential --set springs.stiffness=2500 --set settle.time=1"

static void an_unhealthy_run_says_so_in_its_last_line(void **state)
{
    (void)state;
    assert_code(0, run("run %s %s --steps 40 -o ill.rlog --force --json", scene, ILL));
    const char *line = strstr(err, "rheolog: unhealthy since step ");
    assert_non_null(line);
    assert_in(": `rheolog doctor ill.rlog`\n", line);
    assert_ptr_equal(strchr(line, '\n')[1] ? NULL : line, line); /* the last line */
    const long step = strtol(line + strlen("rheolog: unhealthy since step "), NULL, 10);
    assert_string_equal(value_of("healthy"), "false");
    assert_int_equal(strtol(value_of("unhealthy_step"), NULL, 10), step);
    assert_in("\"reason\": \"unhealthy since step ", out);
    assert_null(strstr(out, "\"stage\": null"));
    assert_code(1, run("doctor ill.rlog --json"));
    assert_int_equal(strtol(value_of("unhealthy_step"), NULL, 10), step);
    /* --until-unhealthy ends there and keeps the file; --continue goes on to the same bytes. */
    assert_code(1, run("run %s %s --steps 40 -o until.rlog --until-unhealthy --quiet --json", scene, ILL));
    assert_in("unhealthy since step ", err);
    assert_string_equal(value_of("outcome"), "\"unhealthy\"");
    assert_int_equal(strtol(value_of("steps"), NULL, 10), step);
    assert_code(0, run("verify until.rlog"));
    assert_code(1, run("run %s %s --steps 40 -o until.rlog --until-unhealthy --continue --quiet --json", scene, ILL));
    assert_string_equal(value_of("steps"), "0");
    assert_code(0, run("run %s %s --steps 40 -o until.rlog --continue --quiet", scene, ILL));
    assert_in("unhealthy since step ", err); /* of the steps that the file had */
    assert_files_same("until.rlog", "ill.rlog");
    /* A run that starts from there says so; a healthy one says nothing. */
    assert_code(0, run("run --from ill.rlog --steps 1 --quiet"));
    assert_in("warning: the recording that the run starts from is unhealthy: in step ", err);
    assert_code(0, run("run --from ill.rlog@0 --steps 0 --quiet"));
    assert_string_equal(err, "");
    assert_code(0, run("run %s --steps 5 --quiet --json", scene));
    assert_string_equal(err, "");
    assert_string_equal(value_of("healthy"), "true");
    assert_in("\"health\": null", out);
}

static void a_scene_that_starts_ill_warns(void **state)
{
    (void)state;
    if (!json_scenes) /* the settings are for that scene */
        skip();
    assert_code(0, run("run %s " ILL " --set settle.time=3 --steps 0 --quiet", scene)); /* ill while it settles */
    assert_in("warning: the run is unhealthy from its start: in step 0 start_speed is ", err);
    assert_code(0, run("run %s " RESTLESS " --steps 0 --quiet", scene));
    assert_in("warning: the run may go bad: in step 0 courant_number is ", err);
    assert_code(0, run("run %s --set settle.time=3 --steps 0 --quiet", scene));
    assert_string_equal(err, "");
}

/* ---- Following ---- */

/* Starts `rheolog metrics --follow FILE OPTIONS` beside the test. Its output goes to rows.csv and followed.txt. */
static pid_t start_following(const char *arguments)
{
    char command[4096];
    snprintf(command, sizeof command, "exec \"$RHEOLOG\" metrics --follow %s >rows.csv 2>followed.txt", arguments);
    return start_shell(command);
}

static void wait_for_words(const char *words)
{
    bool said = false;
    for (int i = 0; i < 3000 && !said; i++) {
        wait_a_little();
        if (file_size("followed.txt") > 0) {
            read_file("followed.txt", err, sizeof err);
            said = strstr(err, words);
        }
    }
    assert_true(said);
}

/* Its exit code, or minus the signal that ended it; 0: none is sent. */
static int end_following(pid_t child, int number)
{
    int status = 0;
    if (number)
        kill(child, number);
    assert_int_equal(waitpid(child, &status, 0), child);
    read_file("followed.txt", err, sizeof err);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

/* The command waits for the file, prints rows while it grows, and ends with the writer, however that ends. */
static void metrics_follow_a_recording_until_its_writer_ends(void **state)
{
    (void)state;
    static const struct {
        int number, writer, follower;
    } ends[] = {{SIGTERM, 4, 0}, {SIGKILL, -SIGKILL, 2}};
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        remove("grows.rlog");
        const pid_t follower = start_following("grows.rlog --columns step,max_speed");
        wait_for_words("waiting for grows.rlog, which does not exist yet");
        const pid_t writer = start("--steps 100000000 -o grows.rlog");
        wait_for_steps("rows.csv", 1);
        wait_for_steps("rows.csv", file_size("rows.csv") + 1); /* more rows, from another look */
        assert_int_equal(end_with(writer, ends[i].number), ends[i].writer);
        assert_int_equal(end_following(follower, 0), ends[i].follower);
        assert_true((strstr(err, "is truncated") != NULL) == (ends[i].follower == 2));
        run("metrics grows.rlog --columns step,max_speed >all.csv");
        assert_files_same("rows.csv", "all.csv");
    }
}

static void following_ends_with_a_whole_line_after_a_signal(void **state)
{
    (void)state;
    remove("grows.rlog");
    pid_t follower = start_following("grows.rlog");
    wait_for_words("waiting for grows.rlog");
    assert_int_equal(end_following(follower, SIGINT), 4);
    assert_int_equal(file_size("rows.csv"), 0);
    const pid_t writer = start("--steps 100000000 -o grows.rlog");
    wait_for_steps("grows.rlog", 100000);
    follower = start_following("grows.rlog");
    wait_for_steps("rows.csv", 100000);
    assert_int_equal(end_following(follower, SIGTERM), 4);
    assert_string_equal(err, "");
    size_t size;
    assert_int_equal(read_bytes("rows.csv", &size)[size - 1], '\n');
    assert_int_equal(end_with(writer, SIGTERM), 4);
}

static void following_a_complete_recording_prints_it(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("metrics a.rlog >all.csv"));
    assert_code(0, run("metrics --follow a.rlog >rows.csv"));
    assert_string_equal(err, "");
    assert_files_same("rows.csv", "all.csv");
    write_file("letter.txt", "a letter", 8);
    static const char *const refused[][2] = {
        {"a.rlog a.rlog", "--follow takes one recording; got 2"},
        {"a.rlog --columns step,max_sped", "did you mean \"max_speed\"?"},
        {"--list", "does not go with --follow"},
        {"letter.txt", "not a recording"},
        {".", "folder"},
    };
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
        assert_code(2, run("metrics --follow %s", refused[i][0]));
        assert_one_message(refused[i][1]);
    }
}

/* The last line of `run` and the doctor say the same of the same steps; a warning at the start is no verdict. */
static void run_and_doctor_agree(void **state)
{
    (void)state;
    static const struct {
        const char *set, *start; /* start: what is said before step 1 */
    } cases[] = {
        {"", NULL},
        {"--set fluid.linear_viscosity=2", NULL},
        {"--set gravity=[0,-20,0]", NULL},
        {"--set ball.velocity=[0,-60,0]", NULL},
        {"--set ball.velocity=[0,-400,0]", NULL},
        {"--set scheme=sequential", NULL},
        {"--set scheme=sequential --set springs.stiffness=37.5 --set history.stiffness=4000", NULL},
        {ILL, NULL},
        {ILL " --set settle.time=3", "warning: the run is unhealthy from its start: in step 0 start_speed is "},
        {RESTLESS, "warning: the run may go bad: in step 0 courant_number is "},
    };
    uint32_t ill = 0;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        run("run %s %s --steps 30 -o agree.rlog --force --quiet", scene, cases[i].set);
        const char *line = strstr(err, "rheolog: unhealthy since step ");
        const long since = line ? strtol(line + strlen("rheolog: unhealthy since step "), NULL, 10) : -1;
        const bool failed = strstr(err, "went bad");
        if (cases[i].start && json_scenes)
            assert_in(cases[i].start, err);
        run("doctor agree.rlog --json");
        const bool unhealthy = strcmp(value_of("verdict"), "\"unhealthy\"") == 0;
        if (unhealthy != (line || failed))
            fail_msg("%s: the run said %s; the doctor: %s", cases[i].set, err, out);
        if (line)
            assert_int_equal(strtol(value_of("unhealthy_step"), NULL, 10), since);
        ill += unhealthy;
        /* From its last state on. */
        run("run --from agree.rlog --steps 3 -o after.rlog --force --quiet");
        const bool from_start = strstr(err, "warning: the run is unhealthy from its start");
        line = strstr(err, "rheolog: unhealthy since step ");
        const bool worse = line || strstr(err, "went bad");
        assert_null(strstr(err, "ill state"));
        run("doctor after.rlog --json");
        if (strcmp(value_of("verdict"), worse ? "\"unhealthy\"" : "\"healthy\"") != 0 || (from_start && !worse))
            fail_msg("%s: the run said %s; the doctor: %s", cases[i].set, err, out);
    }
    assert_in_range(ill, 2, 7);
    /* A block that flies fast is a notice of the doctor, and a warning at the start. */
    static const char fast[] = "{\"scene\": \"fast\", \"gravity\": [0, 0, 0],\n"
                               " \"fluid\": {\"shapes\": [{\"block\": {\"min\": [0, 0, 0], \"max\": [6, 6, 6], "
                               "\"velocity\": [0, 0, 90]}}]}}\n";
    if (!json_scenes)
        return;
    write_file("fast.json", fast, sizeof fast - 1);
    assert_code(0, run("run fast.json --steps 5 -o agree.rlog --force --quiet"));
    assert_in("warning: the run may go bad: in step 0 courant_number is ", err);
    assert_null(strstr(err, "ill state"));
    assert_null(strstr(err, "unhealthy"));
    assert_code(0, run("doctor agree.rlog"));
    assert_in("agree.rlog: healthy: nothing severe in step 0 to 5", out);
    assert_in("  step 0      courant_number            0.", out);
}

/* ---- Sizes ---- */

/* The first line says the size that the recording has in the end, to two fifths; the last one says that exactly. */
static void the_size_is_told_before_and_after(void **state)
{
    (void)state;
    static const char *const options[] = {"--steps 300", "--steps 100 --keyframes 2", "--steps 30 --full",
                                          "--steps 60 --keyframes 10 --set history.window=40"};
    for (size_t i = 0; i < sizeof options / sizeof *options; i++) {
        assert_code(0, run("run %s %s -o size.rlog --force --json", scene, options[i]));
        const long bytes = file_size("size.rlog");
        assert_int_equal(strtol(value_of("bytes"), NULL, 10), bytes);
        const char *line = strstr(err, "the recording will have about ");
        assert_non_null(line);
        char *unit;
        double expected = strtod(line + strlen("the recording will have about "), &unit);
        expected *= strncmp(unit, " MB;", 4) == 0 ? 1e6 : strncmp(unit, " kB;", 4) == 0 ? 1e3 : NAN;
        if (!(expected < 1.4 * (double)bytes && expected > 0.7 * (double)bytes))
            fail_msg("%s: %g bytes expected, %ld made", options[i], expected, bytes);
    }
    char text[64];
    assert_code(0, run("run %s --steps 3 -o size.rlog --force --quiet", scene));
    snprintf(text, sizeof text, "recording   size.rlog, %.1f kB\n", (double)file_size("size.rlog") / 1000);
    assert_in(text, out);
    assert_string_equal(err, "");
}

/* ---- A limit of the size ---- */

static void a_bad_limit_is_refused(void **state)
{
    (void)state;
    static const char *const sizes[] = {"0",
                                        "-1",
                                        "1.5G",
                                        "10MB",
                                        "10 M",
                                        "K",
                                        "10m",
                                        "10Ki",
                                        "",
                                        "10X",
                                        "1e9",
                                        "1KB",
                                        "17592186044416M",
                                        "99999999999999999999"};
    remove("limit.rlog");
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        assert_code(2, run("run %s --steps 1 -o limit.rlog --max-size '%s'", scene, sizes[i]));
        assert_one_message("--max-size needs a size such as 500M or 20G");
        assert_in(sizes[i], err);
    }
    assert_code(2, run("run %s --steps 1 --max-size 5M", scene));
    assert_one_message("--max-size needs -o F.rlog");
    /* Below the first keyframe: the message says what is needed, and that is enough. */
    assert_code(2, run("run %s --steps 0 -o limit.rlog --max-size 100 --quiet", scene));
    assert_one_message("needs a limit of ");
    assert_int_equal(access("limit.rlog", F_OK), -1);
    const long least = strtol(strstr(err, "needs a limit of ") + strlen("needs a limit of "), NULL, 10);
    assert_code(0, run("run %s --steps 0 -o limit.rlog --max-size %ld --quiet", scene, least + 10));
    assert_true(file_size("limit.rlog") <= least + 10);
    static const struct {
        const char *text;
        double bytes;
    } right[] = {{"3000000", 3e6}, {"30000K", 30000. * 1024}, {"30MiB", 30. * 1048576}, {"2G", 2147483648.}};
    for (size_t i = 0; i < sizeof right / sizeof *right; i++) {
        assert_code(0,
                    run("run %s --steps 1 -o limit.rlog --force --max-size %s --json --quiet", scene, right[i].text));
        assert_true(strtod(value_of("max_size"), NULL) == right[i].bytes);
        assert_string_equal(value_of("keyframes_left_out"), "0");
    }
}

/* Says before and after what the limit does; the whole run can be verified, and compared with one without a limit. */
static void a_limited_run_says_what_it_leaves_out(void **state)
{
    (void)state;
    assert_code(0, run("run %s --steps 400 --keyframes 5 -o whole.rlog --force --json", scene));
    char hash[32];
    snprintf(hash, sizeof hash, "%s", value_of("hash"));
    assert_string_equal(value_of("max_size"), "null");
    const long whole = file_size("whole.rlog"), limit = whole / 2;
    assert_code(0, run("run %s --steps 400 --keyframes 5 -o limit.rlog --force --max-size %ld --json", scene, limit));
    assert_in("the recording would have about ", err);
    assert_in("keyframes will be left out for --max-size", err);
    assert_string_equal(value_of("hash"), hash);
    assert_int_equal(strtol(value_of("max_size"), NULL, 10), limit);
    const long spacing = strtol(value_of("keyframe_spacing"), NULL, 10),
               left_out = strtol(value_of("keyframes_left_out"), NULL, 10);
    assert_true(spacing >= 10);
    assert_true(file_size("limit.rlog") <= limit);
    assert_code(0, run("info limit.rlog --json"));
    assert_int_equal(strtol(value_of("keyframes"), NULL, 10), 81 - left_out);
    assert_int_equal(strtol(value_of("keyframe_spacing"), NULL, 10), spacing);
    assert_in("--max-size", out); /* how it was made */
    assert_code(0, run("verify limit.rlog"));
    assert_code(0, run("diff limit.rlog whole.rlog"));
    assert_code(0,
                run("run %s --steps 400 --keyframes 5 -o limit.rlog --force --max-size %ld --quiet", scene, limit));
    assert_in(" were left out for --max-size\n", out);
    assert_string_equal(err, "");
}

/* The run ends before the step that does not fit, and nothing counts it. With a larger limit the run goes on. */
static void a_step_that_does_not_fit_is_not_counted(void **state)
{
    (void)state;
    assert_code(0, run("run %s --steps 300 --keyframes 50 -o whole.rlog --force --quiet", scene));
    assert_code(0, run("run %s --steps 100 --keyframes 100 -o limit.rlog --force --quiet", scene));
    const long limit = file_size("limit.rlog");
    assert_code(1,
                run("run %s --steps 300 --keyframes 50 -o limit.rlog --force --max-size %ld --json", scene, limit));
    assert_in("will end the run early", err);
    assert_in("the recording ends with step ", err);
    assert_in("larger --max-size goes on", err);
    assert_string_equal(value_of("outcome"), "\"limit\"");
    assert_string_equal(value_of("healthy"), "true");
    const long steps = strtol(value_of("steps"), NULL, 10);
    char hash[32];
    snprintf(hash, sizeof hash, "%s", value_of("hash"));
    assert_int_equal(strtol(value_of("step"), NULL, 10), steps);
    assert_true(file_size("limit.rlog") <= limit);
    assert_code(0, run("info limit.rlog --json"));
    assert_string_equal(value_of("complete"), "true");
    assert_int_equal(strtol(value_of("steps"), NULL, 10), steps);
    rheo_world *last = checkpoint_at("limit.rlog", (int)steps);
    char text[32];
    snprintf(text, sizeof text, "\"%016llx\"", (unsigned long long)rheo_world_hash(last));
    assert_string_equal(text, hash);
    rheo_world_destroy(last);
    assert_code(0, run("run %s --steps 300 --keyframes 50 -o limit.rlog --continue --max-size 1G --quiet", scene));
    assert_code(0, run("diff limit.rlog whole.rlog"));
}

/* However often a limited run is ended or finds the disk full, it becomes the file of one that was not. */
static void a_limited_run_that_is_ended_again_and_again_ends_with_the_same_bytes(void **state)
{
    (void)state;
    static const char *const options[] = {"--steps 900 --keyframes 5", "--steps 200 --keyframes 5 --full"};
    static const int signals[] = {SIGKILL, SIGTERM, SIGKILL, SIGKILL, SIGKILL};
    for (size_t n = 0; n < 2; n++) {
        char arguments[256];
        assert_code(0, run("run %s %s -o whole.rlog --force --quiet", scene, options[n]));
        const long limit = file_size("whole.rlog") / 4 * (n ? 3 : 1);
        assert_code(0, run("run %s %s -o whole.rlog --max-size %ld --force --quiet", scene, options[n], limit));
        snprintf(arguments, sizeof arguments, "%s --max-size %ld -o pieces.rlog --continue", options[n], limit);
        remove("pieces.rlog");
        for (int i = 0; i < 15; i++) { /* when it thins, too: the longest part of a short run */
            const pid_t child = start(arguments);
            for (int w = 0; w <= i % 4 * 2; w++)
                wait_a_little();
            end_with(child, signals[i % 5]);
            if (file_size("pieces.rlog") > 0)
                assert_true(file_size("pieces.rlog") <= limit);
        }
        for (int part = 1; part < 4; part++) { /* a full disk */
            char command[4096];
            snprintf(command, sizeof command,
                     "trap '' XFSZ; ulimit -f %ld; exec \"$RHEOLOG\" run %s %s --quiet >out.txt 2>err.txt",
                     limit / 512 * part / 4 + 1, scene, arguments);
            const int status = system(command);
            assert_true(WIFEXITED(status) && (WEXITSTATUS(status) == 3 || WEXITSTATUS(status) == 0));
        }
        assert_code(0, run("run %s %s --quiet", scene, arguments));
        assert_files_same("pieces.rlog", "whole.rlog");
        assert_int_equal(access("pieces.rlog.thinning", F_OK), -1);
        assert_code(0, run("verify pieces.rlog"));
    }
}

/* A new file may be within its first keyframe, so a head that cannot be read is looked at eight times, 250 ms apart. */
static void following_gives_up_a_head_that_stays_damaged(void **state)
{
    (void)state;
    size_t size;
    struct timespec begin, end;
    record("a.rlog");
    unsigned char *bytes = (unsigned char *)read_bytes("a.rlog", &size);
    bytes[40] ^= 1;
    write_file("damaged.rlog", (const char *)bytes, size);
    clock_gettime(CLOCK_MONOTONIC, &begin);
    assert_code(2, run("metrics --follow damaged.rlog >rows.csv"));
    clock_gettime(CLOCK_MONOTONIC, &end);
    assert_one_message("damaged.rlog");
    assert_int_equal(file_size("rows.csv"), 0);
    assert_true((double)(end.tv_sec - begin.tv_sec) + 1e-9 * (double)(end.tv_nsec - begin.tv_nsec) >= 7 * 0.25);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_second_writer_on_a_file_is_refused),
        cmocka_unit_test(a_signal_closes_the_file_and_has_its_own_exit_code),
        cmocka_unit_test(the_json_of_a_failed_run_says_why),
        cmocka_unit_test(a_signal_that_comes_twice_at_once_is_one),
        cmocka_unit_test(a_run_that_is_killed_again_and_again_ends_with_the_same_bytes),
        cmocka_unit_test(a_run_that_filled_the_disk_is_continued),
        cmocka_unit_test(another_run_is_not_continued),
        cmocka_unit_test(a_run_from_a_recording_is_continued),
        cmocka_unit_test(an_unhealthy_run_says_so_in_its_last_line),
        cmocka_unit_test(a_scene_that_starts_ill_warns),
        cmocka_unit_test(metrics_follow_a_recording_until_its_writer_ends),
        cmocka_unit_test(following_ends_with_a_whole_line_after_a_signal),
        cmocka_unit_test(following_a_complete_recording_prints_it),
        cmocka_unit_test(following_gives_up_a_head_that_stays_damaged),
        cmocka_unit_test(run_and_doctor_agree),
        cmocka_unit_test(the_size_is_told_before_and_after),
        cmocka_unit_test(a_bad_limit_is_refused),
        cmocka_unit_test(a_limited_run_says_what_it_leaves_out),
        cmocka_unit_test(a_step_that_does_not_fit_is_not_counted),
        cmocka_unit_test(a_limited_run_that_is_ended_again_and_again_ends_with_the_same_bytes),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
