/* `rheolog run` from outside: keys of its JSON, recordings, checkpoints, commands and interruptions. */
#define _XOPEN_SOURCE 700 /* kill(), nanosleep() */
#include "cli_support.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* ---- run ---- */

static void run_has_its_keys(void **state)
{
    (void)state;
    static const char *const keys[] = {"scene",
                                       "model",
                                       "particles",
                                       "steps",
                                       "time",
                                       "hash",
                                       "ns_per_particle_step",
                                       "neighbours",
                                       "springs",
                                       "history_bytes",
                                       "stages",
                                       "name",
                                       "creation_seconds",
                                       NULL};
    assert_code(0, run("run %s --steps 3 --json", scene));
    assert_keys(out, keys);
    assert_string_equal(value_of("steps"), "3");
    assert_string_equal(value_of("model"), "\"thickening\"");
    assert_int_equal(strlen(value_of("hash")), 18);
    char hash[32];
    snprintf(hash, sizeof hash, "%s", value_of("hash"));
    assert_code(0, run("run %s --steps=3 --quiet", scene));
    assert_null(strstr(out, "ns/p/step")); /* quiet: the result without the table of stages */
    assert_string_equal(err, "");
    hash[17] = 0;
    assert_in(hash + 1, out);
    assert_code(0, run("run %s --steps=3", scene));
    assert_in("viscosity", out);
    assert_code(0, run("run %s --steps 0 --json", scene));
    assert_string_equal(value_of("ns_per_particle_step"), "0.000");
    assert_string_equal(value_of("bytes"), "null");
    char bytes[32];
    assert_code(0, run("run %s --steps 3 --json -o size.rlog --force", scene));
    snprintf(bytes, sizeof bytes, "%ld", (long)file_size("size.rlog"));
    assert_string_equal(value_of("bytes"), bytes);
}

static void an_empty_scene_runs(void **state)
{
    (void)state;
    if (!json_scenes)
        skip();
    write_file("empty.json", "{}", 2);
    assert_code(0, run("run ./empty.json --steps 2 --json -o nothing.rlog"));
    assert_string_equal(value_of("scene"), "\"empty\"");
    assert_string_equal(value_of("particles"), "0");
    assert_string_equal(value_of("ns_per_particle_step"), "0.000");
    assert_string_equal(value_of("neighbours"), "0");
    assert_null(strstr(out, "nan"));
    assert_code(0, run("run empty.json --steps 2"));
    assert_null(strstr(out, "nan"));
    assert_code(0, run("verify nothing.rlog"));
    assert_code(0, run("info nothing.rlog"));
    assert_null(strstr(out, "nan"));
}

static void a_bad_scene_file_is_reported(void **state)
{
    (void)state;
    if (!json_scenes)
        skip();
    write_file("bad.json", "{\n\"fluid\": {\n\"suport\": 3}}", 26);
    assert_code(2, run("run bad.json"));
    assert_one_message("bad.json:3: fluid.suport: ");
    write_file("cut.json", tiny, 40);
    assert_code(2, run("run cut.json"));
    assert_one_message("cut.json:");
}

