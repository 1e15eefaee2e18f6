/* The commands that read whole recordings, from outside: verify, diff, bless, info, metrics. */
#include "cli_support.h"

#include <sys/wait.h>

/* ---- verify, info, metrics ---- */

static void verify_has_its_keys(void **state)
{
    (void)state;
    record("a.rlog");
    static const char *const keys[] = {"file", "hash", "verdict", "steps", "first", NULL};
    assert_code(0, run("verify a.rlog --json"));
    assert_keys(out, keys);
    assert_string_equal(value_of("verdict"), "\"same\"");
    assert_string_equal(value_of("steps"), "8");
    assert_string_equal(value_of("first"), "null");
    assert_code(2, run("verify --json none.rlog a.rlog"));
    assert_keys(out, keys);
    assert_string_equal(value_of("verdict"), "\"unreadable\"");
    assert_in("\"verdict\": \"same\"", out); /* the other files are still verified */
}

static void truncated_and_damaged_files_are_unreadable(void **state)
{
    (void)state;
    record("a.rlog");
    size_t size;
    char *bytes = read_bytes("a.rlog", &size);
    write_file("truncated.rlog", bytes, size - 5);
    assert_code(2, run("verify truncated.rlog a.rlog"));
    assert_in("truncated.rlog: unreadable", out);
    assert_in("a.rlog: same", out);
    assert_code(2, run("metrics truncated.rlog"));
    assert_in("step,time,", out);
    assert_in("truncated", err);
    assert_code(0, run("info truncated.rlog --json"));
    assert_string_equal(value_of("complete"), "false");
    for (size_t i = 1; i < 8; i++) {
        const size_t at = size * i / 8;
        bytes[at] ^= 0x10;
        write_file("damaged.rlog", bytes, size);
        assert_code(2, run("verify damaged.rlog"));
        bytes[at] ^= 0x10;
        write_file("cut.rlog", bytes, at);
        assert_code(2, run("verify cut.rlog"));
    }
}

/* `verify` prints the hash that this build reaches, the same as `run`. */
static void verify_prints_the_hash_of_the_last_step(void **state)
{
    (void)state;
    char last[32], fifth[32];
    assert_code(0, run("run %s --steps 5 --quiet --json", scene));
    snprintf(fifth, sizeof fifth, "%s", value_of("hash"));
    record("a.rlog");
    snprintf(last, sizeof last, "%s", value_of("hash"));
    assert_int_equal(strlen(last), 18);
    assert_string_not_equal(fifth, last);
    assert_code(0, run("verify a.rlog --json"));
    assert_string_equal(value_of("hash"), last);
    falsify_step("a.rlog", "other.rlog", 5);
    assert_code(1, run("verify other.rlog --json"));
    assert_string_equal(value_of("hash"), fifth);
    assert_code(2, run("verify none.rlog --json"));
    assert_string_equal(value_of("hash"), "null");
}

static void a_difference_is_named(void **state)
{
    (void)state;
    record("a.rlog");
    falsify_step("a.rlog", "other.rlog", 5);
    assert_code(1, run("verify a.rlog other.rlog"));
    assert_in("a.rlog: same", out);
    assert_in("other.rlog: differs", out);
    assert_in("next:", out);
    assert_in("--step 4", out);
    assert_code(1, run("verify --json other.rlog"));
    static const char *const keys[] = {"first",    "step",   "stage", "field", "id",      "other_id", "component",
                                       "expected", "actual", "ulps",  "count", "largest", "relative", NULL};
    assert_keys(out, keys);
    assert_string_equal(value_of("verdict"), "\"differs\"");
    assert_string_equal(value_of("step"), "5");
    assert_string_equal(value_of("steps"), "4");
    assert_string_equal(value_of("ulps"), "null"); /* the recording stores hashes only */
    assert_code(2, run("verify other.rlog none.rlog"));
    assert_code(0, run("checkpoint other.rlog --step 4 -o before.rlog --force"));
    assert_code(1, run("checkpoint other.rlog --step 6 -o never.rlog"));
    assert_int_equal(file_size("never.rlog"), -1);
    assert_code(1, run("run --from other.rlog --steps 1"));
}

