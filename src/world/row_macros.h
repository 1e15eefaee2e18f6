/*
 * Columns of the files *.def as initialisers of rheo__parameter_row. Define before including one: OWNER (the struct
 * with the members), MODELS (the set of models that have the parameters) and SCENE_ONLY.
 */
#ifndef RHEO__WORLD_ROW_MACROS_H
#define RHEO__WORLD_ROW_MACROS_H

#define MODELS_ALL UINT32_MAX

#define LIVE true
#define FIXED false

#define TINY 1e-12 /* as a float it has a square other than 0 */
#define EXACT RHEO__EXACT
#define ANY .minimum = -RHEO__UNBOUNDED, .maximum = RHEO__UNBOUNDED
#define AT_LEAST(low) .minimum = low, .maximum = RHEO__UNBOUNDED
#define RANGE(low, high) .minimum = low, .maximum = high
#define OPEN_RANGE(low, high) .minimum = low, .maximum = high, .above_minimum = true, .below_maximum = true
#define XYZ(x, y, z) x, y, z

/* The index of a word is its enumerator; the order in which they are given here does not matter. */
#define WORDS(...)                                                                     \
    .choices = (const char *const[]){__VA_ARGS__},                                     \
    .choice_count = sizeof((const char *const[]){__VA_ARGS__}) / sizeof(const char *), \
    .maximum = sizeof((const char *const[]){__VA_ARGS__}) / sizeof(const char *) - 1
#define NAME_OF_MODEL(name) #name,
#define OFF_ON WORDS([RHEO_AS_PRINTED_OFF] = "off", [RHEO_AS_PRINTED_ON] = "on")

/* Does not compile unless the member has the type that its kind of parameter is stored in. */
#define OFFSET(member, c_type) _Generic(((OWNER *)0)->member, c_type : offsetof(OWNER, member))

#define HEAD(name, kind, unit_, is_live, meaning)                                                                    \
    .path = name, .type = RHEO_PARAMETER_##kind, .unit = unit_, .live = is_live, .about = meaning, .models = MODELS, \
    .scene_only = SCENE_ONLY
#define REAL(member, unit, range, initial, live, meaning) \
    {{HEAD(#member, REAL, unit, live, meaning), range}, OFFSET(member, double), 0, {initial}},
#define INTEGER(member, unit, range, initial, live, meaning) \
    {{HEAD(#member, INTEGER, unit, live, meaning), range}, OFFSET(member, uint64_t), 0, {initial}},
#define VECTOR(member, unit, range, initial, live, meaning) \
    {{HEAD(#member, VECTOR, unit, live, meaning), range}, OFFSET(member, double *), 0, {initial}},
#define WINDOW(member, unit, range, initial, live, meaning) \
    {{HEAD(#member, WINDOW, unit, live, meaning), range},   \
     OFFSET(member, uint32_t),                              \
     OFFSET(member##_seconds, double),                      \
     {initial}},
#define CHOICE(member, initial, live, words, meaning) \
    {{HEAD(#member, CHOICE, "", live, meaning), words}, OFFSET(member, uint32_t), 0, {initial}},
#define DEFAULT(member, ...)
#define OLD_NAME(old, now)

#endif
