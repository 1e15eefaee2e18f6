/*
 * A run depends on its definition and commands only. It does not depend on addresses or contents of memory, the
 * stack, locale, environment, folder, time zone or other worlds. Every kind of scene is run and recorded under each
 * of these conditions. The hashes of every step, the bytes of the recording and its verification must equal those of
 * a plain run.
 *
 * Leaks prove that each condition would be noticed. A leak lets the quantity that the condition changes (an address,
 * fresh memory, the decimal point, ...) into the state between steps.
 */
#define _GNU_SOURCE /* MAP_ANONYMOUS, MAP_NORESERVE, personality() */

#include <errno.h>
#include <locale.h>
#include <math.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/personality.h>
#endif

#include "arena.h"
#include "support.h"

/* ---- Scenes ---- */

enum { SCENES = 5, STEPS = 30 };
static const char *const scene_names[SCENES] = {"lively", "force vibrators", "without history", "spheres",
                                                "without springs"};

static rheo_scene scene_of(int which)
{
    rheo_scene scene = lively_scene();
    scene.settle.time = 0.1;
    switch (which) {
    case 1:
        scene.world.vibrators.kind = RHEO_VIBRATOR_FORCE;
        scene.world.vibrators.height = 6;
        scene.world.ball.radius = 0;
        scene.ball.clearance = -1;
        break;
    case 2:
        scene.world.history.stiffness = 0;
        break;
    case 3:
        scene = rheo_default_scene();
        scene.fill = some_fills();
        scene.fill_count = 2;
        for (int i = 0; i < 2; i++) {
            fills_of(&scene)[i].kind = RHEO_FILL_SPHERE;
            fills_of(&scene)[i].centre[0] = i ? 9 : -1;
            fills_of(&scene)[i].centre[1] = 7;
            fills_of(&scene)[i].radius = 5;
            fills_of(&scene)[i].velocity[0] = i ? -8 : 4;
            fills_of(&scene)[i].jitter = 0.25;
        }
        scene.world.walls.plane = some_walls();
        scene.world.walls.count = 1;
        walls_of(&scene.world)[0] = (rheo_wall){{0, 0, 0}, {0.1, 1, 0}};
        scene.world.springs.solver = RHEO_SOLVER_IMPLICIT;
        scene.world.springs.rest_length = RHEO_REST_SUPPORT;
        scene.world.history.weights = RHEO_WEIGHTS_L1;
        scene.world.history.window_seconds = 0.4;
        break;
    case 4:
        scene.world.springs.stiffness = 0;
        scene.world.vibrators.count = 0;
        break;
    default:
        break;
    }
    return scene;
}

/* Gives commands before a step; scenes without ball or vibrators skip theirs. */
static void commands(rheo_world *world, int step)
{
    const double impulse[3] = {40, -3, 11}, point[3] = {7, 12, 8};
    const rheo_real position[9] = {4, 30, 4, 5, 31, 4, 6, 33, 5}, velocity[9] = {0, -9, 0, 1, -9, 0, 0, -8, 2};
    if (step == 4)
        OK(rheo_world_set(world, "fluid.linear_viscosity", "0.7", &error));
    if (step == 6 && rheo_world_body_count(world))
        OK(rheo_world_push_body(world, 0, impulse, point, &error));
    if (step == 9)
        OK(rheo_world_add_particles(world, 3, position, velocity, &error));
    if (step == 12 && rheo_world_vibrator_count(world))
        OK(rheo_world_move_vibrator(world, 0, 5.5, 3.25, &error));
    if (step == 14)
        OK(rheo_world_set(world, "step", "0.03", &error));
    if (step == 16 && rheo_world_history_window(world))
        OK(rheo_world_set(world, "history.stiffness", "120.25", &error));
}

/* ---- Leaks: a forbidden influence on the state ---- */