static void diff_has_its_keys(void **state)
{
    (void)state;
    record("a.rlog");
    static const char *const keys[] = {"a",
                                       "b",
                                       "verdict",
                                       "steps",
                                       "first",
                                       "growth",
                                       "message",
                                       "commands_step",
                                       "lengths_differ",
                                       "a_steps",
                                       "b_steps",
                                       "cause",
                                       "parameters",
                                       NULL};
    assert_code(0, run("diff a.rlog a.rlog --json"));
    assert_keys(out, keys);
    assert_string_equal(value_of("verdict"), "\"same\"");
    assert_string_equal(value_of("steps"), "8");
    assert_string_equal(value_of("first"), "null");
    assert_code(0, run("run --from a.rlog@0 --steps 8 -o b.rlog --force --set fluid.near_stiffness=501"));
    assert_code(1, run("diff a.rlog b.rlog --json"));
    assert_keys(out, keys);
    assert_string_equal(value_of("verdict"), "\"differs\"");
    assert_string_equal(value_of("step"), "1");
    assert_string_equal(value_of("stage"), "\"forces@1\"");
    assert_string_equal(value_of("field"), "\"position\"");
    assert_string_equal(value_of("origin"), "\"simulated\"");
    assert_string_equal(value_of("commands_step"), "1");
    assert_code(1, run("diff a.rlog b.rlog"));
    assert_in("differs at step 1: position after stage forces@1", out);
    assert_in("in the first", out);
    assert_in("how it grows", out);
    assert_in("the commands given before step 1 differ", out);
    assert_in("\n    rheolog inspect a.rlog --step 1 --stage forces@1 --particle ", out);
    assert_code(2, run("diff a.rlog none.rlog"));
    assert_in("unreadable", out);
    assert_code(2, run("diff a.rlog"));
    assert_in("needs two recordings", err);
}

/* A run that stopped early is not the same, unless only common steps are asked for. */
static void diff_of_different_lengths(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("run --from a.rlog@0 --steps 5 -o b.rlog --force"));
    assert_code(1, run("diff a.rlog b.rlog"));
    assert_in("differs in length: the first has steps 0 to 8, the second 0 to 5; the 5 steps that both have agree",
              out);
    assert_code(1, run("diff a.rlog b.rlog --json"));
    assert_string_equal(value_of("verdict"), "\"differs\"");
    assert_string_equal(value_of("lengths_differ"), "true");
    assert_in("\"b_steps\": [0, 5]", out);
    assert_code(0, run("diff --common a.rlog b.rlog"));
    assert_in("same, as far as both go: the first has steps 0 to 8", out);
    assert_code(0, run("diff --common a.rlog b.rlog --json"));
    assert_string_equal(value_of("verdict"), "\"same\"");
    assert_string_equal(value_of("steps"), "5");
    assert_code(0, run("run --from a.rlog@0 --steps 5 -o b.rlog --force --set fluid.near_stiffness=501"));
    assert_code(1, run("diff --common a.rlog b.rlog"));
}

