/* Emitters from outside: recordings that are continued, started from, made again and looked at; scene files. */
#include "cli_support.h"

static char hash[17];

/* The hash that `run --json` printed. */
static const char *printed_hash(void)
{
    static char text[17];
    const char *at = value_of("hash");
    assert_non_null(at);
    snprintf(text, sizeof text, "%.16s", at + (*at == '"'));
    return text;
}

/* A run of 30 steps, whose jet is switched off before step 21. */
static void record_jet(void)
{
    assert_code(0, run("run jet --steps 20 -o a.rlog --force --quiet --json"));
    assert_code(
        0, run("run --from a.rlog --set emitters.nozzle.flow=off --steps 10 -o off.rlog --force --quiet --json"));
    assert_code(0, run("run jet --steps 30 -o jet.rlog --force --quiet --json --full"));
    snprintf(hash, sizeof hash, "%s", printed_hash());
}

static void runs_end_with_the_same_bits(void **state)
{
    (void)state;
    record_jet();
    static const char *const others[] = {
        "run jet --steps 30 -o a.rlog --continue --quiet --json",
        "run --from jet.rlog@0 --steps 30 --quiet --json",
        "run --from jet.rlog@13 --steps 17 --quiet --json",
        "run jet --steps 30 --simd scalar --quiet --json",
    };
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        assert_code(0, run("%s", others[i]));
        assert_string_equal(printed_hash(), hash);
    }
    assert_code(0, run("verify jet.rlog a.rlog off.rlog"));
    assert_code(0, run("diff jet.rlog a.rlog"));
    assert_code(0, run("rerecord jet.rlog -o again.rlog --force --quiet"));
    assert_code(0, run("rerecord off.rlog -o off-again.rlog --full --force --quiet"));
    assert_code(0, run("verify again.rlog off-again.rlog"));
    assert_code(0, run("same jet.rlog --quiet"));
    assert_code(0, run("checkpoint jet.rlog --step 7 -o c.rlog --force"));
    assert_code(0, run("run --from c.rlog --steps 23 --quiet --json"));
    assert_string_equal(printed_hash(), hash);
}

/* Steps in halves emit what whole steps do, so the numbers of particles agree. */
static void the_same_physics_is_judged_step_by_step(void **state)
{
    (void)state;
    record_jet();
    const int code = run("same jet.rlog --set fluid.stiffness=300.5 --at-least step --quiet");
    assert_true(code == 0 || code == 1);
    assert_in("  step        ", out);
    assert_null(strstr(out, "  step        not tried"));
    assert_null(strstr(out, "another number"));
}

static void commands_tell_of_emitters(void **state)
{
    (void)state;
    record_jet();
    static const char line[] =
        "\nemitters    nozzle emits layers of 29 particles with 5 L/T, at most 4000 particles\n";
    assert_code(0, run("info jet.rlog"));
    assert_in(line, out);
    assert_in("emitters.1.position = [0, 14, 0] (default: [0, 0, 0])", out);
    assert_code(0, run("log off.rlog"));
    assert_in(line, out);
    assert_in("\nstep 21     emitters.nozzle.flow was set to off; before, it was on\n", out);
    assert_code(0, run("doctor jet.rlog"));
    assert_in(line, out);
    assert_code(0, run("inspect jet.rlog --step 20"));
    assert_in("\nparticles     116\n", out);
    assert_in("\nemitter nozzle   116 particles emitted, 0 without room left out\n", out);
    assert_code(0, run("inspect jet.rlog --step 20 --json"));
    assert_in("\"emitters\": [{\"name\": \"nozzle\", \"emitted\": 116, \"blocked\": 0, \"sites\": 29, \"way\": ",
              out);
    assert_code(0, run("inspect off.rlog --step 30"));
    assert_in("\nparticles     116\n", out);
    assert_code(0, run("why jet.rlog --step 20 --particle 100"));
    assert_code(0, run("track jet.rlog --particle 100"));
    assert_code(2, run("track jet.rlog --particle 4000"));
    assert_in("has no particle 4000", err);
    assert_code(0, run("export jet.rlog -o exported --format csv --every 10 --force"));
    assert_code(0, run("check jet"));
    assert_in("\n  emitters           up to 2871 particles more in 600 steps\n", out);
    assert_code(2, run("run --from jet.rlog --set emitters.nozzle.speed=90 --steps 1"));
    assert_in("emitters.nozzle.speed is 90: that is 1.49 supports in a step", err);
}

static void scene_files_have_emitters(void **state)
{
    (void)state;
    static const char text[] =
        "{\"emitters\": [{\"name\": \"n\", \"position\": [0, 9, 0], \"material\": \"b\", \"shape\": "
        "\"rectangle\", \"width\": 4, \"comment\": 1}],\n\"materials\": [{\"name\": \"b\"}]}";
    static const struct {
        const char *text, *message;
    } bad[] = {
        {"{\"emitters\": 1}", "emitters: must be a list"},
        {"{\"emitters\": [1]}", "emitters[0]: must be an object {...}; got a number"},
        {"{\"emitters\": [{}]}", "emitters[0]: \"name\" is missing"},
        {"{\"emitters\": [{\"name\": \"n\"}]}", "emitters[0]: \"position\" is missing"},
        {"{\"emitters\": [{\"name\": \"1\", \"position\": [0, 0, 0]}]}",
         "emitters[0].name: emitter 1 has the name \"1\""},
        {"{\"emitters\": [{\"name\": \"n\", \"position\": [0, 0]}]}",
         "emitters[0].position: must be a list of 3 numbers"},
        {"{\"emitters\": [{\"name\": \"n\", \"position\": [0, 0, 0], \"sped\": 1}]}", "did you mean \"speed\"?"},
        {"{\"emitters\": [{\"name\": \"n\", \"position\": [0, 0, 0], \"x\": 1}]}",
         "unknown key; an emitter has name, shape, flow, position"},
        {"{\"emitters\": [{\"name\": \"n\", \"position\": [0, 0, 0], \"flow\": \"of\"}]}", "it is one of: off on"},
        {"{\"emitters\": [{\"name\": \"n\", \"position\": [0, 0, 0], \"material\": \"b\"}]}",
         "there is no material \"b\""},
        {"{\"emitters\": [{\"name\": \"n\", \"position\": [0, 0, 0], \"temperature\": 1}]}",
         "a parameter of the model melting"},
        {"{\"model\": \"melting\", \"emitters\": [{\"name\": \"n\", \"position\": [0, 0, 0], \"material\": \"main\"}]}",
         "a parameter of the model thickening"},
    };
    if (!json_scenes)
        skip();
    write_file("good.json", text, sizeof text - 1);
    assert_code(0, run("run good.json --write-scene"));
    assert_in("\"shape\": \"rectangle\"", out);
    assert_in("\"material\": \"b\"", out);
    assert_null(strstr(out, "\"temperature\""));
    static char written[sizeof out];
    memcpy(written, out, sizeof written);
    write_file("written.json", written, strlen(written));
    assert_code(0, run("run written.json --write-scene"));
    assert_string_equal(out, written); /* but for the name, which is in the file */
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        write_file("bad.json", bad[i].text, strlen(bad[i].text));
        assert_code(2, run("run bad.json --steps 1"));
        assert_one_message(bad[i].message);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(runs_end_with_the_same_bits),
        cmocka_unit_test(the_same_physics_is_judged_step_by_step),
        cmocka_unit_test(commands_tell_of_emitters),
        cmocka_unit_test(scene_files_have_emitters),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