typedef enum leak_kind {
    LEAK_NOTHING,
    LEAK_ONE_VALUE, /* a position changes by one ulp */
    LEAK_ADDRESS,
    LEAK_FRESH,
    LEAK_STACK,
    LEAK_LOCALE,
    LEAK_ENVIRONMENT,
    LEAK_FOLDER,
    LEAK_ZONE,
    LEAK_WORLDS, /* number of worlds made earlier */
} leak_kind;

enum { LEAK_STEP = 17, LEAK_PARTICLE = 108 };

static uint32_t worlds_made;

static uint32_t text_sum(const char *text)
{
    uint32_t sum = 0;
    for (; text && *text; text++)
        sum = 31 * sum + (unsigned char)*text;
    return sum;
}

__attribute__((noinline)) static uint32_t leaked(leak_kind leak, const rheo_world *world)
{
    char text[4096];
    if (leak == LEAK_ADDRESS)
        return (uint32_t)((uintptr_t)rheo_world_positions(world) >> 6); /* blocks are aligned to 64 bytes */
    if (leak == LEAK_FRESH) {
        uint32_t *memory = __wrap_malloc(256), word = 0;
        if (arena.order != ORDER_PLAIN)
            word = memory[20];
        __wrap_free(memory);
        return word;
    }
    if (leak == LEAK_STACK)
        return (uint32_t)((uintptr_t)text >> 4);
    if (leak == LEAK_LOCALE)
        snprintf(text, sizeof text, "%g", 0.5);
    if (leak == LEAK_ENVIRONMENT)
        snprintf(text, sizeof text, "%s", getenv("HOME") ? getenv("HOME") : "none");
    if (leak == LEAK_FOLDER)
        assert_non_null(getcwd(text, sizeof text));
    if (leak == LEAK_ZONE) {
        const time_t then = 1000000000;
        snprintf(text, sizeof text, "%d", localtime(&then)->tm_hour);
    }
    if (leak == LEAK_WORLDS)
        return worlds_made;
    return leak == LEAK_NOTHING || leak == LEAK_ONE_VALUE ? 0 : text_sum(text);
}

/* Changes a position by one ulp, or adds each byte of the value to the position of a particle inside the fluid. */
static void let_in(leak_kind leak, const rheo_world *world)
{
    rheo_real *x = (rheo_real *)(uintptr_t)(rheo_world_positions(world) + 3 * LEAK_PARTICLE);
    const uint32_t value = leaked(leak, world);
    if (leak == LEAK_ONE_VALUE)
        *x = RHEO_DOUBLE ? (rheo_real)nextafter((double)*x, 1e9) : (rheo_real)nextafterf((float)*x, 1e9F);
    else
        for (uint32_t i = 0; i < sizeof value; i++)
            x[3 * i] += (rheo_real)(value >> 8 * i & 0xff) * (rheo_real)0x1p-10;
}

/* ---- A run, step by step, so that two runs can alternate ---- */

typedef struct outcome {
    uint64_t hash[SCENES][STEPS + 1];
    uint64_t size[SCENES], bytes[SCENES]; /* size and hash of the recording */
    uint64_t looked[SCENES];              /* queries and metrics */
    uint64_t played[SCENES];              /* a step that a player returned to */
    uint64_t verdict[SCENES], verified[SCENES];
} outcome;

typedef struct run {
    int scene, step;
    leak_kind leak;
    bool dirty; /* fill the stack with a word before every step */
    rheo_world *world;
    rheo_recorder *recorder;
    char path[4200];
} run;

static char folder[4096]; /* folder of the recordings */

static uint64_t sum(const void *data, size_t size)
{
    uint64_t h = UINT64_C(0xcbf29ce484222325);
    for (const uint8_t *p = data; size--; p++)
        h = (h ^ *p) * UINT64_C(0x100000001b3);
    return h;
}