static void bless_replaces_golden_recordings(void **state)
{
    (void)state;
    record("a.rlog");
    remove("golden.rlog");
    assert_code(2, run("bless golden.rlog a.rlog"));
    assert_in("--because", err);
    assert_code(2, run("bless golden.rlog none.rlog --because why"));
    assert_int_equal(file_size("golden.rlog"), -1);
    assert_code(0, run("bless golden.rlog a.rlog --because \"the first\""));
    assert_in("golden.rlog: made; blessed 1 time so far", out);
    assert_code(0, run("verify golden.rlog"));
    assert_code(0, run("info golden.rlog --json"));
    assert_in("\"the first [not compared, there was no recording; steps 0 to 8]\"", out);
    assert_code(0, run("bless golden.rlog a.rlog --because again"));
    assert_in("nothing to bless", out);
    const long long size = (long long)file_size("golden.rlog");
    assert_code(2, run("run --from a.rlog --steps 1 -o golden.rlog --force"));
    assert_in("blessed", err);
    assert_code(2, run("checkpoint a.rlog --step 1 -o golden.rlog --force"));
    assert_int_equal(file_size("golden.rlog"), size);
    assert_code(0, run("run --from a.rlog@0 --steps 8 -o b.rlog --force --set fluid.near_stiffness=501"));
    assert_code(0, run("bless golden.rlog b.rlog --because \"stiffer\""));
    assert_in("differs at step 1: position after stage forces@1", out);
    assert_in("replaced; blessed 2 times so far", out);
    assert_code(0, run("info golden.rlog"));
    const char *const first = strstr(out, "\nblessed     the first ["), *const second =
                                                                            strstr(out, "\nblessed     stiffer [");
    assert_true(first && second && first < second);
    assert_true(strstr(first, "\n            by rheolog") < second && strstr(second, "\n            by rheolog"));
    assert_null(strstr(out, "reasons that are lost"));
    assert_null(strstr(out, " tried)")); /* for a verdict, which neither has */
    assert_code(0, run("info golden.rlog --json"));
    assert_in("\"blessings\": [{\"because\": \"the first [not compared, ", out);
    assert_in("}, {\"because\": \"stiffer [", out);
    assert_code(0, run("run --from a.rlog@0 --steps 5 -o b.rlog --force"));
    assert_code(2, run("bless golden.rlog b.rlog --because oops"));
    assert_in("would shrink: it has steps 0 to 8, the new one 0 to 5", err);
    assert_in("--shrink", err);
    assert_code(0, run("bless golden.rlog b.rlog --shrink --because \"five are enough\""));
    falsify_step("a.rlog", "other.rlog", 5);
    assert_code(1, run("bless golden.rlog other.rlog --because wrong"));
    assert_in("does not verify", err);
    assert_code(0, run("diff golden.rlog b.rlog"));
}

/* A scene, or any other file, is not lost by a slip of the hand. */
static void no_command_replaces_what_is_no_recording(void **state)
{
    (void)state;
    static const char letter[] = "{\"scene\": \"mine\"}";
    char commands[5][600];
    record("a.rlog");
    write_file("mine.json", letter, strlen(letter));
    snprintf(commands[0], sizeof *commands, "bless mine.json a.rlog --because why");
    snprintf(commands[1], sizeof *commands, "bless mine.json a.rlog --because why --shrink");
    snprintf(commands[2], sizeof *commands, "checkpoint a.rlog --step 1 -o mine.json --force");
    snprintf(commands[3], sizeof *commands, "rerecord a.rlog -o mine.json --force");
    snprintf(commands[4], sizeof *commands, "run %s --steps 1 -o mine.json --force", scene);
    for (int i = 0; i < 5; i++) {
        size_t size;
        assert_code(2, run("%s", commands[i]));
        assert_one_message("not a recording");
        assert_memory_equal(read_bytes("mine.json", &size), letter, strlen(letter));
        assert_int_equal(size, strlen(letter));
    }
    remove("mine.json");
}

