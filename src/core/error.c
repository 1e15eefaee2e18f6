/* Names of results, texts of errors, and a description of this build. */
#include "core/error.h"

#include <stdarg.h>
#include "core/text.h"

rheo_result rheo__fail(rheo_error *error, rheo_result result, const char *format, ...)
{
    if (error) {
        va_list arguments;
        va_start(arguments, format);
        rheo__text_vprint(error->message, sizeof error->message, format, arguments);
        va_end(arguments);
        rheo__text_make_printable(error->message); /* names and words in a file may hold anything */
        rheo__reword(error->message);
    }
    return result;
}

#ifdef RHEO__REWORDED
void rheo__reword(char *text)
{
    for (; *text; text++)
        if (*text >= 'a' && *text <= 'z')
            *text = (char)(*text - 'a' + 'A');
}
#endif

const char *rheo_result_name(rheo_result result)
{
    switch (result) {
    case RHEO_OK:
        return "ok";
    case RHEO_ERROR_ARGUMENT:
        return "bad argument";
    case RHEO_ERROR_STATE:
        return "bad state";
    case RHEO_ERROR_MEMORY:
        return "out of memory";
    case RHEO_ERROR_FILE:
        return "file error";
    case RHEO_ERROR_FORMAT:
        return "bad format";
    case RHEO_ERROR_UNSUPPORTED:
        return "not supported by this build";
    case RHEO_ERROR_ENVIRONMENT:
        return "unfit floating-point environment";
    case RHEO_ERROR_DIFFERS:
        return "differs from the recording";
    case RHEO_ERROR_STOPPED:
        return "stopped on request";
    case RHEO_ERROR_LIMIT:
        return "limit of the recording reached";
    }
    return "unknown result";
}

const char *rheo_version(void)
{
    return RHEO_VERSION;
}

#if defined(__clang__)
#define TEXT_(number) #number
#define TEXT(number) TEXT_(number)
/* __clang_version__ ends with a blank. */
#define COMPILER "clang " TEXT(__clang_major__) "." TEXT(__clang_minor__) "." TEXT(__clang_patchlevel__)
#elif defined(__GNUC__)
#define COMPILER "gcc " __VERSION__
#else
#define COMPILER "unknown compiler"
#endif

#if defined(__OPTIMIZE__)
#define OPTIMISED "optimised"
#else
#define OPTIMISED "not optimised"
#endif

#if defined(__AVX512F__)
#define MACHINE "x86_64 avx512"
#elif defined(__AVX2__)
#define MACHINE "x86_64 avx2"
#elif defined(__x86_64__)
#define MACHINE "x86_64"
#elif defined(__i386__)
#define MACHINE "i386"
#elif defined(__aarch64__)
#define MACHINE "aarch64"
#elif defined(__arm__)
#define MACHINE "arm"
#elif defined(__riscv)
#define MACHINE "riscv"
#elif defined(__powerpc64__)
#define MACHINE "ppc64"
#elif defined(__s390x__)
#define MACHINE "s390x"
#elif defined(__wasm__)
#define MACHINE "wasm"
#else
#define MACHINE "unknown machine"
#endif

#if RHEO_DOUBLE
#define REAL "double"
#else
#define REAL "float"
#endif

const char *rheo_build(void)
{
    return "rheolog " RHEO_VERSION ", " COMPILER ", " OPTIMISED ", " REAL ", " MACHINE;
}