__attribute__((noinline)) static void dirty_stack(uint32_t seed)
{
    volatile uint32_t garbage[16384];
    const uint32_t words[] = {0xffffffff, 0x7fc00000, 0x3f800000, 0xa5a5a5a5};
    for (size_t i = 0; i < sizeof garbage / sizeof *garbage; i++)
        garbage[i] = seed % 5 < 4 ? words[seed % 5] : seed * (uint32_t)i;
}

static void run_begin(run *r, int scene, leak_kind leak, bool dirty)
{
    static uint32_t number;
    *r = (run){.scene = scene, .leak = leak, .dirty = dirty};
    rheo_scene s = scene_of(scene);
    if (arena.order != ORDER_PLAIN)
        s.world.allocator = (rheo_allocator){world_allocate, world_release, NULL};
    if (dirty)
        dirty_stack(number);
    OK(rheo_scene_create_world(&s, &r->world, &error));
    worlds_made++;
    assert_true(rheo_world_particle_count(r->world) > LEAK_PARTICLE);
    snprintf(r->path, sizeof r->path, "%s/test_independence_%ld_%u.rlog", folder, (long)getpid(), ++number);
    const rheo_record_options options = {.scene = "independence", .keyframe_spacing = 7, .full = scene % 2};
    OK(rheo_recorder_open(r->world, r->path, &options, &r->recorder, &error));
}

static void run_step(run *r, outcome *o)
{
    o->hash[r->scene][r->step] = rheo_world_hash(r->world);
    commands(r->world, r->step);
    if (r->step == LEAK_STEP)
        let_in(r->leak, r->world);
    if (r->dirty)
        dirty_stack((uint32_t)r->step);
    OK(rheo_recorder_step(r->recorder, &error));
    r->step++;
}

static uint64_t look(const rheo_world *world)
{
    const uint32_t n = rheo_world_particle_count(world);
    double *density = malloc(2 * n * sizeof *density);
    rheo_top_entry *top = malloc(20 * sizeof *top);
    size_t count;
    OK(rheo_world_densities(world, density, density + n, &error));
    uint64_t h = sum(density, 2 * n * sizeof *density);
    OK(rheo_world_top(world, RHEO_TOP_DENSEST, 20, top, &count, &error));
    for (size_t i = 0; i < count; i++)
        h = 31 * h + top[i].id;
    for (uint32_t i = 0; i < rheo_world_metric_count(world); i++) {
        const double metric = rheo_world_metric(world, i);
        h = 31 * h + sum(&metric, sizeof metric);
    }
    free(density);
    free(top);
    return h;
}

static void run_end(run *r, outcome *o)
{
    const int s = r->scene;
    o->hash[s][STEPS] = rheo_world_hash(r->world);
    o->looked[s] = look(r->world);
    OK(rheo_recorder_close(r->recorder, &error));
    rheo_world_destroy(r->world);
    size_t size;
    uint8_t *bytes = read_file(r->path, &size);
    o->size[s] = size;
    remove(r->path);
    /* The same build and zlib make the same bytes. */
    o->bytes[s] = sum(bytes, (size_t)o->size[s]);
    rheo_verification v;
    OK(rheo_verify_memory(bytes, (size_t)o->size[s], &v, &error));
    o->verdict[s] = v.verdict;
    o->verified[s] = v.steps;
    if (v.verdict == RHEO_SAME) {
        const rheo_allocator allocator = {world_allocate, world_release, NULL};
        rheo_recording *recording;
        rheo_player *player;
        OK(rheo_recording_open_memory(bytes, (size_t)o->size[s], &recording, &error));
        OK(rheo_player_open(recording, arena.order == ORDER_PLAIN ? NULL : &allocator, &player, &error));
        OK(rheo_player_seek(player, STEPS - 4, &error));
        OK(rheo_player_step_back(player, &error));
        o->played[s] = rheo_world_hash(rheo_player_world(player));
        rheo_player_close(player);
        rheo_recording_close(recording);
    }
    free(bytes);
}