/* Regression: what a full disk left of a golden recording was replaced, or gone on with. */
static void a_torn_golden_recording_is_named_as_blessed(void **state)
{
    (void)state;
    char commands[5][600];
    snprintf(commands[0], sizeof *commands, "checkpoint a.rlog --step 1 -o golden.rlog --force");
    snprintf(commands[1], sizeof *commands, "rerecord a.rlog -o golden.rlog --force");
    snprintf(commands[2], sizeof *commands, "run %s --steps 8 -o golden.rlog --force", scene);
    snprintf(commands[3], sizeof *commands, "run %s --steps 8 -o golden.rlog --continue", scene);
    snprintf(commands[4], sizeof *commands, "run %s --steps 8 -o golden.rlog", scene);
    record("a.rlog");
    remove("golden.rlog");
    assert_code(0, run("bless golden.rlog a.rlog --because \"the first\""));
    const long size = file_size("golden.rlog");
    const long lengths[] = {2000, size / 2, size - 100, size - 1};
    for (int n = 0; n < 4; n++) {
        size_t whole, now;
        char *bytes = read_bytes("golden.rlog", &whole), *kept = malloc(whole);
        memcpy(kept, bytes, whole);
        write_file("golden.rlog", kept, (size_t)lengths[n]);
        for (int i = 0; i < 5; i++) {
            assert_code(2, run("%s", commands[i]));
            assert_one_message("golden.rlog is a blessed golden recording");
        }
        assert_code(2, run("bless golden.rlog a.rlog --because why"));
        assert_in("golden.rlog cannot be replaced unread", err);
        assert_memory_equal(read_bytes("golden.rlog", &now), kept, (size_t)lengths[n]);
        assert_int_equal(now, lengths[n]);
        write_file("golden.rlog", kept, whole);
        free(kept);
    }
    write_file("golden.rlog", read_bytes("golden.rlog", &(size_t){0}), (size_t)size - 300);
    run("info golden.rlog");
    assert_in("blessed     with reasons that are lost", out);
    run("info golden.rlog --json");
    assert_string_equal(value_of("blessed"), "true");
    remove("golden.rlog");
}

/* What a full disk left of a recording is one, however little it is. */
static void a_torn_recording_is_replaced(void **state)
{
    (void)state;
    record("a.rlog");
    size_t size;
    char *bytes = read_bytes("a.rlog", &size);
    static const size_t LEFT[] = {0, 1, 5, 8, 40, 2000};
    for (size_t i = 0; i < sizeof LEFT / sizeof *LEFT; i++) {
        write_file("torn.rlog", bytes, LEFT[i]);
        assert_code(2, run("checkpoint a.rlog --step 1 -o torn.rlog"));
        assert_one_message("torn.rlog exists; give --force");
        assert_code(0, run("checkpoint a.rlog --step 1 -o torn.rlog --force"));
        bytes = read_bytes("a.rlog", &size);
    }
    remove("torn.rlog");
}

/* Where the limit of the process is reached, the disk is as good as full. */
static void a_limit_of_the_file_size_is_an_error(void **state)
{
    (void)state;
    static const char *const commands[] = {"run %s --steps 3000 -o limited.rlog --quiet",
                                           "rerecord b.rlog -o limited.rlog",
                                           "checkpoint b.rlog --step 30 -o limited.rlog"};
    assert_code(0, run("run %s --steps 300 -o b.rlog --force --quiet", scene));
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
        char command[1024], words[512];
        snprintf(words, sizeof words, commands[i], scene);
        remove("limited.rlog");
        snprintf(command, sizeof command, "ulimit -f 2; exec \"$RHEOLOG\" %s >out.txt 2>err.txt", words);
        const int status = system(command);
        assert_true(WIFEXITED(status));
        assert_int_equal(WEXITSTATUS(status), 3);
        read_file("err.txt", err, sizeof err);
        assert_in("File too large", err);
        assert_int_equal(system("ls | grep -q 'limited.rlog[.]tmp'") == 0, 0);
    }
    remove("limited.rlog");
}

/* Nobody reads the progress any more, but the recording goes on. */
static void a_closed_pipe_ends_no_run(void **state)
{
    (void)state;
    char command[1024];
    remove("piped.rlog");
    snprintf(command, sizeof command, "\"$RHEOLOG\" run %s --steps 300 -o piped.rlog 2>&1 | true", scene);
    assert_true(system(command) != -1);
    assert_code(0, run("info piped.rlog --json"));
    assert_string_equal(value_of("steps"), "300");
    assert_string_equal(value_of("complete"), "true");
    remove("piped.rlog");
}

