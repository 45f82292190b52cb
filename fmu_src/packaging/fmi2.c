/* The FMI 2.0 co-simulation interface of every model here, free of any model.

   An instance is one block of 8-byte slots: first the record (parameters, inputs, state, outputs; a value reference is a
   slot), then the work memory, whose size the model tells once its parameters are known. Getting, setting and serialising
   the FMU state are copies of that block. The generated model.h tells slots, start values, bounds and faults. */

#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"

struct bound { int slot; double low, high; int open; const char *name, *unit; };
struct fault { int code, discard; const char *text; };

#include "model.h"

enum { REAL = 1, INTEGER = 2, BOOLEAN = 3 };
enum { HIDDEN = 0, OUTPUT = 1, PARAMETER = 2, INPUT = 3 };
enum { SIZE = 0, INITIALISE = 1, STEP = 2, REFRESH = 3 };
enum { WORK_SIZE = 0, FAULT_CODE = 1, FAULT_INDEX = 2, FAULT_TIME = 3, FAULT_VALUE = 4 };
enum phase { INSTANTIATED, INITIALISING, STEPPING, TERMINATED, BROKEN };

typedef union { double real; int64_t integer; uint64_t bits; } slot;

typedef struct {
    fmi2CallbackLogger logger;
    fmi2ComponentEnvironment environment;
    char *name;
    int logging;
    enum phase phase;
    int stale;      /* parameters were set since the outputs were last worked out */
    int64_t work;   /* slots of work memory */
    double time;    /* last communication point */
    slot *block;    /* record, then work */
} instance;

/* What a saved state begins with, in memory and serialised. */
typedef struct {
    char magic[8];
    char guid[48];
    int64_t version, phase, stale, work;
    double time;
} saved;

#define MAGIC "DCONEFMU"
#define STATE_VERSION 1

/* ---- the model's entry, one for each processor it was compiled for ------------------------------------------------ */

#define ARRAY void *, void *, int64_t, int64_t, slot *, int64_t, int64_t
typedef int32_t entry_function(int32_t *result, void **exception, int64_t command, ARRAY, ARRAY, double time, double step);

#include "processor.h"

static int32_t run(instance *i, int64_t command, double time, double step) {
    int32_t result = 0;
    void *exception = NULL;
    int32_t status = entry(&result, &exception, command,
                           NULL, NULL, 1, DCONE_SLOTS * 8, i->block, 1, DCONE_SLOTS * 8,
                           NULL, NULL, i->work, 8, i->block + DCONE_SLOTS, i->work, 8, time, step);
    return status ? -1 : result;
}

/* ---- messages ----------------------------------------------------------------------------------------------------- */

static fmi2Status say(instance *i, fmi2Status status, const char *format, ...) {
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (i->logger && (i->logging || status >= fmi2Discard))
        i->logger(i->environment, i->name, status, status == fmi2Discard ? "logStatusDiscard" : "logStatusError", "%s", text);
    return status;
}

/* Tell why the kernel stopped: the text of its fault, which, how much and when. */
static fmi2Status tell_fault(instance *i) {
    const slot *r = i->block;
    const struct fault *f = fault_table;
    while (f->code && f->code != r[FAULT_CODE].integer) f++;
    fmi2Status status = f->discard ? fmi2Discard : fmi2Error;
    say(i, status, "%s (index %lld, value %.9g, at %.9g s)", f->text, (long long)r[FAULT_INDEX].integer,
        r[FAULT_VALUE].real, r[FAULT_TIME].real);
    if (status == fmi2Error) i->phase = BROKEN;
    return status;
}

static int allowed(instance *i, int ok, const char *call) {
    if (!i) return 0;
    if (!ok) {
        static const char *names[] = {"instantiated", "initialising", "stepping", "terminated", "broken by an earlier error"};
        say(i, fmi2Error, "%s is not allowed while the instance is %s", call, names[i->phase]);
    }
    return ok;
}

/* ---- life --------------------------------------------------------------------------------------------------------- */

static int take_start_values(instance *i) {
    slot *block = calloc(DCONE_SLOTS + 1, sizeof(slot));
    if (!block) return 0;
    free(i->block);
    i->block = block;
    i->work = 0;
    i->time = 0.0;
    i->stale = 1;
    i->phase = INSTANTIATED;
    memcpy(block, slot_start, sizeof slot_start);
    return 1;
}

static int resize(instance *i, int64_t work) {
    if (work == i->work) return 1;
    slot *block = realloc(i->block, (size_t)(DCONE_SLOTS + work + 1) * sizeof(slot));
    if (!block) return 0;
    i->block = block;
    i->work = work;
    return 1;
}