static void run_all(outcome *o, leak_kind leak, bool dirty)
{
    memset(o, 0, sizeof *o);
    for (int scene = 0; scene < SCENES; scene++) {
        run r;
        run_begin(&r, scene, leak, dirty);
        while (r.step < STEPS)
            run_step(&r, o);
        run_end(&r, o);
    }
}

/* ---- Comparing ---- */

static outcome reference;

/* Whether two outcomes are the same; if not, `where` names the difference. */
static bool same(const outcome *a, const outcome *b, char where[160])
{
    for (int s = 0; s < SCENES; s++) {
        for (int step = 0; step <= STEPS; step++)
            if (a->hash[s][step] != b->hash[s][step])
                return snprintf(where, 160, "%s: the hash of step %d", scene_names[s], step), false;
        if (a->size[s] != b->size[s] || a->bytes[s] != b->bytes[s])
            return snprintf(where, 160, "%s: the bytes of the recording", scene_names[s]), false;
        if (a->looked[s] != b->looked[s])
            return snprintf(where, 160, "%s: metrics, densities or their order", scene_names[s]), false;
        if (a->verdict[s] != b->verdict[s] || a->verified[s] != b->verified[s])
            return snprintf(where, 160, "%s: what the recording is verified as", scene_names[s]), false;
        if (a->played[s] != b->played[s])
            return snprintf(where, 160, "%s: what is played", scene_names[s]), false;
    }
    return true;
}

static void assert_same(const outcome *o, const char *condition)
{
    char where[160];
    if (!same(&reference, o, where))
        fail_msg("%s changes %s", condition, where);
}

/* Proves that a leak of this kind is noticed: its outcome differs with and without the condition. */
static void assert_noticed(const outcome *without, const outcome *o, const char *condition)
{
    char where[160];
    if (same(without, o, where))
        fail_msg("%s is not noticed by what depends on it", condition);
    char expected[160];
    snprintf(expected, sizeof expected, "%s: the hash of step %d", scene_names[0], LEAK_STEP + 1);
    assert_string_equal(where, expected);
}

static int make_reference(void **unused)
{
    (void)unused;
    run_all(&reference, LEAK_NOTHING, false);
    for (int s = 0; s < SCENES; s++) {
        assert_int_equal(reference.verdict[s], RHEO_SAME);
        assert_int_equal(reference.verified[s], STEPS);
        assert_true(reference.played[s] == reference.hash[s][STEPS - 5]);
        for (int t = 0; t < s; t++)
            assert_true(reference.hash[s][STEPS] != reference.hash[t][STEPS]);
    }
    return 0;
}

/* Slow builds take every third condition, which leaves some of each kind. */
static size_t stride(void)
{
    return every() > 1 ? 3 : 1;
}

/* ---- Memory ---- */

static const struct {
    const char *name;
    memory_order order;
    uint32_t fresh, freed;
} memories[] = {
    {"memory upwards, zeros", ORDER_UP, 0, 0},
    {"memory downwards, ones", ORDER_DOWN, 0xffffffff, 0xffffffff},
    {"memory downwards, 0xa5", ORDER_DOWN, 0xa5a5a5a5, 0x5a5a5a5a},
    {"memory with gaps, NaN", ORDER_GAPS, 0x7fc00000, 0x7fc00000},
    {"memory with gaps, signalling NaN", ORDER_GAPS, 0x7f800001, 0xff800001},
    {"memory with other gaps, the number 1", ORDER_GAPS, 0x3f800000, 0x3f800000},
    {"memory used again, 0xa5", ORDER_REUSED, 0xa5a5a5a5, 0xa5a5a5a5},
    {"memory used again, upper half of NaN in double", ORDER_REUSED, 0x7ff80000, 0x7ff80000},
};

enum { MEMORIES = sizeof memories / sizeof *memories };

static void run_in_memory(size_t m, outcome *o, leak_kind leak)
{
    arena_begin(memories[m].order, memories[m].fresh, memories[m].freed, 1 + m);
    run_all(o, leak, false);
    assert_true(arena.from_malloc > 100 && arena.from_worlds > 100 && arena.moved > 10);
    assert_true((arena.reused > 100) == (memories[m].order == ORDER_REUSED));
    arena_end();
}

