/* Long runs from outside: two writers on one file, files that are being written, signals. */
#define _XOPEN_SOURCE 700 /* kill(), nanosleep() */
#include "cli_support.h"

#include <signal.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static void wait_a_little(void)
{
    const struct timespec pause = {0, 20000000};
    nanosleep(&pause, NULL);
}

/* Starts `rheolog run SCENE ARGUMENTS` beside the test. Its output goes to out.txt and err.txt. */
static pid_t start(const char *arguments)
{
    char command[4096];
    snprintf(command, sizeof command, "exec \"$RHEOLOG\" run %s %s --quiet >out.txt 2>err.txt", scene, arguments);
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        execl("/bin/sh", "sh", "-c", command, (char *)NULL);
        _exit(127);
    }
    return child;
}

/* Waits until a recording has some steps: its signal handlers are installed then. */
static void wait_for_steps(const char *path, long bytes)
{
    for (int i = 0; i < 3000 && file_size(path) < bytes; i++)
        wait_a_little();
    assert_true(file_size(path) >= bytes);
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
    assert_in("no: it is being written", out);
    assert_in("is being written: ", err);
    assert_in(" steps so far", err);
    assert_code(0, beside("info twice.rlog --json"));
    assert_string_equal(value_of("being_written"), "true");
    beside("doctor twice.rlog");
    assert_in("is being written: ", err);
    assert_code(2, beside("verify twice.rlog"));
    assert_in("being written", out);
    assert_null(strstr(out, "truncated"));
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
    static const int signals[] = {SIGHUP, SIGTERM, SIGINT};
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++) {
        remove("ended.rlog");
        const pid_t child = start("--steps 100000000 --json --set fluid.stiffness=250 -o ended.rlog");
        wait_for_steps("ended.rlog", 200000);
        assert_code(4, end_with(child, signals[i]));
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_second_writer_on_a_file_is_refused),
        cmocka_unit_test(a_signal_closes_the_file_and_has_its_own_exit_code),
        cmocka_unit_test(the_json_of_a_failed_run_says_why),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