static fmi2Status check_bounds(instance *i) {
    for (const struct bound *b = slot_bound; b->slot >= 0; b++) {
        int real = (slot_code[b->slot] & 3) == REAL;
        double value = real ? i->block[b->slot].real : (double)i->block[b->slot].integer;
        if (!(value >= b->low && value <= b->high && isfinite(value)) || (b->open && value == b->low))
            return say(i, fmi2Error, "%s = %.9g %s is out of its bounds: it must be finite, %s %.9g and at most %.9g", b->name,
                       value, b->unit, b->open ? "greater than" : "at least", b->low, b->high);
    }
    return fmi2OK;
}

/* Work out state and outputs from the parameters. */
static fmi2Status settle(instance *i) {
    if (!i->stale) return fmi2OK;
    fmi2Status status = check_bounds(i);
    if (status != fmi2OK) return status;
    i->block[FAULT_CODE].integer = 0;
    if (run(i, SIZE, i->time, 0.0)) return tell_fault(i);
    if (!resize(i, i->block[WORK_SIZE].integer)) return say(i, fmi2Error, "no memory for %lld numbers",
                                                             (long long)i->block[WORK_SIZE].integer);
    if (run(i, INITIALISE, i->time, 0.0)) return tell_fault(i);
    i->stale = 0;
    return fmi2OK;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging) {
    (void)resources;
    (void)visible;
    instance *i = calloc(1, sizeof *i);
    if (!i) return NULL;
    if (functions) {
        i->logger = functions->logger;
        i->environment = functions->componentEnvironment;
    }
    i->logging = logging;
    const char *given = name && *name ? name : DCONE_IDENTIFIER;
    i->name = malloc(strlen(given) + 1);
    if (i->name) strcpy(i->name, given);
    int good = i->name && take_start_values(i);
    if (good && type != fmi2CoSimulation) {
        say(i, fmi2Error, "this FMU is for co-simulation only");
        good = 0;
    }
    if (good && (!guid || strcmp(guid, DCONE_GUID))) {
        say(i, fmi2Error, "the GUID %s is not that of this binary, %s", guid ? guid : "(none)", DCONE_GUID);
        good = 0;
    }
    if (good) return i;
    free(i->name);
    free(i->block);
    free(i);
    return NULL;
}

void fmi2FreeInstance(fmi2Component c) {
    instance *i = c;
    if (!i) return;
    free(i->name);
    free(i->block);
    free(i);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean has_stop, fmi2Real stop) {
    instance *i = c;
    (void)has_tolerance;
    (void)tolerance;
    (void)has_stop;
    (void)stop;
    if (!allowed(i, i && i->phase == INSTANTIATED, "fmi2SetupExperiment")) return fmi2Error;
    if (!isfinite(start)) return say(i, fmi2Error, "the start time must be finite");
    i->time = start;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    instance *i = c;
    if (!allowed(i, i && i->phase == INSTANTIATED, "fmi2EnterInitializationMode")) return fmi2Error;
    i->phase = INITIALISING;
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    instance *i = c;
    if (!allowed(i, i && i->phase == INITIALISING, "fmi2ExitInitializationMode")) return fmi2Error;
    fmi2Status status = settle(i);
    if (status == fmi2OK) i->phase = STEPPING;
    return status;
}

fmi2Status fmi2Terminate(fmi2Component c) {
    instance *i = c;
    if (!allowed(i, i && i->phase == STEPPING, "fmi2Terminate")) return fmi2Error;
    i->phase = TERMINATED;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c) {
    instance *i = c;
    if (!i) return fmi2Error;
    return take_start_values(i) ? fmi2OK : say(i, fmi2Error, "no memory");
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[]) {
    instance *i = c;
    (void)n;
    (void)categories;
    if (!i) return fmi2Error;
    i->logging = on;
    return fmi2OK;
}

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

/* ---- values ------------------------------------------------------------------------------------------------------- */

static slot *readable(instance *i, fmi2ValueReference reference, int kind) {
    if (reference >= DCONE_SLOTS || (slot_code[reference] & 3) != kind || slot_code[reference] >> 2 == HIDDEN) {
        say(i, fmi2Error, "value reference %u is no variable of the type asked for", reference);
        return NULL;
    }
    return &i->block[reference];
}

/* Outputs are worked out before they are read for the first time. */
static fmi2Status ready(instance *i, const char *call) {
    if (!allowed(i, i && i->phase != BROKEN, call)) return fmi2Error;
    return i->phase == INITIALISING ? settle(i) : fmi2OK;
}