static void memory_has_no_effect(void **unused)
{
    (void)unused;
    for (size_t m = 0; m < MEMORIES; m += stride()) {
        outcome o;
        run_in_memory(m, &o, LEAK_NOTHING);
        assert_same(&o, memories[m].name);
    }
}

static void an_effect_of_memory_is_noticed(void **unused)
{
    (void)unused;
    outcome up, o;
    run_in_memory(0, &up, LEAK_ADDRESS);
    for (size_t m = stride(); m < MEMORIES; m += stride())
        if (memories[m].order == ORDER_DOWN || memories[m].order == ORDER_GAPS) {
            run_in_memory(m, &o, LEAK_ADDRESS);
            assert_noticed(&up, &o, memories[m].name);
        }
    run_in_memory(0, &up, LEAK_FRESH);
    assert_same(&up, "fresh memory of zeros"); /* these let nothing in */
    for (size_t m = stride(); m < MEMORIES; m += stride()) {
        run_in_memory(m, &o, LEAK_FRESH);
        assert_noticed(&up, &o, memories[m].name);
    }
}

/* The guard of the arena begins at the first byte behind a block, whatever the size. */
static void a_write_behind_a_block_is_noticed(void **unused)
{
    (void)unused;
    for (int order = ORDER_UP; order <= ORDER_REUSED; order++)
        for (size_t bytes = 0; bytes < 40; bytes++)
            for (size_t behind = 0; behind < 16; behind += 5) {
                arena_begin((memory_order)order, 0, 0, 1);
                char *block = world_allocate(bytes, NULL);
                memset(block, 1, bytes);
                world_release(block, NULL);
                block = world_allocate(bytes, NULL);
                block[bytes + behind]++;
                world_release(block, NULL);
                const size_t overruns = arena.overruns;
                arena.overruns = 0;
                arena_end();
                assert_int_equal(overruns, 1);
            }
}

/* ---- The stack ---- */

static void a_dirty_stack_has_no_effect(void **unused)
{
    (void)unused;
    outcome o;
    run_all(&o, LEAK_NOTHING, true);
    assert_same(&o, "a dirty stack");
}

typedef struct thread_run {
    outcome *o;
    leak_kind leak;
    uintptr_t local; /* an address on its stack */
} thread_run;

static void *run_thread(void *context)
{
    thread_run *t = context;
    volatile int local = 0;
    t->local = (uintptr_t)&local;
    run_all(t->o, t->leak, false);
    return NULL;
}

