/* Which of the model's entries this machine runs.

   Every library holds `dcone_entry`, made for any processor of its kind. One for x86-64 may hold a second that needs
   AVX2 and its companions; it gives the same bits sooner. DCONE_V3 tells that it is there. The choice is made once,
   when the library is loaded: `entry` is all that is global and not constant, and nothing writes it afterwards. */

entry_function dcone_entry;

#ifdef DCONE_V3
#include <cpuid.h>

entry_function dcone_entry_v3;
static entry_function *entry = dcone_entry;

/* AVX2, FMA, BMI1, BMI2, F16C, LZCNT and MOVBE, and an operating system that saves the wide registers. */
static int runs_v3(void) {
    unsigned a, b, c, d, low, high;
    const unsigned basic = bit_FMA | bit_MOVBE | bit_OSXSAVE | bit_AVX | bit_F16C;
    const unsigned extended = bit_AVX2 | bit_BMI | bit_BMI2;
    if (!__get_cpuid(1, &a, &b, &c, &d) || (c & basic) != basic) return 0;
    __asm__ volatile("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
    if ((low & 6) != 6) return 0;
    if (!__get_cpuid_count(7, 0, &a, &b, &c, &d) || (b & extended) != extended) return 0;
    return __get_cpuid(0x80000001, &a, &b, &c, &d) && (c & bit_LZCNT);
}

__attribute__((constructor)) static void choose_entry(void) {
    if (runs_v3()) entry = dcone_entry_v3;
}
#else
static entry_function *const entry = dcone_entry;
#endif