/* The path of a mesh is relative to the folder of the scene. A faulty mesh is bad input. */
static void a_mesh_path_is_relative_to_its_scene(void **state)
{
    (void)state;
    if (!json_scenes)
        skip();
    static const char mesh_scene[] =
        "{\"fluid\": {\"shapes\": [{\"mesh\": {\"file\": \"box.obj\", \"height\": 8}}]}}";
    static const char box[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
                              "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 4 1 5 8\n";
    mkdir("folder", 0777);
    write_file("folder/mesh.json", mesh_scene, sizeof mesh_scene - 1);
    remove("folder/box.obj");
    assert_code(2, run("run folder/mesh.json"));
    assert_one_message("folder/mesh.json: shape 0: cannot read the mesh folder/box.obj: ");
    write_file("folder/box.obj", box, sizeof box - 1);
    assert_code(0, run("run folder/mesh.json --steps 2 --json"));
    assert_string_equal(value_of("particles"), "64");
    assert_code(0, run("run folder/mesh.json --steps 2 --json --set particles=1000"));
    assert_string_equal(value_of("particles"), "1000");
    write_file("folder/box.obj", box, sizeof box - 1 - 10);
    assert_code(2, run("run folder/mesh.json"));
    assert_one_message("folder/box.obj: the mesh is not closed: 4 open edges around 1 hole");
    assert_code(2, run("run bowling-ball-small --set model=melting"));
    assert_one_message("model cannot be set");
    assert_code(2, run("run bowling-ball-small --set melting.viscosity=1"));
    assert_one_message("of the model melting");
}

static void written_scenes_run_the_same(void **state)
{
    (void)state;
    if (!json_scenes)
        skip();
    assert_code(0, run("run tiny.json --set fluid.stiffness=250 --set seed=5 --set ball.position=[4,15,5] "
                       "--steps 6 --write-scene >again.json"));
    char hash[32];
    assert_code(0, run("run again.json --json"));
    assert_string_equal(value_of("steps"), "6");
    snprintf(hash, sizeof hash, "%s", value_of("hash"));
    assert_code(0, run("run tiny.json --set=fluid.stiffness=250 --set seed=5 --set ball.position=[4,15,5] --steps 6 "
                       "--json"));
    assert_string_equal(value_of("hash"), hash);
    assert_code(0, run("run tiny.json --steps 6 --json"));
    assert_string_not_equal(value_of("hash"), hash);
    /* A given position replaces the built-in scene's position above the surface. */
    assert_code(0, run("run bowling-ball-small --set ball.position=[1,2,3] --write-scene"));
    assert_string_equal(value_of("clearance"), "-1");
    assert_code(0, run("run bowling-ball-small --write-scene"));
    assert_string_not_equal(value_of("clearance"), "-1");
}

static void recording_changes_nothing(void **state)
{
    (void)state;
    record("a.rlog");
    char hash[32];
    snprintf(hash, sizeof hash, "%s", value_of("hash"));
    assert_string_equal(value_of("file"), "\"a.rlog\"");
    assert_code(0, run("run %s --steps 8 --json", scene));
    assert_string_equal(value_of("hash"), hash);
    assert_code(0, run("run %s --steps 8 --json --full --keyframes 3 -oc.rlog", scene));
    assert_string_equal(value_of("hash"), hash);
    assert_code(0, run("verify a.rlog c.rlog"));
    assert_in("a.rlog: same", out);
    assert_in("c.rlog: same", out);
}

static void files_are_not_replaced_without_force(void **state)
{
    (void)state;
    record("a.rlog");
    record("mine.rlog");
    const long mine = file_size("mine.rlog");
    assert_code(2, run("run %s --steps 1 -o mine.rlog", scene));
    assert_one_message("--force");
    assert_code(2, run("checkpoint a.rlog --step 1 -o mine.rlog"));
    assert_one_message("--force");
    assert_int_equal(file_size("mine.rlog"), mine);
    assert_code(0, run("checkpoint a.rlog --step 1 -o mine.rlog --force"));
    assert_code(0, run("verify mine.rlog"));
    assert_code(0, run("run %s --steps 1 -o mine.rlog --force", scene));
    assert_code(0, run("verify mine.rlog"));
    /* A recording that is being read must not be written. */
    const long size = file_size("a.rlog");
    assert_code(2, run("run --from a.rlog@2 --steps 1 -o ./a.rlog --force"));
    assert_int_equal(file_size("a.rlog"), size);
}

/* The temporary file has a longer name, which a file system must take, too. */
static void a_long_name_is_refused(void **state)
{
    (void)state;
    for (int length = 200; length <= 201; length++) {
        assert_code(length > 200 ? 2 : 0, run("run %s --steps 1 --quiet -o %0*d", scene, length, 0));
        if (length > 200)
            assert_one_message("the name after -o is too long: 201 bytes");
    }
}

static void runs_continue_from_any_step(void **state)
{
    (void)state;
    record("a.rlog");
    char hash[32];
    snprintf(hash, sizeof hash, "%s", value_of("hash"));
    assert_code(0, run("checkpoint a.rlog --step 3 -o c3.rlog --force"));
    assert_code(0, run("run --from c3.rlog --steps 5 --json"));
    assert_string_equal(value_of("hash"), hash);
    assert_string_equal(value_of("step"), "8");
    assert_string_equal(value_of("steps"), "5");
    assert_code(0, run("run --from a.rlog@6 --steps 2 --json -o rest.rlog --force"));
    assert_string_equal(value_of("hash"), hash);
    assert_code(0, run("verify rest.rlog"));
    assert_code(0, run("run --from a.rlog --steps 0 --json"));
    assert_string_equal(value_of("hash"), hash);
    assert_code(2, run("run --from a.rlog@9 --steps 1"));
    assert_one_message("0 to 8");
    assert_code(2, run("checkpoint a.rlog --step 9 -o c9.rlog"));
    assert_one_message("0 to 8");
}

static void changes_after_from_are_recorded(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("run --from a.rlog@4 --steps 4 --json"));
    char hash[32];
    snprintf(hash, sizeof hash, "%s", value_of("hash"));
    assert_code(0, run("run --from a.rlog@4 --steps 4 --json --set gravity=[0,-20,0] -o changed.rlog --force"));
    assert_string_not_equal(value_of("hash"), hash);
    snprintf(hash, sizeof hash, "%s", value_of("hash"));
    assert_code(0, run("verify changed.rlog"));
    assert_code(0, run("run --from changed.rlog --steps 0 --json"));
    assert_string_equal(value_of("hash"), hash);
    /* A fixed parameter is refused before a file is made. */
    static const char *const cases[] = {"ball.radius=3", "settle.time=1", "fluid.suport=3", "gravity=down",
                                        "gravity"};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_code(2, run("run --from a.rlog@4 --steps 4 --set %s -o never.rlog", cases[i]));
        assert_one_message("");
        assert_int_equal(file_size("never.rlog"), -1);
    }
}