/* Runs on another stack that starts at `offset` and is filled with a word. */
static void run_on_stack(outcome *o, leak_kind leak, size_t offset, uint32_t word)
{
    const size_t size = (size_t)8 << 20;
    char *memory = mmap(NULL, size + 65536, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    assert_true(memory != MAP_FAILED);
    fill(memory, size + 65536, word);
    pthread_attr_t attributes;
    pthread_t thread;
    thread_run t = {.o = o, .leak = leak};
    assert_int_equal(pthread_attr_init(&attributes), 0);
    assert_int_equal(pthread_attr_setstack(&attributes, memory + offset, size), 0);
    assert_int_equal(pthread_create(&thread, &attributes, run_thread, &t), 0);
    assert_int_equal(pthread_join(thread, NULL), 0);
#if !SANITIZED /* sanitizers may keep locals elsewhere */
    assert_true(t.local >= (uintptr_t)memory && t.local < (uintptr_t)memory + size + 65536);
#endif
    pthread_attr_destroy(&attributes);
    munmap(memory, size + 65536);
}

static void the_address_of_the_stack_has_no_effect(void **unused)
{
    (void)unused;
    const uint32_t words[] = {0, 0xffffffff, 0xa5a5a5a5, 0x7fc00000, 0x3f800000};
    outcome o, first;
    for (size_t i = 0; i < sizeof words / sizeof *words; i += stride()) {
        run_on_stack(&o, LEAK_NOTHING, 4096 * i, words[i]);
        assert_same(&o, "another stack");
    }
    run_on_stack(&first, LEAK_STACK, 0, 0);
    run_on_stack(&o, LEAK_STACK, 4096 * 5, 0);
    assert_noticed(&first, &o, "another stack");
}

/* ---- Other worlds ---- */

static void other_worlds_have_no_effect(void **unused)
{
    (void)unused;
    /* Other worlds existed earlier, in another order. Freed memory holds their values. */
    outcome o, before;
    for (int i = 0; i < 7; i++) {
        run r;
        run_begin(&r, (3 * i + 1) % SCENES, LEAK_NOTHING, false);
        for (int step = 0; step < 3 * i; step++)
            run_step(&r, &before);
        OK(rheo_recorder_close(r.recorder, &error));
        remove(r.path);
        rheo_world_destroy(r.world);
    }
    run_all(&o, LEAK_NOTHING, false);
    assert_same(&o, "having made other worlds");

    /* Two worlds at a time, all pairs; the second lags some steps. */
    for (int first = 0; first < SCENES; first++)
        for (int second = 0; second < SCENES; second++) {
            if ((size_t)(first + second) % stride() != 0)
                continue;
            outcome one = reference, two = reference;
            run a, b;
            run_begin(&a, first, LEAK_NOTHING, false);
            run_begin(&b, second, LEAK_NOTHING, false);
            while (b.step < STEPS) {
                if (a.step < STEPS)
                    run_step(&a, &one);
                if (a.step > 4)
                    run_step(&b, &two);
            }
            run_end(&a, &one);
            run_end(&b, &two);
            assert_same(&one, "stepping alternately with another world");
            assert_same(&two, "stepping alternately with another world");
        }

    outcome leaking;
    run_all(&before, LEAK_WORLDS, false);
    run_all(&leaking, LEAK_WORLDS, false);
    assert_noticed(&before, &leaking, "having made other worlds");
}

/* ---- Processes with another environment ---- */

/* Observations of a child, to prove that its condition took effect. */
typedef struct report {
    outcome outcome;
    char decimal_point;
    uint32_t fresh; /* a word of fresh memory of the C library */
    uint64_t folder, hour;
} report;

static const char *program;

static int child(int argc, char **argv)
{
    if (argc != 4 || !setlocale(LC_ALL, ""))
        return argc != 4 ? 2 : 78;
    tzset();
    snprintf(folder, sizeof folder, "%s", argv[3]);
    report *r = calloc(1, sizeof *r);
    r->decimal_point = *localeconv()->decimal_point;
#if !SANITIZED
    volatile uint32_t *memory = malloc(5000);
    r->fresh = memory[1000];
    free((void *)(uintptr_t)memory);
#endif
    r->folder = leaked(LEAK_FOLDER, NULL);
    r->hour = leaked(LEAK_ZONE, NULL);
    run_all(&r->outcome, (leak_kind)atoi(argv[2]), false);
    const bool written = fwrite(r, sizeof *r, 1, stdout) == 1 && fflush(stdout) == 0;
    free(r);
    return written ? 0 : 1;
}

typedef struct process {
    const char *name, *folder;
    const char *environment[6];
    size_t padding;       /* bytes of an extra variable, which moves the stack */
    bool unlimited_stack; /* another layout of the address space */
    bool fixed;           /* addresses are not random */
} process;

/* Runs this program again; false if the locale does not exist. */
static bool run_process(const process *p, leak_kind leak, report *r)
{
    int ends[2];
    char number[16], *padding = malloc(p->padding + 3);
    memset(padding, 'x', p->padding + 3);
    padding[1] = '=';
    padding[p->padding + 2] = 0;
    snprintf(number, sizeof number, "%d", (int)leak);
    assert_int_equal(pipe(ends), 0);
    fflush(NULL);
    const pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        char *argv[] = {(char *)(uintptr_t)program, (char *)(uintptr_t) "child", number, folder, NULL}, *envp[8];
        int n = 0;
        for (; p->environment[n]; n++)
            envp[n] = (char *)(uintptr_t)p->environment[n];
        if (p->padding)
            envp[n++] = padding;
        envp[n] = NULL;
        if (p->unlimited_stack) {
            const struct rlimit limit = {RLIM_INFINITY, RLIM_INFINITY};
            struct rlimit is;
            if (setrlimit(RLIMIT_STACK, &limit) != 0 && getrlimit(RLIMIT_STACK, &is) == 0) {
                is.rlim_cur = is.rlim_max;
                setrlimit(RLIMIT_STACK, &is);
            }
        }
#ifdef __linux__
        if (p->fixed)
            personality(ADDR_NO_RANDOMIZE); /* may be forbidden: then it is a plain run */
#endif
        if (dup2(ends[1], 1) != 1 || (p->folder && chdir(p->folder) != 0))
            _exit(3);
        close(ends[0]);
        execve(program, argv, envp);
        _exit(127);
    }
    close(ends[1]);
    FILE *from = fdopen(ends[0], "rb");
    const size_t got = fread(r, sizeof *r, 1, from);
    fclose(from);
    free(padding);
    int status;
    assert_int_equal(waitpid(pid, &status, 0), pid);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 78)
        return false;
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || got != 1)
        fail_msg("%s: the process ended with %#x", p->name, (unsigned)status);
    return true;
}

