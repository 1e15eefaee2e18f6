/*
 * A test of golden recordings as a user of the library would write it. It simulates every recording in a folder again
 * and compares step by step. To use it, copy it and name your folder. An empty folder is a failure, because otherwise
 * a lost folder would pass forever.
 */
#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <rheolog/rheolog.h>

static void golden_recordings_are_the_same(void **state)
{
    (void)state;
    const char *folder = getenv("GOLDEN");
    DIR *files = folder ? opendir(folder) : NULL;
    if (!files)
        fail_msg("there is no folder of golden recordings: GOLDEN=%s", folder ? folder : "");
    int found = 0, other = 0;
    for (struct dirent *file; (file = readdir(files));) {
        char path[1024];
        const char *end = strrchr(file->d_name, '.');
        if (!end || strcmp(end, ".rlog") != 0)
            continue;
        snprintf(path, sizeof path, "%s/%s", folder, file->d_name);
        found++;
        rheo_verification v;
        rheo_error error = {""};
        rheo_verify(path, &v, NULL); /* v tells of every error, too */
        if (rheo_verification_check(&v, 1, &error) == RHEO_OK)
            continue;
        other++; /* the other files are still compared */
        print_error("%s: %s\n", path, error.message);
        if (v.verdict == RHEO_DIFFERS)
            print_error("If the change is meant, record it again and `rheolog bless %s NEW.rlog --because \"...\"`\n",
                        path);
    }
    closedir(files);
    if (!found)
        fail_msg("no golden recordings in %s", folder);
    assert_int_equal(other, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(golden_recordings_are_the_same)};
    return cmocka_run_group_tests_name("example of golden recordings", tests, NULL, NULL);
}
