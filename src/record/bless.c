/*
 * Blessing: the one way in which a golden recording changes. This build must reproduce the new
 * recording; the reason is written into it, after the reasons that the old and the new recording had.
 */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "core/progress.h"
#include "core/text.h"
#include "record/lock.h"
#include "record/recording.h"
#include "record/replace.h"
#include "rheolog/same.h"

typedef struct blessing_files {
    const char *old_path, *new_path, *because;
    bool shrink;
    rheo_recording *old, *new;        /* old: NULL if none can be read */
    rheo__found found;                /* at old_path; another blessing may replace it while this one compares */
    const char *told;                 /* the reason, and what was compared */
    const rheo_same_options *options; /* NULL: no verdict is asked for */
    bool required;
    rheo_same_result *same;
} blessing_files;

static rheo_result check_new(const char *path, rheo_error *error)
{
    rheo_verification v;
    RHEO__TRY(rheo_verify(path, &v, error));
    if (v.verdict == RHEO_SAME)
        return RHEO_OK;
    return rheo__fail(error, v.verdict == RHEO_DIFFERS ? RHEO_ERROR_DIFFERS : RHEO_ERROR_FORMAT,
                      "%.200s cannot be blessed, since this build does not verify it: %.280s", path, v.message);
}

static rheo_result check_because(const char *because, rheo_error *error)
{
    const char *c = because;
    while (*c == ' ' || *c == '\t' || *c == '\n')
        c++;
    if (!*c || strlen(because) > 4096)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "a blessing needs a reason of 1 to 4096 bytes: what changed, and why that is right");
    return RHEO_OK;
}

/* Whether the new recording adds nothing to the old one. */
static bool is_unchanged(const blessing_files *f, const rheo_verification *difference)
{
    const rheo_recording *a = f->old, *b = f->new;
    return a && difference->verdict == RHEO_SAME && a->head.full == b->head.full && a->blessing_count > 0 &&
           (a->members || !b->members);
}

/* A golden recording that has become smaller guards less, and nothing else would tell. */
static rheo_result check_shrink(const blessing_files *f, rheo_error *error)
{
    const rheo_recording *a = f->old, *b = f->new;
    char less[160] = "";
    if (!a || f->shrink)
        return RHEO_OK;
    if (b->last_step < a->last_step || b->first_step > a->first_step)
        snprintf(less, sizeof less, "it has steps %llu to %llu, the new one %llu to %llu",
                 (unsigned long long)a->first_step, (unsigned long long)a->last_step,
                 (unsigned long long)b->first_step, (unsigned long long)b->last_step);
    else if (a->head.full && !b->head.full)
        snprintf(less, sizeof less, "it has the state of every step (--full), the new one does not");
    else if (a->members && !b->members)
        snprintf(less, sizeof less,
                 "it has members, the new one does not (`rheolog same NEW --keep-members` makes them)");
    else if (b->head.field_count < a->head.field_count)
        snprintf(less, sizeof less, "its worlds have %u fields, those of the new one %u", a->head.field_count,
                 b->head.field_count);
    if (!less[0])
        return RHEO_OK;
    return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%.200s would shrink: %s; if that is meant, allow it (--shrink)",
                      f->old_path, less);
}

static void describe_steps(const rheo_recording *r, char text[80])
{
    snprintf(text, 80, "%llu to %llu%s%s", (unsigned long long)r->first_step, (unsigned long long)r->last_step,
             r->has_failure ? " and a failure" : "", r->head.full ? " with states" : "");
}

/* The reason that is stored, with what was compared. From malloc; NULL: no memory. */
static char *describe(const blessing_files *f, const rheo_verification *d)
{
    char was[80] = "", is[80], what[160];
    const size_t size = strlen(f->because) + 512;
    char *text = malloc(size);
    describe_steps(f->new, is);
    if (f->old)
        describe_steps(f->old, was);
    if (d->verdict == RHEO_NOT_COMPARED)
        snprintf(what, sizeof what, "not compared, there was no recording");
    else if (d->verdict == RHEO_UNREADABLE)
        snprintf(what, sizeof what, "not compared, the old recording could not be");
    else if (d->verdict == RHEO_SAME || d->lengths_differ)
        snprintf(what, sizeof what, "compared, %llu step%s the same", (unsigned long long)d->steps,
                 d->steps == 1 ? " is" : "s are");
    else
        snprintf(what, sizeof what, "compared, differs at step %llu: %s after stage %s",
                 (unsigned long long)d->first.step, d->first.field, d->first.stage[0] ? d->first.stage : "(start)");
    if (!text)
        return NULL;
    snprintf(text, size, "%s [%s; steps %s%s%s]", f->because, what, is, f->old ? ", before " : "", was);
    rheo__text_make_printable(text);
    return text;
}

