#define _XOPEN_SOURCE 700 /* mkdtemp(), realpath() */
#include "cli_support.h"

#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static char folder[] = "/tmp/rheolog-cli-XXXXXX";
static char program[4096];
const char *scene;
bool json_scenes;
char out[1 << 20], err[1 << 16];

void read_file(const char *path, char *text, size_t size)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    const size_t length = fread(text, 1, size - 1, file);
    text[length] = 0;
    fclose(file);
}

char *read_bytes(const char *path, size_t *size)
{
    static char bytes[1 << 22];
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    *size = fread(bytes, 1, sizeof bytes, file);
    assert_true(*size < sizeof bytes);
    fclose(file);
    return bytes;
}

void write_file(const char *path, const char *text, size_t size)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

long file_size(const char *path)
{
    struct stat status;
    return stat(path, &status) == 0 ? (long)status.st_size : -1;
}

int run(const char *format, ...)
{
    char arguments[4096], command[8192];
    va_list list;
    va_start(list, format);
    vsnprintf(arguments, sizeof arguments, format, list);
    va_end(list);
    /* A later redirection in the arguments wins over this one. */
    snprintf(command, sizeof command, "\"$RHEOLOG\" >out.txt 2>err.txt %s", arguments);
    const int status = system(command);
    read_file("out.txt", out, sizeof out);
    read_file("err.txt", err, sizeof err);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

void assert_code(int expected, int code)
{
    if (expected != code)
        fail_msg("exit code %d instead of %d\nout: %s\nerr: %s", code, expected, out, err);
}

void assert_in(const char *part, const char *text)
{
    if (!strstr(text, part))
        fail_msg("\"%s\" is missing in:\n%s", part, text);
}

void assert_one_message(const char *part)
{
    assert_string_equal(out, "");
    assert_in(part, err);
    const char *end = strchr(err, '\n');
    assert_non_null(end);
    if (end[1] != 0)
        fail_msg("more than one line:\n%s", err);
}

void assert_keys(const char *text, const char *const *keys)
{
    assert_int_equal(text[0], '{');
    for (; *keys; keys++) {
        char quoted[64];
        snprintf(quoted, sizeof quoted, "\"%s\": ", *keys);
        assert_in(quoted, text);
    }
    const char *end = strchr(text, '\n');
    assert_non_null(end);
    assert_int_equal(end[-1], '}');
}

const char *value_of(const char *key)
{
    static char values[8][64];
    static size_t next;
    char quoted[64], *value = values[next++ % 8];
    snprintf(quoted, sizeof quoted, "\"%s\": ", key);
    const char *found = strstr(out, quoted);
    if (!found)
        fail_msg("\"%s\" is missing in:\n%s", key, out);
    found += strlen(quoted);
    snprintf(value, 64, "%.*s", (int)strcspn(found, ",}\n"), found);
    return value;
}

/* ---- Set up ---- */

const char tiny[] = "{\"scene\": \"tiny\",\n"
                    " \"steps\": 8,\n"
                    " \"history\": {\"window\": 6},\n"
                    " \"fluid\": {\"shapes\": [{\"block\": {\"min\": [0, 0, 0], \"max\": [10, 8, 10], "
                    "\"jitter\": 0.1}}]},\n"
                    " \"walls\": {\"boxes\": [{\"min\": [0, 0, 0], \"max\": [10, 9, 10], \"open\": "
                    "[\"top\"]}]},\n"
                    " \"ball\": {\"radius\": 2, \"position\": [5, 14, 5], \"velocity\": [0, -5, 0]}}\n";

int set_up(void **state)
{
    (void)state;
    const char *name = getenv("RHEOLOG");
    if (!name || !realpath(name, program) || setenv("RHEOLOG", program, 1) != 0) {
        fprintf(stderr, "the environment variable RHEOLOG must name the program to test\n");
        return 1;
    }
    if (!mkdtemp(folder) || chdir(folder) != 0)
        return 1;
    write_file("tiny.json", tiny, sizeof tiny - 1);
    const int code = run("run tiny.json --steps 0 --quiet");
    json_scenes = !strstr(err, "without JSON");
    scene = json_scenes ? "tiny.json" : "bowling-ball-small --set settle.time=0 --set history.window=6";
    return json_scenes && code != 0;
}

int tear_down(void **state)
{
    (void)state;
    char command[64];
    snprintf(command, sizeof command, "rm -rf %s", folder);
    return chdir("/") != 0 || system(command) != 0;
}

void record(const char *name)
{
    assert_code(0, run("run %s --steps 8 -o %s --force --quiet --json", scene, name));
}

rheo_world *checkpoint_at(const char *from, int step)
{
    rheo_recording *recording;
    rheo_world *world;
    assert_code(0, run("checkpoint %s --step %d -o at.rlog --force", from, step));
    assert_int_equal(rheo_recording_open("at.rlog", &recording, NULL), RHEO_OK);
    assert_int_equal(rheo_recording_world(recording, (uint64_t)step, NULL, &world, NULL), RHEO_OK);
    rheo_recording_close(recording);
    return world;
}

double number_at(const char **at)
{
    const double value = strtod(*at, NULL);
    *at += strspn(*at, "+-.0123456789e");
    return value;
}

double number_after(const char **at, const char *key)
{
    char quoted[64];
    snprintf(quoted, sizeof quoted, "\"%s\": ", key);
    const char *found = strstr(*at, quoted);
    if (!found)
        fail_msg("\"%s\" is missing in:\n%s", key, *at);
    *at = found + strlen(quoted);
    *at += **at == '[';
    return number_at(at);
}

void assert_vector(const char **at, const char *key, const double value[3])
{
    assert_true(number_after(at, key) == value[0]);
    for (int axis = 1; axis < 3; axis++) {
        *at += 2; /* a comma and a blank */
        assert_true(number_at(at) == value[axis]);
    }
}

void assert_row(const char **at, const char *key, const rheo_real *row)
{
    assert_vector(at, key, (const double[]){(double)row[0], (double)row[1], (double)row[2]});
}

void record_melting(const char *name, const char *options)
{
    assert_code(0, run("run melting-box --set fluid.spacing=0.12 --steps 4 -o %s --json --force %s", name, options));
}

void assert_files_same(const char *a, const char *b)
{
    static char first[1 << 20], second[1 << 20];
    assert_int_equal(file_size(a), file_size(b));
    read_file(a, first, sizeof first);
    read_file(b, second, sizeof second);
    assert_memory_equal(first, second, sizeof first < (size_t)file_size(a) ? sizeof first : (size_t)file_size(a));
}

static uint32_t crc32_of(const unsigned char *bytes, size_t size)
{
    uint32_t crc = 0xffffffff;
    for (size_t i = 0; i < size; i++) {
        crc ^= bytes[i];
        for (int bit = 0; bit < 8; bit++)
            crc = crc >> 1 ^ (crc & 1 ? 0xedb88320 : 0);
    }
    return ~crc;
}

void falsify_step_by(const char *from, const char *to, unsigned step, unsigned char bits)
{
    size_t size;
    unsigned char *bytes = (unsigned char *)read_bytes(from, &size);
    bool found = false;
    for (size_t at = 8; at + 36 < size && !found;) {
        const size_t stored = bytes[at + 16] | (size_t)bytes[at + 17] << 8 | (size_t)bytes[at + 18] << 16;
        found = memcmp(bytes + at, "STEP", 4) == 0 && bytes[at + 8] == step;
        if (found) {
            bytes[at + 32 + 24] ^= bits;
            const uint32_t crc = crc32_of(bytes + at, 32 + stored);
            for (size_t i = 0; i < 4; i++)
                bytes[at + 32 + stored + i] = (unsigned char)(crc >> 8 * i);
        }
        at += 36 + stored;
    }
    assert_true(found);
    write_file(to, (const char *)bytes, size);
}

void falsify_step(const char *from, const char *to, unsigned step)
{
    falsify_step_by(from, to, step, 1);
}

int interrupt_until(const char *command, const char *sign)
{
    for (long ms = 300;; ms *= 2) {
        char line[512];
        snprintf(line, sizeof line, "exec \"$RHEOLOG\" %s >out.txt 2>err.txt", command);
        const pid_t child = fork();
        assert_true(child >= 0);
        if (child == 0) {
            signal(SIGINT, SIG_DFL); /* a shell ignores it in its background, and then the program does */
            execl("/bin/sh", "sh", "-c", line, (char *)NULL);
            _exit(127);
        }
        nanosleep(&(struct timespec){ms / 1000, ms % 1000 * 1000000}, NULL);
        int status;
        assert_int_equal(kill(child, SIGINT), 0);
        assert_int_equal(waitpid(child, &status, 0), child);
        read_file("out.txt", out, sizeof out);
        read_file("err.txt", err, sizeof err);
        if ((WIFEXITED(status) && strstr(out, sign)) || ms > 60000)
            return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
}