static const process plain = {.name = "a process", .environment = {"HOME=/root", "TZ=UTC"}};

static void the_process_has_no_effect(void **unused)
{
    (void)unused;
    const process others[] = {
        {.name = "an empty environment"},
        {.name = "another environment",
         .environment = {"HOME=/nonexistent", "TMPDIR=/nonexistent", "PATH=", "LANG=C", "USER=nobody"}},
        {.name = "another time zone", .environment = {"TZ=ABC-13:45"}},
        {.name = "another folder", .folder = "/"},
        {.name = "a large environment", .padding = 100003},
        {.name = "a stack that starts elsewhere", .padding = 1234},
        {.name = "another layout of the address space", .unlimited_stack = true},
        {.name = "fixed addresses", .fixed = true},
        {.name = "fixed addresses and a stack that starts elsewhere", .fixed = true, .padding = 77},
        {.name = "malloc that fills memory",
         .environment = {"MALLOC_PERTURB_=165", "MALLOC_ARENA_MAX=1", "MALLOC_TOP_PAD_=100000"}},
        {.name = "malloc that maps every block",
         .environment = {"MALLOC_MMAP_THRESHOLD_=1", "MALLOC_MMAP_MAX_=60000"}},
        {.name = "a C library without its fast functions",
         .environment = {"GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX512F,-AVX512VL,-AVX2,-AVX,-FMA,-ERMS,-SSE4_1:"
                         "glibc.malloc.tcache_count=0"}},
    };
    report *r = malloc(2 * sizeof *r);
    assert_true(run_process(&plain, LEAK_NOTHING, r));
    assert_same(&r->outcome, plain.name);
    for (size_t i = 0; i < sizeof others / sizeof *others; i += stride()) {
        assert_true(run_process(&others[i], LEAK_NOTHING, r + 1));
        assert_same(&r[1].outcome, others[i].name);
        if (others[i].folder)
            assert_true(r[0].folder != r[1].folder);
        if (strstr(others[i].name, "zone"))
            assert_true(r[0].hour != r[1].hour);
#if defined(__GLIBC__) && !SANITIZED
        if (strstr(others[i].name, "fills"))
            assert_int_equal(r[1].fresh, 0x5a5a5a5a); /* 165 inverted */
#endif
    }
    /* Each of them would be noticed. */
    const struct {
        leak_kind leak;
        size_t other;
    } leaks[] = {{LEAK_ENVIRONMENT, 0}, {LEAK_ENVIRONMENT, 1}, {LEAK_ZONE, 2}, {LEAK_FOLDER, 3}, {LEAK_STACK, 4}};
    for (size_t i = 0; i < sizeof leaks / sizeof *leaks; i += stride()) {
        assert_true(run_process(&plain, leaks[i].leak, r));
        assert_true(run_process(&others[leaks[i].other], leaks[i].leak, r + 1));
        assert_noticed(&r[0].outcome, &r[1].outcome, others[leaks[i].other].name);
    }
    free(r);
}