static bool has_blessing(const rheo_recording *r, const rheo_blessing *blessing)
{
    for (uint32_t i = 0; r && i < r->blessing_count; i++)
        if (strcmp(r->blessings[i].because, blessing->because) == 0 &&
            strcmp(r->blessings[i].build, blessing->build) == 0)
            return true;
    return false;
}

/* The new recording with the mark; the reasons of the old one, those that only the new one has, and this one. */
static rheo_result write_blessed(rheo__writer *to, const void *user, rheo_error *error)
{
    const blessing_files *f = user;
    rheo_recording *r = f->new;
    RHEO__TRY(rheo__recording_copy(r, 0, r->head_end, to, error));
    if (!r->golden)
        RHEO__TRY(rheo__golden_write(to, error));
    const uint64_t moved = to->written - r->head_end;
    RHEO__TRY(rheo__recording_copy(r, r->head_end, r->end, to, error));
    for (uint32_t i = 0; f->old && i < f->old->blessing_count; i++)
        RHEO__TRY(rheo__blessing_write(to, r->last_step, &f->old->blessings[i], error));
    for (uint32_t i = 0; i < r->blessing_count; i++)
        if (!has_blessing(f->old, &r->blessings[i]))
            RHEO__TRY(rheo__blessing_write(to, r->last_step, &r->blessings[i], error));
    const rheo_blessing blessing = {.because = f->told,
                                    .build = rheo_build(),
                                    .verdict = f->same->verdict,
                                    .at_least = f->options ? f->options->at_least : RHEO_SAMENESS_UNKNOWN,
                                    .same = f->same->message};
    RHEO__TRY(rheo__blessing_write(to, r->last_step, &blessing, error));
    rheo__keep_mode(f->old_path, to);
    return rheo__recording_copy_end(r, moved, to, error);
}

static rheo_result replace(blessing_files *f, const rheo_verification *difference, rheo_error *error)
{
    char *told = describe(f, difference);
    f->told = told;
    const rheo_result result = told ? rheo__write_beside(f->old_path, &f->found, write_blessed, f, error)
                                    : rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to bless %.300s", f->old_path);
    free(told);
    return result;
}

/* Damage or an old format may be the reason for the blessing, but only --shrink gives up what cannot be read. */
static rheo_result open_old(blessing_files *f, rheo_error *error)
{
    rheo_error why;
    const rheo_result result = rheo_recording_open(f->old_path, &f->old, &why);
    if (result == RHEO_ERROR_MEMORY)
        return rheo__fail(error, result, "%s", why.message);
    if (f->shrink || (result == RHEO_OK && f->old->complete))
        return RHEO_OK;
    if (result == RHEO_OK)
        rheo__in_file(f->old_path, f->old->fault_result, &f->old->fault, &why);
    return rheo__fail(
        error, RHEO_ERROR_ARGUMENT,
        "%.150s cannot be replaced unread, since what it guards and its reasons would be lost; restore it, "
        "or, if that is meant, allow it (--shrink); %.200s",
        f->old_path, why.message);
}

static rheo_result open_found(blessing_files *f, rheo_error *error)
{
    RHEO__TRY(rheo__is_replaceable(f->old_path, error));
    f->found.file = fopen(f->old_path, "rb");
    return f->found.file ? RHEO_OK
                         : rheo__fail(error, RHEO_ERROR_FILE, "cannot read %.300s: %s", f->old_path, strerror(errno));
}