static void a_failed_run_leaves_a_valid_recording(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("info a.rlog --json"));
    if (strcmp(value_of("real_bytes"), "4") != 0)
        skip(); /* no parameter value is large enough to overflow doubles */
    assert_code(
        1,
        run("run %s --steps 50 --set step=1e5 --set fluid.stiffness=1e29 -o bad.rlog --force --json --quiet", scene));
    assert_in("rheolog: ", err);
    assert_string_equal(value_of("outcome"), "\"failed\"");
    assert_code(0, run("verify bad.rlog"));
    assert_code(0, run("info bad.rlog --json"));
    assert_string_equal(value_of("complete"), "true");
}

static void an_interrupted_run_leaves_a_valid_recording(void **state)
{
    (void)state;
    char command[4096];
    snprintf(command, sizeof command,
             "exec \"$RHEOLOG\" run %s --steps 100000000 -o long.rlog --quiet --json >out.txt 2>err.txt", scene);
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        signal(SIGINT, SIG_DFL); /* a shell ignores it in its background, and then the program does */
        execl("/bin/sh", "sh", "-c", command, (char *)NULL);
        _exit(127);
    }
    /* The file grows past its initial state only after the signal handlers are installed. */
    const struct timespec pause = {0, 20000000};
    for (int i = 0; i < 1500 && file_size("long.rlog") <= 0; i++)
        nanosleep(&pause, NULL);
    for (int i = 0; i < 10; i++)
        nanosleep(&pause, NULL);
    kill(child, SIGINT);
    int status = 0;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 4);
    read_file("out.txt", out, sizeof out);
    read_file("err.txt", err, sizeof err);
    assert_string_equal(value_of("outcome"), "\"interrupted\"");
    assert_in("interrupted after", err);
    assert_in(" of 100000000 steps", err);
    assert_code(0, run("info long.rlog --json"));
    assert_string_equal(value_of("complete"), "true");
}

