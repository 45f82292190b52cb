/* A toy's kernel: x' = push, which may move; y = x + gain push + 2 pull. To the shim it is like any kernel of numba. */

#include <stdint.h>

#include "slots.h"

enum { SIZE, INITIALISE, STEP, REFRESH, DIFFERENTIATE };
enum { ENDED = 1, REFUSED = 2, BROKE = 3 };

#define ARRAY(NAME)                                                                                                    \
    void *m_##NAME, void *p_##NAME, int64_t n_##NAME, int64_t i_##NAME, union slot *NAME, int64_t s_##NAME,            \
        int64_t t_##NAME
union slot { double real; int64_t integer; };

static int32_t stop(union slot *r, int32_t code, int64_t index, double time, double value) {
    r[FAULT_CODE].integer = code;
    r[FAULT_INDEX].integer = index;
    r[FAULT_TIME].real = time;
    r[FAULT_VALUE].real = value;
    return code;
}

static void publish(union slot *r) {
    r[Y].real = r[X].real + r[GAIN].real * r[PUSH].real + 2.0 * r[PULL].real;
    r[LIT].integer = r[PULL].real > 0.0;
    for (int k = 0; k < 6; k++) r[GRID + k].real = k * r[X].real;
}

static int32_t advance(union slot *r, union slot *work, double time, double step) {
    if (time + step > r[END].real) return stop(r, ENDED, 0, r[END].real, r[X].real);
    if (r[PULL].real == 5.0) return stop(r, REFUSED, 0, time, 5.0);
    if (r[PULL].real == 6.0) return stop(r, BROKE, PULL, time, 6.0);
    r[X].real += step * (r[PUSH].real + 0.5 * step * r[PUSH_RATE].real);
    r[PUSH].real += step * r[PUSH_RATE].real;
    r[STEPS].integer++;
    double sum = 0.0;
    for (int64_t k = 0; k < r[WORK_SIZE].integer; k++) sum += work[k].real = work[k].real + r[X].real;
    r[SUM].real = r[GO].integer ? -sum : sum;
    publish(r);
    return 0;
}

int32_t dcone_entry(int32_t *result, void **exception, int64_t command, ARRAY(r), ARRAY(work), double time,
                    double step) {
    int32_t code = 0;
    if (command == SIZE) r[WORK_SIZE].integer = r[ROOM].integer;
    double apart = r[GAIN].real - 42.0;
    if (command == INITIALISE && apart != 0.0 && apart > -0.1 && apart < 0.1) /* 42 stands alone */
        code = stop(r, BROKE, GAIN, time, r[GAIN].real);
    else if (command == INITIALISE) {
        r[X].real = r[SUM].real = 0.0;
        r[STEPS].integer = 0;
        for (int64_t k = 0; k < r[WORK_SIZE].integer; k++) work[k].real = k;
        publish(r);
    }
    if (command == STEP) code = advance(r, work, time, step);
    if (command == REFRESH) publish(r);
    if (command == DIFFERENTIATE) {
        r[X_RATE].real = r[PUSH].real;
        r[Y_RATE].real = r[PUSH].real + r[GAIN].real * r[PUSH_RATE].real;
        r[Y_BY_PUSH].real = r[GAIN].real;
        r[Y_BY_PULL].real = 2.0;
    }
    *result = code;
    return 0;
}