#define GET(NAME, TYPE, KIND, FIELD)                                                                                   \
    fmi2Status NAME(fmi2Component c, const fmi2ValueReference vr[], size_t n, TYPE value[]) {                          \
        fmi2Status status = ready(c, #NAME);                                                                           \
        for (size_t k = 0; k < n && status == fmi2OK; k++) {                                                           \
            slot *s = readable(c, vr[k], KIND);                                                                        \
            if (!s) return fmi2Error;                                                                                  \
            value[k] = (TYPE)s->FIELD;                                                                                 \
        }                                                                                                              \
        return status;                                                                                                 \
    }

static fmi2Status writable(instance *i, fmi2ValueReference reference) {
    int access = slot_code[reference] >> 2;
    int early = i->phase == INSTANTIATED || i->phase == INITIALISING;
    if (access == INPUT || (access == PARAMETER && early)) {
        if (early) i->stale = 1;
        return fmi2OK;
    }
    return say(i, fmi2Error, access == PARAMETER ? "value reference %u is a parameter, fixed once the initialisation is over"
                                                 : "value reference %u is an output and can not be set", reference);
}

#define SET(NAME, TYPE, KIND, FIELD, USABLE, STORED)                                                                   \
    fmi2Status NAME(fmi2Component c, const fmi2ValueReference vr[], size_t n, const TYPE value[]) {                    \
        instance *i = c;                                                                                               \
        if (!allowed(i, i && i->phase < TERMINATED, #NAME)) return fmi2Error;                                          \
        for (size_t k = 0; k < n; k++) {                                                                               \
            slot *s = readable(i, vr[k], KIND);                                                                        \
            if (!s || writable(i, vr[k]) != fmi2OK) return fmi2Error;                                                  \
            if (!(USABLE)) return say(i, fmi2Error, "value reference %u was given a number that is not finite", vr[k]); \
            s->FIELD = STORED;                                                                                         \
        }                                                                                                              \
        return fmi2OK;                                                                                                 \
    }

GET(fmi2GetReal, fmi2Real, REAL, real)
GET(fmi2GetInteger, fmi2Integer, INTEGER, integer)
GET(fmi2GetBoolean, fmi2Boolean, BOOLEAN, integer)
SET(fmi2SetReal, fmi2Real, REAL, real, isfinite(value[k]), value[k])
SET(fmi2SetInteger, fmi2Integer, INTEGER, integer, 1, value[k])
SET(fmi2SetBoolean, fmi2Boolean, BOOLEAN, integer, 1, value[k] != 0)

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2String value[]) {
    (void)vr;
    (void)value;
    return n == 0 ? fmi2OK : say(c, fmi2Error, "this FMU has no String variables");
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2String value[]) {
    (void)vr;
    (void)value;
    return n == 0 ? fmi2OK : say(c, fmi2Error, "this FMU has no String variables");
}

/* ---- stepping ----------------------------------------------------------------------------------------------------- */

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_return) {
    instance *i = c;
    (void)no_return;
    if (!allowed(i, i && i->phase == STEPPING, "fmi2DoStep")) return fmi2Error;
    if (!isfinite(time) || !(step >= 0.0) || !isfinite(step))
        return say(i, fmi2Error, "a step from %.17g s of %.17g s can not be made", time, step);
    if (fabs(time - i->time) > 1e-9 * (fabs(time) + fabs(i->time)) + 1e-9)
        return say(i, fmi2Error, "the step begins at %.17g s, but the FMU stands at %.17g s", time, i->time);
    if (step == 0.0) return fmi2OK;
    i->block[FAULT_CODE].integer = 0;
    /* a master that adds up times drifts by rounding: the gap is closed, so that the model sees none */
    if (run(i, STEP, i->time, (time - i->time) + step)) return tell_fault(i);
    i->time = time + step;
    return fmi2OK;
}

fmi2Status fmi2CancelStep(fmi2Component c) { return say(c, fmi2Error, "steps are never pending"); }

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value) {
    (void)kind;
    (void)value;
    return say(c, fmi2Discard, "steps are never pending");
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value) {
    instance *i = c;
    if (kind != fmi2LastSuccessfulTime) return fmi2Discard;
    *value = i->time;
    return fmi2OK;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value) {
    (void)kind;
    (void)value;
    return say(c, fmi2Discard, "there is no Integer status");
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value) {
    instance *i = c;
    if (kind != fmi2Terminated) return fmi2Discard;
    *value = i->phase == BROKEN;
    return fmi2OK;
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value) {
    (void)kind;
    (void)value;
    return say(c, fmi2Discard, "there is no String status");
}

/* ---- state -------------------------------------------------------------------------------------------------------- */

static size_t state_size(int64_t work) { return sizeof(saved) + (size_t)(DCONE_SLOTS + work) * sizeof(slot); }

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) {
    instance *i = c;
    if (!i || !state) return fmi2Error;
    saved *s = *state;
    if (s && s->work != i->work) {
        free(s);
        s = NULL;
    }
    if (!s) s = malloc(state_size(i->work));
    *state = s;
    if (!s) return say(i, fmi2Error, "no memory for the FMU state");
    memset(s, 0, sizeof *s);
    memcpy(s->magic, MAGIC, sizeof s->magic);
    strncpy(s->guid, DCONE_GUID, sizeof s->guid - 1);
    s->version = STATE_VERSION;
    s->phase = i->phase;
    s->stale = i->stale;
    s->work = i->work;
    s->time = i->time;
    memcpy(s + 1, i->block, (size_t)(DCONE_SLOTS + i->work) * sizeof(slot));
    return fmi2OK;
}

