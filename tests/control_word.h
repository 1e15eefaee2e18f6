/*
 * The register that controls rounding and denormals of a thread. CONTROL_WORD is undefined on machines where the
 * register is unknown.
 */
#ifndef RHEO__TESTS_CONTROL_WORD_H
#define RHEO__TESTS_CONTROL_WORD_H

#include <stdint.h>

#if defined(__SSE2__)
#include <xmmintrin.h>
#define CONTROL_WORD "MXCSR"
#define CONTROL_FLUSH_RESULTS UINT64_C(0x8000)
#define CONTROL_FLUSH_OPERANDS UINT64_C(0x40)
#define CONTROL_ROUND_DOWN UINT64_C(0x2000)
#define CONTROL_ROUND_UP UINT64_C(0x4000)
static inline uint64_t control_get(void)
{
    return _mm_getcsr() & ~UINT32_C(0x3f); /* masks the sticky exception flags */
}
static inline void control_set(uint64_t word)
{
    _mm_setcsr((unsigned)word);
}
#elif defined(__aarch64__)
#define CONTROL_WORD "FPCR"
#define CONTROL_FLUSH_RESULTS (UINT64_C(1) << 24) /* one flag for results and operands */
#define CONTROL_FLUSH_OPERANDS UINT64_C(0)
#define CONTROL_ROUND_DOWN (UINT64_C(1) << 23)
#define CONTROL_ROUND_UP (UINT64_C(1) << 22)
static inline uint64_t control_get(void)
{
    uint64_t word;
    __asm__ volatile("mrs %0, fpcr" : "=r"(word));
    return word;
}
static inline void control_set(uint64_t word)
{
    __asm__ volatile("msr fpcr, %0" : : "r"(word) : "memory");
}
#elif defined(__arm__) && defined(__ARM_FP)
#define CONTROL_WORD "FPSCR"
#define CONTROL_FLUSH_RESULTS (UINT64_C(1) << 24)
#define CONTROL_FLUSH_OPERANDS UINT64_C(0)
#define CONTROL_ROUND_DOWN (UINT64_C(1) << 23)
#define CONTROL_ROUND_UP (UINT64_C(1) << 22)
static inline uint64_t control_get(void)
{
    uint32_t word;
    __asm__ volatile("vmrs %0, fpscr" : "=r"(word));
    return word & UINT32_C(0x0fffff60); /* masks the sticky exception flags */
}
static inline void control_set(uint64_t word)
{
    __asm__ volatile("vmsr fpscr, %0" : : "r"((uint32_t)word) : "memory");
}
#endif

#endif