static void info_has_its_keys(void **state)
{
    (void)state;
    record("a.rlog");
    static const char *const keys[] = {
        "scene",   "steps",      "particles",        "format",   "keyframes",  "bytes",
        "build",   "real_bytes", "keyframe_spacing", "complete", "parameters", "fluid.support",
        "gravity", "kappa",      "derived_numbers",  "meaning",  "unit",       NULL};
    assert_code(0, run("info a.rlog --json"));
    assert_keys(out, keys);
    assert_string_equal(value_of("steps"), "8");
    assert_string_equal(value_of("fluid.support"), "4");
    char size[32];
    snprintf(size, sizeof size, "%ld", file_size("a.rlog"));
    assert_string_equal(value_of("bytes"), size);
    assert_string_equal(value_of("failure"), "null");
    assert_string_equal(value_of("blessings"), "[]");
    /* The default spacing of keyframes costs about 2 % of a run. */
    const double share = strtod(value_of("keyframe_share"), NULL);
    assert_true(share > .015 && share < .035);
    assert_code(0, run("info a.rlog"));
    assert_in("of the run's time", out);
    assert_in("history.window", out);
    assert_in("kappa", out);
    assert_in("sound_speed         52.12      L/T         root of bulk modulus/density\n", out);
    assert_in("yield_stress        3.231      L^2/T^2     ", out);
}

/* The values of the parameters begin in one column, right behind the longest name of this model. */
static void info_aligns_the_parameters(void **state)
{
    (void)state;
    for (int melting = 0; melting < 2; melting++) {
        if (melting)
            record_melting("a.rlog", "--steps 1 --force");
        else
            record("a.rlog");
        assert_code(0, run("info a.rlog"));
        const char *line = strstr(out, "\nmodel ");
        assert_non_null(line);
        size_t longest = 0, rows = 0, column = 0;
        for (line++; *line; line = strchr(line, '\n') + 1, rows++) {
            const char *equals = strstr(line, " = ");
            const size_t name = strcspn(line, " "), at = (size_t)(equals - line);
            assert_true(equals && equals < strchr(line, '\n') && name <= at);
            assert_true(rows == 0 || at == column);
            column = at;
            longest = name > longest ? name : longest;
        }
        assert_true(rows > 20 && column == longest);
    }
}

static void metrics_are_csv(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("metrics a.rlog"));
    assert_string_equal(err, "");
    assert_memory_equal(out, "step,time,", 10);
    size_t columns = 1, rows = 0;
    for (const char *c = out; *c != '\n'; c++)
        columns += *c == ',';
    char last[64] = "";
    for (const char *line = strchr(out, '\n') + 1; *line; line += strcspn(line, "\n") + 1) {
        size_t here = 1;
        for (const char *c = line; *c != '\n'; c++)
            here += *c == ',';
        assert_int_equal(here, columns);
        snprintf(last, sizeof last, "%.*s", (int)strcspn(line, ","), line);
        rows++;
    }
    assert_string_equal(last, "8");
    assert_int_equal(rows, 9); /* the initial state and 8 steps */
}

static void metrics_of_several_recordings_are_one_table(void **state)
{
    (void)state;
    record("a.rlog");
    record_melting("with,comma.rlog", "");
    /* The columns of both; what a recording does not have is empty. */
    assert_code(0, run("metrics a.rlog with,comma.rlog"));
    assert_memory_equal(out, "file,step,time,", 15);
    assert_in(",ball_y,", out);
    assert_in(",hot_height,", out);
    size_t columns = 0, rows = 0;
    for (const char *c = out; *c != '\n'; c++)
        columns += *c == ',';
    for (const char *line = strchr(out, '\n') + 1; *line; line += strcspn(line, "\n") + 1, rows++) {
        size_t here = 0;
        const char *c = *line == '"' ? strchr(line + 1, '"') : line;
        for (; *c != '\n'; c++)
            here += *c == ',';
        assert_int_equal(here, columns);
    }
    assert_int_equal(rows, 9 + 5);
    assert_code(2, run("metrics a.rlog with,comma.rlog --columns time,ball_radius"));
    assert_one_message("there is no metric \"ball_radius\"");
    assert_code(0, run("metrics a.rlog with,comma.rlog --columns heat,step"));
    assert_memory_equal(out, "file,heat,step\na.rlog,,0\n", 24);
    assert_in("\n\"with,comma.rlog\",", out);
    assert_code(0, run("metrics a.rlog --columns step"));
    assert_string_equal(out, "step\n0\n1\n2\n3\n4\n5\n6\n7\n8\n");
    /* The others are printed all the same. */
    assert_code(2, run("metrics none.rlog a.rlog --columns step"));
    assert_in("none.rlog", err);
    assert_in("file,step\na.rlog,0\n", out);
    assert_in("a.rlog,8\n", out);
}