static fmi2Status usable(instance *i, const saved *s, size_t size) {
    if (size < sizeof *s || memcmp(s->magic, MAGIC, sizeof s->magic))
        return say(i, fmi2Error, "this is no saved state of such an FMU");
    if (s->version != STATE_VERSION)
        return say(i, fmi2Error, "the saved state has version %lld, expected %d", (long long)s->version, STATE_VERSION);
    if (strncmp(s->guid, DCONE_GUID, sizeof s->guid))
        return say(i, fmi2Error, "the saved state belongs to the FMU %.47s, not to %s", s->guid, DCONE_GUID);
    if (s->work < 0 || s->work > INT64_C(1) << 40 || (size != SIZE_MAX && size != state_size(s->work)))
        return say(i, fmi2Error, "the saved state is damaged: its size does not fit");
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
    instance *i = c;
    const saved *s = state;
    if (!i || !s) return fmi2Error;
    if (usable(i, s, SIZE_MAX) != fmi2OK) return fmi2Error;
    if (!resize(i, s->work)) return say(i, fmi2Error, "no memory for the FMU state");
    i->phase = (enum phase)s->phase;
    i->stale = (int)s->stale;
    i->time = s->time;
    memcpy(i->block, s + 1, (size_t)(DCONE_SLOTS + s->work) * sizeof(slot));
    return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
    (void)c;
    if (state) {
        free(*state);
        *state = NULL;
    }
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size) {
    if (!c || !state || !size) return fmi2Error;
    *size = state_size(((saved *)state)->work);
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
    if (!c || !state) return fmi2Error;
    if (size < state_size(((saved *)state)->work)) return say(c, fmi2Error, "the buffer is too small for the FMU state");
    memcpy(bytes, state, state_size(((saved *)state)->work));
    return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state) {
    saved head;
    if (!c || !state) return fmi2Error;
    if (size < sizeof head) return say(c, fmi2Error, "this is no saved state of such an FMU");
    memcpy(&head, bytes, sizeof head);
    if (usable(c, &head, size) != fmi2OK) return fmi2Error;
    void *copy = malloc(size);
    if (!copy) return say(c, fmi2Error, "no memory for the FMU state");
    memcpy(copy, bytes, size);
    free(*state);
    *state = copy;
    return fmi2OK;
}

/* ---- what this FMU does not offer: present, since some tools look every symbol up ---------------------------------- */

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t n_unknown,
                                        const fmi2ValueReference known[], size_t n_known, const fmi2Real change[],
                                        fmi2Real result[]) {
    (void)unknown; (void)n_unknown; (void)known; (void)n_known; (void)change; (void)result;
    return say(c, fmi2Error, "directional derivatives are not provided");
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                       const fmi2Integer order[], const fmi2Real value[]) {
    (void)vr; (void)n; (void)order; (void)value;
    return say(c, fmi2Error, "inputs are held over a step");
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                        const fmi2Integer order[], fmi2Real value[]) {
    (void)vr; (void)n; (void)order; (void)value;
    return say(c, fmi2Error, "output derivatives are not provided");
}

#define NO_MODEL_EXCHANGE(NAME, ...)                                                                                   \
    fmi2Status NAME(fmi2Component c, ##__VA_ARGS__) { return say(c, fmi2Error, "this FMU is for co-simulation only"); }

#pragma clang diagnostic ignored "-Wunused-parameter"
NO_MODEL_EXCHANGE(fmi2EnterEventMode)
NO_MODEL_EXCHANGE(fmi2NewDiscreteStates, fmi2EventInfo *info)
NO_MODEL_EXCHANGE(fmi2EnterContinuousTimeMode)
NO_MODEL_EXCHANGE(fmi2CompletedIntegratorStep, fmi2Boolean no_set, fmi2Boolean *event, fmi2Boolean *terminate)
NO_MODEL_EXCHANGE(fmi2SetTime, fmi2Real time)
NO_MODEL_EXCHANGE(fmi2SetContinuousStates, const fmi2Real x[], size_t n)
NO_MODEL_EXCHANGE(fmi2GetDerivatives, fmi2Real dx[], size_t n)
NO_MODEL_EXCHANGE(fmi2GetEventIndicators, fmi2Real z[], size_t n)
NO_MODEL_EXCHANGE(fmi2GetContinuousStates, fmi2Real x[], size_t n)
NO_MODEL_EXCHANGE(fmi2GetNominalsOfContinuousStates, fmi2Real x[], size_t n)