/* Whether the steps that both recordings have were given the same commands. */
static bool same_commands(rheo_recording *a, rheo_recording *b)
{
    const uint64_t last = a->last_step < b->last_step ? a->last_step : b->last_step;
    for (uint64_t i = 0;; i++) {
        rheo_command x = {.step = UINT64_MAX}, y = {.step = UINT64_MAX};
        const bool more_x = rheo_recording_command(a, i, &x, NULL) == RHEO_OK && x.step <= last,
                   more_y = rheo_recording_command(b, i, &y, NULL) == RHEO_OK && y.step <= last;
        if (!more_x && !more_y)
            return true;
        if (more_x != more_y || x.step != y.step || x.kind != y.kind || strcmp(x.text, y.text) != 0)
            return false;
    }
}

/* Whether both recordings are of the same run, so that it is only the program that changed. */
static bool is_same_run(const blessing_files *f, const rheo_verification *d)
{
    const bool compared = d->verdict == RHEO_SAME || d->verdict == RHEO_DIFFERS;
    const bool other_start = d->verdict == RHEO_DIFFERS && !d->lengths_differ && d->first.step == d->first_step[0];
    return f->old && f->old->complete && compared && d->parameter_count == 0 &&
           d->first_step[0] == d->first_step[1] && !other_start && same_commands(f->old, f->new);
}

/* How far the change goes from the old recording to this build. */
static rheo_result find_verdict(blessing_files *f, const rheo_verification *d, rheo_error *error)
{
    rheo_error why;
    rheo_result result = RHEO_OK;
    if (!f->options)
        return RHEO_OK;
    if (is_same_run(f, d))
        result = rheo_same(f->old_path, f->options, f->same, &why);
    else
        snprintf(f->same->message, sizeof f->same->message, "unknown: the two recordings are not of the same run");
    if (result != RHEO_OK && result != RHEO_ERROR_UNSUPPORTED) /* a world of other stages has no verdict */
        return rheo__fail(error, result, "%s", why.message);
    if (!f->required || f->same->verdict >= f->options->at_least)
        return RHEO_OK;
    return rheo__fail(error, RHEO_ERROR_DIFFERS, "%.100s is not replaced, since at least %s is asked for; %.360s",
                      f->old_path, rheo_sameness_name(f->options->at_least), f->same->message);
}

static rheo_result bless(blessing_files *f, rheo_verification *difference, rheo_error *error)
{
    RHEO__TRY(check_because(f->because, error));
    const bool exists = rheo__file_exists(f->old_path);
    if (exists)
        RHEO__TRY(open_found(f, error));
    RHEO__TRY(check_new(f->new_path, error));
    RHEO__TRY(rheo_recording_open(f->new_path, &f->new, error));
    if (exists) {
        RHEO__TRY(rheo_diff(f->old_path, f->new_path, difference, error));
        RHEO__TRY(open_old(f, error));
    } else {
        snprintf(difference->message, sizeof difference->message, "not compared: there is no %.300s yet",
                 f->old_path);
    }
    /* rheo_diff() may have left out values instead of stopping. */
    RHEO__TRY(rheo__progress("comparing", 1, 1, error));
    if (is_unchanged(f, difference))
        return RHEO_OK;
    RHEO__TRY(check_shrink(f, error));
    RHEO__TRY(find_verdict(f, difference, error));
    return replace(f, difference, error);
}

rheo_result rheo_bless_same(const char *old_path, const char *new_path, const char *because, bool shrink,
                            const rheo_same_options *options, bool required, rheo_same_result *same,
                            rheo_verification *difference, rheo_error *error)
{
    memset(difference, 0, sizeof *difference);
    memset(same, 0, sizeof *same);
    blessing_files f = {.old_path = old_path,
                        .new_path = new_path,
                        .because = because,
                        .shrink = shrink,
                        .options = options,
                        .required = required,
                        .same = same};
    rheo_result result = bless(&f, difference, error);
    rheo_recording_close(f.old);
    rheo_recording_close(f.new);
    if (f.found.file)
        fclose(f.found.file);
    return result;
}

rheo_result rheo_bless(const char *old_path, const char *new_path, const char *because, bool shrink,
                       rheo_verification *difference, rheo_error *error)
{
    rheo_same_result same;
    return rheo_bless_same(old_path, new_path, because, shrink, NULL, false, &same, difference, error);
}