static void info_and_doctor_take_several_recordings(void **state)
{
    (void)state;
    record("a.rlog");
    record("b.rlog");
    assert_code(0, run("info a.rlog b.rlog"));
    assert_memory_equal(out, "a.rlog\n", 7);
    assert_in("\n\nb.rlog\nscene  ", out);
    assert_code(2, run("info none.rlog b.rlog --json"));
    assert_memory_equal(out, "{\"file\": \"b.rlog\"", 17);
    assert_in("none.rlog", err);
    assert_code(0, run("doctor a.rlog b.rlog"));
    assert_memory_equal(out, "a.rlog: healthy", 15);
    const char *second = strchr(out, '\n') + 1;
    assert_memory_equal(second, "b.rlog: healthy", 15);
    assert_string_equal(strchr(second, '\n'), "\n"); /* one line each */
    assert_code(2, run("doctor a.rlog none.rlog b.rlog"));
    assert_in("b.rlog: healthy", out); /* the others are examined all the same */
}

/* Every column of a recording is in the list, with its unit and meaning. */
static void metrics_are_listed_with_unit_and_meaning(void **state)
{
    (void)state;
    static char listed[1 << 16], header[1 << 12];
    record("a.rlog");
    assert_code(0, run("metrics --list"));
    assert_true(strlen(out) < sizeof listed);
    memcpy(listed, out, strlen(out) + 1);
    assert_in("model melting", listed);
    assert_code(0, run("metrics a.rlog"));
    snprintf(header, sizeof header, "%.*s", (int)strcspn(out, "\n"), out);
    assert_code(0, run("metrics --list a.rlog"));
    assert_in("ball_vx  L/T\n    velocity of the ball, x\n", out);
    for (char *name = strtok(header, ","); name; name = strtok(NULL, ",")) {
        char line[80];
        snprintf(line, sizeof line, "%s  ", name);
        assert_in(line, out);
        assert_in(line, listed);
    }
    assert_code(2, run("metrics --list none.rlog"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(verify_has_its_keys),
        cmocka_unit_test(verify_prints_the_hash_of_the_last_step),
        cmocka_unit_test(truncated_and_damaged_files_are_unreadable),
        cmocka_unit_test(a_difference_is_named),
        cmocka_unit_test(diff_has_its_keys),
        cmocka_unit_test(diff_of_different_lengths),
        cmocka_unit_test(bless_replaces_golden_recordings),
        cmocka_unit_test(no_command_replaces_what_is_no_recording),
        cmocka_unit_test(a_torn_golden_recording_is_named_as_blessed),
        cmocka_unit_test(a_torn_recording_is_replaced),
        cmocka_unit_test(a_limit_of_the_file_size_is_an_error),
        cmocka_unit_test(a_closed_pipe_ends_no_run),
        cmocka_unit_test(info_has_its_keys),
        cmocka_unit_test(info_aligns_the_parameters),
        cmocka_unit_test(metrics_are_csv),
        cmocka_unit_test(metrics_of_several_recordings_are_one_table),
        cmocka_unit_test(metrics_are_listed_with_unit_and_meaning),
        cmocka_unit_test(info_and_doctor_take_several_recordings),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
