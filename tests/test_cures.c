/*
 * Every cure that `rheolog doctor` prints works: each sick scene is diagnosed, each command that the doctor prints for
 * it is given to a shell as printed, and the run that it makes must be healthy. CURED steps at least are run.
 */
#define _XOPEN_SOURCE 700 /* setenv(), popen() */
#include "cli_support.h"

#include <libgen.h>
#include <sys/wait.h>

enum { CURED = 50 };

static char text[1 << 16], command[8192];

/* ---- Sick scenes ---- */

static const char POOL[] =
    "{\"scene\": \"pool\", \"steps\": 120, \"settle\": {\"time\": 1},\n"
    "\"fluid\": {\"shapes\": [{\"block\": {\"min\": [0, 0, 0], \"max\": [16, 12, 16], "
    "\"jitter\": 0.1}}]},\n"
    "\"walls\": {\"boxes\": [{\"min\": [0, 0, 0], \"max\": [16, 30, 16], \"open\": [\"top\"]}]},\n"
    "\"history\": {\"window\": 20},\n"
    "\"ball\": {\"radius\": 4, \"position\": [8, 18, 8], \"velocity\": [0, -8, 0]}}\n";

static const char OVERLAP[] =
    "{\"scene\": \"overlap\", \"steps\": 30,\n"
    "\"fluid\": {\"shapes\": [{\"block\": {\"min\": [0, 0, 0], \"max\": [16, 12, 16]}}, "
    "{\"block\": {\"min\": [0.3, 0.3, 0.3], \"max\": [12.3, 8.3, 12.3]}}]},\n"
    "\"walls\": {\"boxes\": [{\"min\": [0, 0, 0], \"max\": [16, 30, 16], \"open\": [\"top\"]}]}}\n";

typedef struct sick {
    const char *options; /* of `rheolog run`; the name of the recording is appended */
    const char *measure; /* of the cause, or NULL */
    const char *first;   /* of the advice, or "" */
    int cures;           /* number of commands that the doctor prints */
    const char *says;    /* a part of the diagnosis */
} sick;

#define SEQUENTIAL "pool.json --set scheme=sequential "
#define BALL "bowling-ball-small --set particles=1500 --steps 40 "
#define MELTING "melting-box --set fluid.spacing=0.12 --steps 60 "

