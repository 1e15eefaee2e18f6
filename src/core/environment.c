/*
 * The floating-point environment (core/environment.h): reports the faults found by the probe of the SIMD variant in
 * use.
 *
 * Rounding mode and denormals are settings of the thread. Other code may change them at any time (a library linked
 * with -ffast-math does so when it is loaded), so every step checks them. How the compiler translated arithmetic is a
 * property of the build; checking it as well costs little.
 */
#include "core/environment.h"

#include "core/error.h"
#include "core/probe.h"

/* Faults in the order of reporting: those of the thread spoil the probes of the build. */
static const struct {
    rheo__trouble what;
    const char *message;
} TROUBLES[] = {
    {RHEO__TROUBLE_ROUNDING,
     "the floating-point rounding mode is not to nearest; restore it with fesetround(FE_TONEAREST)"},
    {RHEO__TROUBLE_DENORMALS,
     "denormal numbers are flushed to zero in this thread (a library linked with -ffast-math does that when "
     "it is loaded); clear the FTZ and DAZ bits"},
    {RHEO__TROUBLE_VECTORS,
     "this build calculates with vector instructions that flush denormal numbers to zero, as NEON of 32-bit ARM "
     "does; compile rheolog for one without them (-mfpu=vfpv3-d16)"},
    {RHEO__TROUBLE_REORDERED,
     "this build adds in another order than is written, or in a wider type; compile rheolog without "
     "-fassociative-math (-funsafe-math-optimizations) and for arithmetic in the type itself"},
    {RHEO__TROUBLE_RECIPROCALS,
     "this build multiplies with a reciprocal where a division is written; compile rheolog without "
     "-freciprocal-math (-funsafe-math-optimizations)"},
    {RHEO__TROUBLE_ROOTS, "this build approximates square roots; compile rheolog without -fapprox-func and -mrecip "
                          "(-funsafe-math-optimizations)"},
    {RHEO__TROUBLE_ZEROS, "this build ignores the signs of zeros; compile rheolog without -fno-signed-zeros "
                          "(-funsafe-math-optimizations)"},
    {RHEO__TROUBLE_INFINITIES, "this build takes it that there are no infinities or NaNs; compile rheolog without "
                               "-ffinite-math-only, -fno-honor-infinities and -fno-honor-nans"},
    {RHEO__TROUBLE_CONTRACTED,
     "this build contracts a * b + c into one operation; compile rheolog with -ffp-contract=off"},
};

rheo_result rheo__check_environment(rheo_error *error)
{
    static rheo__probe_function *const PROBE[] = RHEO__ALL_VARIANTS(probe);
    const unsigned found = PROBE[rheo__simd_in_use()]();
    for (size_t i = 0; found && i < sizeof TROUBLES / sizeof *TROUBLES; i++)
        if (found & TROUBLES[i].what)
            return rheo__fail(error, RHEO_ERROR_ENVIRONMENT, "%s", TROUBLES[i].message);
    return RHEO_OK;
}
