/*
 * Which files a recording replaces: never one that is blessed, however much of it is lost, and never what is no
 * recording. A link stays.
 */
#define _POSIX_C_SOURCE 200809L
#define PATH "test_replace.rlog"
#define GOLDEN "test_replace_golden.rlog"
#define LINK "test_replace_link.rlog"
#define OTHER "test_replace_other.rlog"
#include "record_support.h"

#include <sys/stat.h>
#include <unistd.h>

#include "forge.h"

static file golden; /* a blessed recording of 4 steps */

static file bytes_of(const char *path)
{
    file f;
    f.bytes = read_file(path, &f.size);
    return f;
}

static void make_recording(const char *path)
{
    size_t size;
    uint8_t *bytes = record(1, 4, 2, false, NULL, &size);
    write_file(path, bytes, size);
    free(bytes);
}

static int set_up(void **unused)
{
    (void)unused;
    rheo_verification v;
    remove(GOLDEN);
    make_recording(OTHER);
    OK(rheo_bless(GOLDEN, OTHER, "the first", false, &v, &error));
    golden = bytes_of(GOLDEN);
    return 0;
}

static int tear_down(void **unused)
{
    (void)unused;
    free(golden.bytes);
    remove(OTHER);
    remove(GOLDEN);
    return 0;
}

static size_t end_of_head(const file *f)
{
    return 8 + 36 + (size_t)forge_get(f->bytes + 8 + 16, 8);
}

static void assert_unchanged(const uint8_t *bytes, size_t size)
{
    const file now = bytes_of(GOLDEN);
    assert_int_equal(now.size, size);
    assert_memory_equal(now.bytes, bytes, size);
    free(now.bytes);
}