static const sick SICK[] = {
    {SEQUENTIAL "--set fluid.stiffness=900", "pressure_number", "step=0.018", 2, "make"},
    {SEQUENTIAL "--set step=0.09", "pressure_number", "step=0.032", 1,
     "it was ill from the start, so the scene blew up while it was made, before step 0"},
    {"pool.json --set substeps=2 --set step=0.09", "pressure_number", "substeps=0", 1, "ill from the start"},
    {SEQUENTIAL "--set 'ball.velocity=[0, -400, 0]'", "ball_speed", "step=", 1, "stage ball"},
    {"pool.json --set 'ball.velocity=[0, -400, 0]'", "ball_speed", "step=", 1, "stage ball"},
    {SEQUENTIAL "--set history.stiffness=5000 --set history.onset=0", "stiffness_number", "springs.solver=implicit",
     3, "spring"},
    {SEQUENTIAL "--set ball.density_ratio=1000 --set history.stiffness=2000", "stiffness_number",
     "springs.solver=implicit", 3, "spring"},
    /* So stiff that it broke before the fluid moved: the numbers were those of no motion, and did not help. */
    {BALL "--set scheme=sequential --set history.stiffness=1e12", "stiffness_number", "springs.solver=implicit", 1,
     "spring"},
    {BALL "--set scheme=sequential --set history.stiffness=1e5", "stiffness_number", "springs.solver=implicit", 1,
     "spring"},
    {SEQUENTIAL "--set springs.plasticity=100", "plasticity_number", "springs.plasticity=", 2, "rest lengths"},
    /* So stiff that more substeps do not help, that settling throws everything apart, or would take too long. */
    {"pool.json --set fluid.stiffness=1e5", "pressure_number", "step=0.0089", 2, "ill from the start"},
    {"pool.json --set fluid.stiffness=4.35e5", "pressure_number", "step=0.0042", 2, "ill from the start"},
    {BALL "--set fluid.stiffness=5e4", "speed_jump", "", 1, "ill from the start"},
    {BALL "--set fluid.stiffness=1e12", "pressure_number", "fluid.stiffness=7300", 1, "runaway_speed is "},
    {BALL "--set fluid.near_stiffness=1e8", "near_pressure_number", "step=0.00087", 2, "ill from the start"},
    {BALL "--set fluid.near_stiffness=1e12", "near_pressure_number", "fluid.near_stiffness=70000", 1,
     "runaway_speed is "},
    {BALL "--set scheme=sequential --set fluid.stiffness=1e12", "pressure_number", "fluid.stiffness=290", 1,
     "ill from the start"},
    {"overlap.json --set scheme=sequential", "max_pressure_displacement", "", 1, "step 1"},
    {"vibration --steps 30 --set scheme=sequential --set vibrators.amplitude=30", "vibrator_speed",
     "vibrators.amplitude=", 1, "vibrators"},
    {"vibration --steps 30 --set vibrators.amplitude=60", "vibrator_speed", "vibrators.amplitude=", 1, "vibrators"},
    {MELTING "--set melting.sound_speed=0.8", "max_density_error", "melting.sound_speed=", 1, "density"},
    {MELTING "--set step=0.2 --set melting.substeps=1", "substep_courant_number", "melting.substeps=0", 2, "sound"},
    {MELTING "--set melting.courant_number=4 --set step=0.2", "substep_courant_number", "melting.courant_number=", 1,
     "sound"},
    {MELTING "--set melting.solver=explicit --set melting.substeps=4 --set melting.viscosity=3 "
             "--set melting.rheology=newtonian",
     "viscous_number", "melting.solver=implicit", 3, "viscosity"},
    {MELTING "--set 'gravity=[0, -500, 0]'", "mach_number", "melting.sound_speed=", 1, "momentum"},
    {MELTING "--set melting.max_substeps=1", NULL, "melting.max_substeps=", 1, "substeps"},
    {MELTING "--set melting.substeps=1 --set melting.diffusivity=1 --set melting.flow=frozen --steps 200",
     "heat_number", "melting.substeps=0", 2, "heat"},
};

/* ---- Following the doctor ---- */