static void the_locale_has_no_effect(void **unused)
{
    (void)unused;
    const process german = {.name = "a German locale", .environment = {"LC_ALL=de_DE.UTF-8", "LANG=de_DE.UTF-8"}};
    report *r = malloc(2 * sizeof *r);
    if (!run_process(&german, LEAK_NOTHING, r)) {
        free(r);
        print_message("there is no locale de_DE.UTF-8 here\n");
        skip();
    }
    assert_int_equal(r->decimal_point, ',');
    assert_same(&r->outcome, german.name);
    assert_true(run_process(&plain, LEAK_LOCALE, r));
    assert_true(run_process(&german, LEAK_LOCALE, r + 1));
    assert_noticed(&r[0].outcome, &r[1].outcome, german.name);
    free(r);
}

/* ---- The test itself can fail ---- */

static void one_value_is_noticed(void **unused)
{
    (void)unused;
    outcome o;
    run_all(&o, LEAK_ONE_VALUE, false);
    assert_noticed(&reference, &o, "one ulp of a position");
    for (int s = 0; s < SCENES; s++) {
        /* All scenes notice the leak after its step, and so do their recordings, which do not contain it. */
        assert_true(o.hash[s][LEAK_STEP] == reference.hash[s][LEAK_STEP]);
        for (int step = LEAK_STEP + 1; step <= STEPS; step++)
            assert_true(o.hash[s][step] != reference.hash[s][step]);
        assert_true(o.bytes[s] != reference.bytes[s]);
        if (sizeof(rheo_real) == 4) /* an ulp of double need not change a query */
            assert_true(o.looked[s] != reference.looked[s]);
        assert_int_equal(o.verdict[s], RHEO_DIFFERS);
        assert_int_equal(o.verified[s], LEAK_STEP);
    }
    /* Results other than hashes are compared too. */
    char where[160];
    o = reference;
    o.bytes[2]++;
    assert_false(same(&reference, &o, where));
    assert_string_equal(where, "without history: the bytes of the recording");
    o = reference;
    o.looked[4]++;
    assert_false(same(&reference, &o, where));
    o = reference;
    o.played[1]++;
    assert_false(same(&reference, &o, where));
    o = reference;
    o.verdict[0]++;
    assert_false(same(&reference, &o, where));
}

int main(int argc, char **argv)
{
    program = argv[0];
    if (argc > 1 && strcmp(argv[1], "child") == 0)
        return child(argc, argv);
    if (!getcwd(folder, sizeof folder))
        return 2;
    char *absolute = realpath(argv[0], NULL); /* children start in other folders */
    if (absolute)
        program = absolute;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_value_is_noticed),           cmocka_unit_test(memory_has_no_effect),
        cmocka_unit_test(an_effect_of_memory_is_noticed), cmocka_unit_test(a_write_behind_a_block_is_noticed),
        cmocka_unit_test(a_dirty_stack_has_no_effect),    cmocka_unit_test(the_address_of_the_stack_has_no_effect),
        cmocka_unit_test(other_worlds_have_no_effect),    cmocka_unit_test(the_process_has_no_effect),
        cmocka_unit_test(the_locale_has_no_effect),
    };
    const int failed = cmocka_run_group_tests(tests, make_reference, NULL);
    free(absolute);
    return failed;
}
