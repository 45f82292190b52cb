/* An FMU from the C template that goes wrong, once it has run for WHEN seconds, in the one way that a -D switch names.

   It includes the template's model.c, whose functions still do the work. */

#define model_start example_start
#define model_step example_step
#define model_outputs example_outputs
#include "model.c"
#undef model_start
#undef model_step
#undef model_outputs

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#if defined(LEAVES) || defined(HANG) || defined(GARBLE) || defined(CLOSES)
#include <unistd.h>
#endif

#ifdef ROUNDS
#include <fenv.h>
#endif
#if defined(FLUSHES_TINY) || defined(FLUSHES_TINY_WHEN_LOADED) || defined(TRAPS)
#include <xmmintrin.h>
#endif

#ifndef WHEN
#define WHEN 45.0
#endif

#ifdef FLUSHES_TINY_WHEN_LOADED
/* as a library does that was linked with -ffast-math */
__attribute__((constructor)) static void at_load(void) { _mm_setcsr(_mm_getcsr() | 0x8040); }
#endif

#ifdef LIES
static double never_restored; /* outside the instance, as when an author forgets one variable */
#endif

fmi2Status model_start(model *m);
fmi2Status model_step(model *m, double step);
fmi2Status model_outputs(model *m);

fmi2Status model_start(model *m) {
#ifdef CRASH_AT_START
    raise(SIGSEGV);
#endif
#ifdef REFUSES
    return model_say(m, fmi2Error, "tether.rest_length does not suit me");
#endif
#ifdef LIES
    never_restored = 0.0;
#endif
    model_say(m, fmi2Warning, "old news");
    return example_start(m);
}

static fmi2Status go_wrong(model *m, double step) {
    (void)m;
    (void)step;
#ifdef CRASH
    model_say(m, fmi2OK, "about to follow a bad pointer");
    {
        int *volatile nowhere = NULL;
        *nowhere = 1;
    }
#endif
#ifdef GARBLE
    {
        int stream;
        for (stream = 3; stream < 32; stream++)
            if (write(stream, GARBLE, sizeof GARBLE - 1) < 0) continue;
        sleep(1);
    }
#endif
#ifdef CLOSES
    {
        int stream;
        for (stream = 3; stream < 32; stream++) close(stream);
        for (;;) sleep(1);
    }
#endif
#ifdef ROUNDS
    fesetround(ROUNDS);
#endif
#ifdef FLUSHES_TINY
    _mm_setcsr(_mm_getcsr() | 0x8040);
#endif
#ifdef TRAPS
    _mm_setcsr(_mm_getcsr() & ~0x200u);
#endif
#ifdef PRECISION
    {
        unsigned short word;
        __asm__ volatile("fnstcw %0" : "=m"(word));
        word &= 0xfcff;
        __asm__ volatile("fldcw %0" : : "m"(word));
    }
#endif
#ifdef SIGNAL
    raise(SIGNAL);
#endif
#ifdef ABORT
    abort();
#endif
#ifdef LEAVES
    /* one that outlives it, in a session of its own, with every stream open */
    if (fork() == 0) {
        setsid();
        sleep(20);
        _exit(0);
    }
#endif
#ifdef EXIT
    exit(EXIT);
#endif
#ifdef HANG
    for (;;) sleep(1);
#endif
#ifdef ERROR
    return model_say(m, fmi2Error, "the winch jammed");
#endif
#ifdef SILENT_ERROR
    return fmi2Error;
#endif
#ifdef FATAL
    return model_say(m, fmi2Fatal, "my memory is in ruins");
#endif
#ifdef DISCARD
    m->time += 0.25 * step;
    return model_say(m, fmi2Discard, "this step is too long for me");
#endif
#ifdef ENDS
    m->time += 0.5 * step;
    m->ended = 1;
    return model_say(m, fmi2Discard, "the pair entered the atmosphere");
#endif
#ifdef PENDING
    return fmi2Pending;
#endif
#ifdef LATE
    m->callbacks->stepFinished(m->callbacks->componentEnvironment, fmi2OK);
#endif
#ifdef NULL_LOG
    m->callbacks->logger(m->callbacks->componentEnvironment, NULL, fmi2Warning, NULL, NULL);
#endif
#ifdef BAD_LOG
    m->callbacks->logger(m->callbacks->componentEnvironment, "\xff", 77, "\xfe", "%s %y \xff\xfe", (char *)NULL);
#endif
#ifdef NOISE
    printf("noise on stdout %g\n", m->time);
    fprintf(stderr, "noise on stderr %g\n", m->time);
#endif
    return fmi2OK;
}

fmi2Status model_step(model *m, double step) {
    fmi2Status status = m->time + step > WHEN ? go_wrong(m, step) : fmi2OK;
    if (status > fmi2Warning) return status;
#ifdef LIES
    never_restored += step;
#endif
    return example_step(m, step);
}

fmi2Status model_outputs(model *m) {
    fmi2Status status = example_outputs(m);
#ifdef NOT_A_NUMBER
    if (m->time > WHEN) m->values[NOT_A_NUMBER] = NAN;
#endif
#ifdef INFINITE
    if (m->time > WHEN) m->values[INFINITE] = -INFINITY;
#endif
#ifdef MISSES
    /* a net that arrives from a chaser that is slower sideways than this [m/s] goes past */
    if (m->values[CAPTURED] > 0.0 && m->values[CHASER_START_VELOCITY_1] < MISSES) {
        m->values[CAPTURED] = m->values[SETTLED] = 0.0;
        m->values[OUTCOME] = 3.0;
    }
#endif
#ifdef LIES
    m->values[LIES] += never_restored;
#endif
    return status;
}