/* Gives a line to a shell in which `rheolog` is the program. */
static int shell(const char *line)
{
    char redirected[sizeof command + 64];
    snprintf(redirected, sizeof redirected, "{ %s; } >shell.txt 2>&1", line);
    const int status = system(redirected);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

static long last_step(const char *name)
{
    assert_code(0, run("info %s --json", name));
    return atol(value_of("last_step"));
}

/* The lines that begin with four blanks below "what helps" are the commands. */
static const char *next_command(const char *from)
{
    const char *line = strstr(from, "\n    rheolog ");
    if (!line)
        return NULL;
    snprintf(command, sizeof command, "%.*s", (int)strcspn(line + 5, "\n"), line + 5);
    return line + 5;
}

/* Follows each command that the doctor prints for sick.rlog. Returns their number. */
static int follow_all(const char *what)
{
    assert_code(1, run("doctor sick.rlog --json"));
    const char *sign = strstr(out, "\"sign_step\": ");
    assert_non_null(sign);
    const long first_sign = atol(sign + 13);
    assert_code(1, run("doctor sick.rlog"));
    snprintf(text, sizeof text, "%.60000s", out);
    int count = 0;
    for (const char *at = text; (at = next_command(at)) != NULL; count++) {
        remove("cured.rlog");
        if (shell(command) != 0)
            fail_msg("%s: does not run: %s", what, command);
        if (last_step("cured.rlog") < first_sign + CURED)
            fail_msg("%s: ends before %d steps after the sign: %s", what, CURED, command);
        if (run("doctor cured.rlog") != 0)
            fail_msg("%s: does not help: %s\n%s\n%s", what, command, out, text);
    }
    return count;
}

static void every_printed_cure_works(void **state)
{
    (void)state;
    if (!json_scenes)
        skip();
    write_file("pool.json", POOL, strlen(POOL));
    write_file("overlap.json", OVERLAP, strlen(OVERLAP));
    for (size_t i = 0; i < sizeof SICK / sizeof *SICK; i++) {
        const sick *s = &SICK[i];
        run("run %s -o sick.rlog --force --quiet", s->options);
        if (run("doctor sick.rlog --json") != 1)
            fail_msg("%s: is not sick: %s", s->options, out);
        char measure[64];
        snprintf(measure, sizeof measure, "\"measure\": \"%s\"", s->measure ? s->measure : "");
        if (s->measure)
            assert_in(measure, out);
        const char *first = strstr(out, "\"set\": \"");
        assert_non_null(first);
        if (strncmp(first + 8, s->first, strlen(s->first)) != 0)
            fail_msg("%s: %s is not the first advice: %s", s->options, s->first, out);
        const int cures = follow_all(s->options);
        if (cures != s->cures)
            fail_msg("%s: %d cures: %s", s->options, cures, text);
        assert_in(s->says, text);
    }
}

/* ---- What was done is the cause ---- */

/* Runs the pool for 80 steps as base.rlog. */
static void run_base(const char *options)
{
    write_file("pool.json", POOL, strlen(POOL));
    assert_code(0, run("run pool.json %s --steps 80 -o base.rlog --force --quiet", options));
}

static void a_parameter_that_was_set_is_named_first(void **state)
{
    (void)state;
    if (!json_scenes)
        skip();
    run_base("--set scheme=sequential");
    run("run --from base.rlog --set 'gravity=[0, -300, 0]' --steps 60 -o sick.rlog --force --quiet");
    assert_int_equal(follow_all("gravity"), 2);
    assert_int_equal(strncmp(text, "sick.rlog: unhealthy: gravity was set to [0, -300, 0] before step 81, ", 70), 0);
    assert_in(" steps before the first sign; step ", text);
    assert_in("  without the command before step 81\n    rheolog run --from sick.rlog@80 --steps ", text);
    assert_in(" --set 'gravity=[0, -300, 0]' --set step=", text); /* the command is given again */
    /* Names that a shell would take apart, and the name that cures have. */
    rename("sick.rlog", "my run.rlog");
    assert_code(1, run("doctor 'my run.rlog'"));
    assert_in("rheolog run --from 'my run.rlog@80' --steps ", out);
    rename("my run.rlog", "cured.rlog");
    assert_code(1, run("doctor cured.rlog"));
    assert_in("rheolog run --from cured.rlog@80 --steps 100 -o cured-2.rlog --force\n", out);
    run("run --from base.rlog --set fluid.stiffness=1500 --steps 60 -o sick.rlog --force --quiet");
    assert_int_equal(follow_all("stiffness"), 3);
    assert_in("unhealthy: fluid.stiffness was set to 1500 before step 81, which has the first sign; step 81, ", text);
    /* The ball was stopped within the step, so it was faster than the way that it came tells. */
    run("run --from base.rlog --set 'ball.velocity=[0, -1720, 0]' --steps 60 -o sick.rlog --force --quiet");
    assert_int_equal(follow_all("velocity"), 2);
    assert_in("ball_stop", text);
}

/* Continues base.rlog in a program, with a command that the command line does not have. */
static void continue_base(void (*give)(rheo_world *world))
{
    rheo_error error = {""};
    rheo_recording *recording = NULL;
    rheo_recorder *recorder = NULL;
    rheo_world *world = NULL;
    if (rheo_recording_open("base.rlog", &recording, &error) != RHEO_OK ||
        rheo_recording_world(recording, 80, NULL, &world, &error) != RHEO_OK)
        fail_msg("%s", error.message);
    rheo_recording_close(recording);
    remove("sick.rlog");
    assert_int_equal(rheo_recorder_open(world, "sick.rlog", NULL, &recorder, &error), RHEO_OK);
    bool good = true;
    for (int step = 80; step < 140 && good; step++) {
        if (step == 90)
            give(world);
        good = rheo_recorder_step(recorder, &error) == RHEO_OK;
    }
    assert_int_equal(rheo_recorder_close(recorder, &error), RHEO_OK);
    rheo_world_destroy(world);
}

static void add_inside(rheo_world *world)
{
    enum { COUNT = 40 };
    rheo_real position[3 * COUNT];
    rheo_error error;
    for (int i = 0; i < 3 * COUNT; i++)
        position[i] = rheo_world_positions(world)[i] + (rheo_real)0.01;
    assert_int_equal(rheo_world_add_particles(world, COUNT, position, NULL, &error), RHEO_OK);
}

static void push(rheo_world *world)
{
    rheo_error error;
    assert_int_equal(rheo_world_push_body(world, 0, (const double[3]){0, -1e6, 0}, NULL, &error), RHEO_OK);
}

static void added_particles_and_pushes_are_named_first(void **state)
{
    (void)state;
    if (!json_scenes)
        skip();
    /* Scheme summed bears added particles. */
    run_base("--set scheme=sequential");
    continue_base(add_inside);
    assert_true(follow_all("added") >= 1);
    assert_in("unhealthy: 40 particles were added between [", text);
    assert_in(" before step 91, ", text);
    continue_base(push);
    assert_true(follow_all("pushed, sequential") >= 1);
    assert_in("unhealthy: the ball was pushed by impulse [0, -1e+06, 0] before step 91, ", text);
    run_base("");
    continue_base(push);
    assert_true(follow_all("pushed, summed") >= 1);
    assert_in("give the command again after setting step=", text);
    assert_in("unhealthy: the ball was pushed by impulse [0, -1e+06, 0] before step 91, ", text);
}

/* ---- What is in force ---- */

/* A parameter that a command replaced before the first step is blamed for nothing. */
static void a_replaced_parameter_is_not_blamed(void **state)
{
    (void)state;
    if (!json_scenes)
        skip();
    write_file("pool.json", POOL, strlen(POOL));
    run("run pool.json --set scheme=sequential --set fluid.stiffness=900 --steps 1 -o sick.rlog --force --quiet");
    assert_code(0, run("doctor sick.rlog --json"));
    assert_in("\"measure\": \"pressure_number\"", out);
    run("run --from sick.rlog@0 --set step=0.02 --steps 40 -o other.rlog --force --quiet");
    run("doctor other.rlog --json");
    assert_null(strstr(out, "pressure_number"));
    run("run --from sick.rlog@0 --set fluid.stiffness=1000 --steps 1 -o other.rlog --force --quiet");
    run("doctor other.rlog --json");
    assert_in("{\"step\": 0, \"measure\": \"pressure_number\", \"stage\": \"density\"", out);
    assert_in("\"value\": 0.27225", out);
}

static int set_up_shell(void **state)
{
    const int result = set_up(state);
    if (result != 0)
        return result;
    char path[4096], folder[1024];
    snprintf(folder, sizeof folder, "%s", getenv("RHEOLOG"));
    snprintf(path, sizeof path, "%s:%s", dirname(folder), getenv("PATH"));
    return setenv("PATH", path, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_printed_cure_works),
        cmocka_unit_test(a_parameter_that_was_set_is_named_first),
        cmocka_unit_test(added_particles_and_pushes_are_named_first),
        cmocka_unit_test(a_replaced_parameter_is_not_blamed),
    };
    return cmocka_run_group_tests(tests, set_up_shell, tear_down);
}