/* Every function that writes a recording refuses this golden recording, of which something is lost. */
static void assert_guarded(const uint8_t *bytes, size_t size, bool torn)
{
    rheo_verification v;
    rheo_recorder *recorder;
    rheo_world *world = make_world(1);
    const rheo_record_options force = {.scene = "small", .keyframe_spacing = 2, .force = true};
    write_file(GOLDEN, bytes, size);
    REFUSED(RHEO_ERROR_ARGUMENT, "is a blessed golden", rheo_world_save(world, "", GOLDEN, true, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "is a blessed golden", rheo_recorder_open(world, GOLDEN, &force, &recorder, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "is a blessed golden",
            rheo_recorder_continue(&world, GOLDEN, &force, &recorder, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "is a blessed golden", rheo_rerecord(OTHER, GOLDEN, false, true, &v, &error));
    if (torn) /* bless reads what is damaged elsewhere, and keeps its reasons */
        REFUSED(RHEO_ERROR_ARGUMENT, "cannot be replaced unread",
                rheo_bless(GOLDEN, OTHER, "I did not look", false, &v, &error));
    assert_unchanged(bytes, size);
    rheo_world_destroy(world);
}

/* Regression: only the end of the file said that it is blessed, so that a full disk or a bad copy lost that. */
static void a_torn_golden_recording_is_still_blessed(void **unused)
{
    (void)unused;
    rheo_recording *r;
    const size_t first = end_of_head(&golden) + 4; /* the letters of the mark */
    for (size_t size = first; size < golden.size; size += size == first ? 1 : 5 * every() + 2)
        assert_guarded(golden.bytes, size, true);
    assert_guarded(golden.bytes, golden.size - 1, true);
    OK(rheo_recording_open(GOLDEN, &r, &error));
    assert_true(rheo_recording_get_info(r).blessed && !rheo_recording_get_info(r).complete);
    rheo_recording_close(r);
}

/* The head of a recording says nothing yet. */
static void a_torn_recording_that_is_not_blessed_is_replaced(void **unused)
{
    (void)unused;
    const file plain = bytes_of(OTHER);
    rheo_world *world = make_world(1);
    for (size_t size = 0; size < plain.size; size += 5 * every() + 2) {
        write_file(PATH, plain.bytes, size);
        OK(rheo_world_save(world, "", PATH, true, &error));
    }
    remove(PATH);
    rheo_world_destroy(world);
    free(plain.bytes);
}

static void a_damaged_golden_recording_is_still_blessed(void **unused)
{
    (void)unused;
    uint8_t *bytes = malloc(golden.size);
    for (size_t at = end_of_head(&golden) + 36; at < golden.size; at += 17 * every() + 2) {
        memcpy(bytes, golden.bytes, golden.size);
        bytes[at] ^= 0x10;
        assert_guarded(bytes, golden.size, false);
    }
    free(bytes);
}

/* The mark is optional: a reader that does not know it reads the recording, and files without it are complete. */
static void the_mark_changes_nothing_else(void **unused)
{
    (void)unused;
    enum { ROOM = 1 << 20 };
    uint8_t *bytes = malloc(ROOM);
    rheo_verification v;
    rheo_blessing blessing;
    for (int mark = 0; mark < 3; mark++) {
        forged f;
        rheo_recording *r;
        forge_open(&f, golden.bytes, golden.size, ROOM);
        assert_int_equal(f.chunk[1].type, RHEO__GOLD);
        assert_int_equal(f.chunk[1].flags, RHEO__CHUNK_OPTIONAL);
        if (mark == 1)
            f.chunk[1].type = RHEO__CHUNK('N', 'O', 'N', 'E');
        else if (mark == 2)
            forge_remove(&f, 1);
        const size_t size = forge_write(&f, true, bytes, ROOM);
        assert_true(mark || (size == golden.size && memcmp(bytes, golden.bytes, size) == 0)); /* the index, too */
        OK(rheo_recording_open_memory(bytes, size, &r, &error));
        assert_true(rheo_recording_get_info(r).complete && rheo_recording_get_info(r).blessed);
        OK(rheo_recording_blessing(r, 0, &blessing));
        assert_int_equal(strncmp(blessing.because, "the first [", 11), 0);
        rheo_recording_close(r);
        OK(rheo_verify_memory(bytes, size, &v, &error));
        OK(rheo_verification_check(&v, 4, &error));
        forge_release(&f);
    }
    free(bytes);
}

/* A recording that is blessed twice, or made from a blessed one, is marked once. */
static void a_recording_is_marked_once(void **unused)
{
    (void)unused;
    rheo_verification v;
    rheo_recording *r;
    forged f;
    write_file(GOLDEN, golden.bytes, golden.size);
    size_t size;
    uint8_t *bytes = record(1, 6, 2, false, NULL, &size);
    write_file(PATH, bytes, size);
    free(bytes);
    OK(rheo_bless(GOLDEN, PATH, "longer", false, &v, &error));
    remove(PATH);
    OK(rheo_bless(PATH, GOLDEN, "copied", false, &v, &error));
    file now = read_and_remove(PATH);
    forge_open(&f, now.bytes, now.size, 1 << 20);
    assert_non_null(forge_find(&f, RHEO__GOLD, 0));
    assert_null(forge_find(&f, RHEO__GOLD, 1));
    assert_non_null(forge_find(&f, RHEO__BLES, 2));
    forge_release(&f);
    OK(rheo_recording_open_memory(now.bytes, now.size, &r, &error));
    assert_int_equal(rheo_recording_blessing_count(r), 3);
    rheo_recording_close(r);
    OK(rheo_verify_memory(now.bytes, now.size, &v, &error));
    OK(rheo_verification_check(&v, 6, &error));
    free(now.bytes);
    /* A mark behind the first keyframe is none. */
    uint8_t *forged_bytes = malloc(1 << 20);
    forge_open(&f, golden.bytes, golden.size, 1 << 20);
    forge_insert(&f, f.count - 1, RHEO__GOLD, RHEO__CHUNK_OPTIONAL, 0, NULL, 0);
    size = forge_write(&f, true, forged_bytes, 1 << 20);
    assert_int_equal(rheo_recording_open_memory(forged_bytes, size, &r, &why), RHEO_ERROR_FORMAT);
    forge_release(&f);
    free(forged_bytes);
}

/* ---- Links and other files ---- */

/* Asserts that LINK is a link to PATH, and PATH another file than before. */
static void assert_written_through(void)
{
    struct stat link = {0}, target = {0};
    rheo_recording *r;
    assert_int_equal(lstat(LINK, &link), 0);
    assert_true(S_ISLNK(link.st_mode));
    assert_int_equal(lstat(PATH, &target), 0);
    assert_true(S_ISREG(target.st_mode) && target.st_size > 8);
    OK(rheo_recording_open(PATH, &r, &error));
    rheo_recording_close(r);
    write_file(PATH, golden.bytes, 8); /* what is to be replaced next */
}

/* Regression: the link itself was replaced, and the file that it led to kept the old recording. */
static void a_link_stays_and_its_file_is_replaced(void **unused)
{
    (void)unused;
    rheo_verification v;
    rheo_recorder *recorder;
    rheo_world *world = make_world(1);
    remove(LINK);
    write_file(PATH, golden.bytes, 8);
    assert_int_equal(symlink(PATH, LINK), 0);
    OK(rheo_world_save(world, "", LINK, true, &error));
    assert_written_through();
    OK(rheo_recorder_open(world, LINK, &(rheo_record_options){.force = true}, &recorder, &error));
    OK(rheo_recorder_close(recorder, &error));
    assert_written_through();
    OK(rheo_rerecord(OTHER, LINK, false, true, &v, &error));
    assert_written_through();
    OK(rheo_bless(LINK, OTHER, "through a link", true, &v, &error));
    assert_written_through();
    const rheo_export_options options = {.surface = rheo_default_surface_options(), .force = true};
    OK(rheo_world_export(world, RHEO_EXPORT_CSV, LINK, &options, NULL, &error));
    struct stat link = {0}, target = {0};
    assert_true(lstat(LINK, &link) == 0 && S_ISLNK(link.st_mode));
    assert_true(lstat(PATH, &target) == 0 && target.st_size > 8);
    remove(LINK);
    remove(PATH);
    rheo_world_destroy(world);
}

/* Regression: zeros at the end of a file are no part of it, so a file of zeros counted as an empty recording. */
static void a_file_of_zeros_is_not_replaced(void **unused)
{
    (void)unused;
    enum { SIZE = 5000 };
    static const uint8_t zeros[SIZE];
    rheo_verification v;
    rheo_recorder *recorder;
    rheo_world *world = make_world(1);
    const rheo_record_options force = {.force = true};
    static const size_t sizes[] = {SIZE, 16, 15, 1};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        write_file(PATH, zeros, sizes[i]);
        REFUSED(RHEO_ERROR_ARGUMENT, "is not a recording", rheo_world_save(world, "", PATH, true, &error));
        REFUSED(RHEO_ERROR_ARGUMENT, "is not a recording",
                rheo_recorder_open(world, PATH, &force, &recorder, &error));
        REFUSED(RHEO_ERROR_ARGUMENT, "is not a recording", rheo_rerecord(OTHER, PATH, false, true, &v, &error));
        REFUSED(RHEO_ERROR_ARGUMENT, "is not a recording", rheo_bless(PATH, OTHER, "why", true, &v, &error));
        file now = bytes_of(PATH);
        assert_int_equal(now.size, sizes[i]);
        free(now.bytes);
    }
    write_file(PATH, zeros, 0); /* nothing is lost with an empty one */
    OK(rheo_world_save(world, "", PATH, true, &error));
    remove(PATH);
    /* The first bytes of a recording, with zeros behind them, are a recording. */
    uint8_t begun[SIZE] = {0};
    file whole = {NULL, 0};
    OK(rheo_world_save(world, "", PATH, true, &error));
    whole = bytes_of(PATH);
    for (size_t count = 1; count <= 8; count++) {
        memcpy(begun, whole.bytes, count);
        write_file(PATH, begun, SIZE);
        OK(rheo_world_save(world, "", PATH, true, &error));
    }
    free(whole.bytes);
    remove(PATH);
    rheo_world_destroy(world);
}

static void what_is_no_file_is_refused(void **unused)
{
    (void)unused;
    rheo_verification v;
    rheo_recorder *recorder;
    rheo_world *world = make_world(1);
    remove(LINK);
    rmdir("test_replace_folder");
    assert_int_equal(mkdir("test_replace_folder", 0777), 0);
    assert_int_equal(symlink("nowhere/at/all", LINK), 0);
    static const char *const CASES[][2] = {{"test_replace_folder", "is a folder"}, {LINK, "leads to no file"}};
    for (int i = 0; i < 2; i++) {
        const char *path = CASES[i][0], *text = CASES[i][1];
        for (int force = 0; force < 2; force++) {
            const rheo_record_options options = {.force = force};
            REFUSED(RHEO_ERROR_ARGUMENT, text, rheo_world_save(world, "", path, force, &error));
            REFUSED(RHEO_ERROR_ARGUMENT, text, rheo_recorder_open(world, path, &options, &recorder, &error));
            REFUSED(RHEO_ERROR_ARGUMENT, text, rheo_rerecord(OTHER, path, false, force, &v, &error));
            REFUSED(RHEO_ERROR_ARGUMENT, text, rheo_bless(path, OTHER, "why", force, &v, &error));
        }
        REFUSED(RHEO_ERROR_ARGUMENT, text, rheo_recorder_continue(&world, path, NULL, &recorder, &error));
    }
    REFUSED(RHEO_ERROR_ARGUMENT, "no regular file",
            rheo_recorder_continue(&world, "/dev/null", NULL, &recorder, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "no regular file", rheo_bless("/dev/null", OTHER, "why", true, &v, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "no regular file", rheo_rerecord(OTHER, "/dev/null", false, true, &v, &error));
    remove(LINK);
    rmdir("test_replace_folder");
    rheo_world_destroy(world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_torn_golden_recording_is_still_blessed),
        cmocka_unit_test(a_torn_recording_that_is_not_blessed_is_replaced),
        cmocka_unit_test(a_damaged_golden_recording_is_still_blessed),
        cmocka_unit_test(the_mark_changes_nothing_else),
        cmocka_unit_test(a_recording_is_marked_once),
        cmocka_unit_test(a_link_stays_and_its_file_is_replaced),
        cmocka_unit_test(a_file_of_zeros_is_not_replaced),
        cmocka_unit_test(what_is_no_file_is_refused),
    };
    return cmocka_run_group_tests_name("replace", tests, set_up, tear_down);
}