/* Regression: the first signal was kept for the steps, and the wait for the scene went on. */
static void a_signal_ends_the_wait_for_a_scene_from_a_pipe(void **state)
{
    (void)state;
    const struct timespec pause = {0, 20000000};
    assert_int_equal(mkfifo("pipe.json", 0600), 0);
    for (int opened = 0; opened < 2; opened++) { /* nobody writes yet; somebody does, but not to the end */
        const pid_t child = fork();
        assert_true(child >= 0);
        if (child == 0) {
            execl("/bin/sh", "sh", "-c", "exec \"$RHEOLOG\" run pipe.json --quiet >out.txt 2>err.txt", (char *)NULL);
            _exit(127);
        }
        int writer = -1;
        if (opened) /* possible once there is a reader */
            for (int i = 0; i < 500 && (writer = open("pipe.json", O_WRONLY | O_NONBLOCK)) < 0; i++)
                nanosleep(&pause, NULL);
        for (int i = 0; i < 15; i++)
            nanosleep(&pause, NULL);
        kill(child, SIGTERM);
        int status = 0, ended = 0;
        for (int i = 0; i < 500 && !ended; i++) {
            ended = waitpid(child, &status, WNOHANG) == child;
            nanosleep(&pause, NULL);
        }
        if (!ended) {
            kill(child, SIGKILL);
            waitpid(child, &status, 0);
        }
        close(writer);
        assert_true(ended);
        assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM);
    }
    remove("pipe.json");
}

/* A limit on file size replaces a full disk. */
static void a_full_disk_leaves_a_readable_recording(void **state)
{
    (void)state;
    char command[4096];
    long before = 0;
    assert_code(0, run("run %s --steps 2 --full -o whole.rlog --force --quiet", scene));
    for (int more = 1; more <= 5; more++) { /* within the first keyframe, and at several offsets after it */
        snprintf(command, sizeof command,
                 "trap '' XFSZ; ulimit -f %ld; exec \"$RHEOLOG\" run %s --steps 1000 --full -o full.rlog --force "
                 "--quiet >out.txt 2>err.txt",
                 file_size("whole.rlog") / 512 * more / 3 + 1, scene);
        const int status = system(command);
        read_file("out.txt", out, sizeof out);
        read_file("err.txt", err, sizeof err);
        assert_true(WIFEXITED(status));
        assert_code(3, WEXITSTATUS(status));
        assert_in("cannot write", err);
        assert_code(2, run("verify full.rlog --json"));
        assert_string_equal(value_of("verdict"), "\"unreadable\"");
        const long steps = strtol(value_of("steps"), NULL, 10);
        assert_true(steps >= before && (more < 5 || steps >= 2));
        before = steps;
        assert_code(2, run("verify full.rlog"));
        assert_in("truncated", out);
        if (steps >= 2) /* the valid part can be continued */
            assert_code(0, run("run --from full.rlog@%ld --steps 1 --quiet", steps));
    }
    if (access("/dev/full", W_OK) != 0)
        return;
    assert_code(3, run("run %s --steps 2 -o /dev/full --force --quiet", scene));
    assert_in("cannot write", err);
}

/* A log gets no lines that are written over: a terminal would get them after a fifth of a second. */
static void a_file_gets_no_codes_of_a_terminal(void **state)
{
    (void)state;
    assert_code(0, run("run bowling-ball-small --set particles=500 --set settle.time=0 --steps 6000"));
    assert_in("expected: kappa", err);
    assert_null(strchr(err, '\r'));
    assert_null(strchr(err, '\033'));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(run_has_its_keys),
        cmocka_unit_test(an_empty_scene_runs),
        cmocka_unit_test(a_file_gets_no_codes_of_a_terminal),
        cmocka_unit_test(a_bad_scene_file_is_reported),
        cmocka_unit_test(a_mesh_path_is_relative_to_its_scene),
        cmocka_unit_test(written_scenes_run_the_same),
        cmocka_unit_test(recording_changes_nothing),
        cmocka_unit_test(files_are_not_replaced_without_force),
        cmocka_unit_test(a_long_name_is_refused),
        cmocka_unit_test(runs_continue_from_any_step),
        cmocka_unit_test(changes_after_from_are_recorded),
        cmocka_unit_test(a_failed_run_leaves_a_valid_recording),
        cmocka_unit_test(an_interrupted_run_leaves_a_valid_recording),
        cmocka_unit_test(a_signal_ends_the_wait_for_a_scene_from_a_pipe),
        cmocka_unit_test(a_full_disk_leaves_a_readable_recording),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
