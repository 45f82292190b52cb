/* The FMI 2.0 co-simulation interface of a model. It need not be changed: the model is in model.c.

   An instance is one block of doubles, its values and its states. Saving, restoring and serialising the FMU state are
   copies of that block. */

#include "model.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum phase { INSTANTIATED, INITIALISING, STEPPING, OVER, BROKEN };

typedef struct {
    model m; /* first, so that a model's address is its instance's */
    enum phase phase;
    fmi2CallbackFunctions callbacks;
    char *name;
    unsigned logged; /* categories of messages that the importer wants */
} instance;

/* What a saved state begins with; the block follows. Count STATE_VERSION up when you change what a state means. */
#define STATE_VERSION 1

typedef struct {
    double version, start, time, size;
    int phase, ended;
    char guid[64]; /* of the model; of a longer one its beginning */
} saved;

static size_t block(void) { return (model_variables + model_states) * sizeof(double); }

/* Whether a state is of this model and of this version of it. */
static int is_ours(const saved *s) {
    return s->version == STATE_VERSION && s->size == (double)block() &&
           !strncmp(s->guid, model_guid, sizeof s->guid - 1) && s->phase >= INSTANTIATED && s->phase <= BROKEN;
}

/* The categories of messages, as modelDescription.xml lists them. */
static const char *const category_name[] = {"logStatusError", "logStatusDiscard", "logStatusWarning", "logEvents"};

#include "fmi2_log.h"

fmi2Status model_say(model *m, fmi2Status status, const char *text) { return say((instance *)m, status, "%s", text); }

/* After an error nothing but reset and free is to be called. */
static fmi2Status done(instance *i, fmi2Status status) {
    if (status >= fmi2Error) i->phase = BROKEN;
    return status;
}

static fmi2Status refuse(instance *i, const char *text) { return done(i, say(i, fmi2Error, "%s", text)); }

static void take_start_values(instance *i) {
    size_t n;
    for (n = 0; n < model_variables; n++) i->m.values[n] = model_table[n].start;
    for (n = 0; n < model_states; n++) i->m.states[n] = 0.0;
    i->m.start = i->m.time = 0.0;
    i->m.ended = 0;
    i->phase = INSTANTIATED;
}

/* ---- life ---------------------------------------------------------------------------------------------------------- */

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }

const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging) {
    instance *i;
    char *copy;
    (void)resources, (void)visible;
    if (!callbacks || !name) return NULL;
    if (type != fmi2CoSimulation || !guid || strcmp(guid, model_guid)) {
        if (callbacks->logger)
            callbacks->logger(callbacks->componentEnvironment, name, fmi2Error, category_name[0],
                              type != fmi2CoSimulation ? "this FMU is for co-simulation only"
                                                       : "the guid given is %s, that of this binary is %s",
                              guid ? guid : "(NULL)", model_guid);
        return NULL;
    }
    i = calloc(1, sizeof *i);
    copy = malloc(strlen(name) + 1);
    if (i) i->m.values = malloc(block() + sizeof(double));
    if (!i || !copy || !i->m.values) {
        if (i) free(i->m.values);
        free(i);
        free(copy);
        return NULL;
    }
    strcpy(copy, name);
    i->name = copy;
    i->m.states = i->m.values + model_variables;
    i->callbacks = *callbacks;
    i->m.callbacks = &i->callbacks;
    i->logged = logging ? ALL : ERRORS | DISCARDS;
    take_start_values(i);
    return i;
}

void fmi2FreeInstance(fmi2Component c) {
    instance *i = c;
    if (!i) return;
    free(i->name);
    free(i->m.values);
    free(i);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerance_given, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean stop_given, fmi2Real stop) {
    instance *i = c;
    (void)tolerance_given, (void)tolerance, (void)stop_given, (void)stop;
    if (i->phase != INSTANTIATED) return refuse(i, "fmi2SetupExperiment is not allowed now");
    i->m.start = start;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    instance *i = c;
    if (i->phase != INSTANTIATED) return refuse(i, "fmi2EnterInitializationMode is not allowed now");
    i->phase = INITIALISING;
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    instance *i = c;
    fmi2Status status;
    if (i->phase != INITIALISING) return refuse(i, "fmi2ExitInitializationMode is not allowed now");
    status = model_start(&i->m);
    if (status <= fmi2Warning) status = model_outputs(&i->m);
    if (status <= fmi2Warning) i->phase = STEPPING;
    return done(i, status);
}

fmi2Status fmi2Terminate(fmi2Component c) {
    ((instance *)c)->phase = OVER;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c) {
    take_start_values(c);
    return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_going_back) {
    instance *i = c;
    fmi2Status status;
    (void)no_going_back;
    if (i->phase != STEPPING || i->m.ended) return refuse(i, "fmi2DoStep is not allowed now");
    i->m.time = time - i->m.start;
    status = model_step(&i->m, step);
    if (status <= fmi2Warning) {
        fmi2Status outputs;
        i->m.time = time + step - i->m.start;
        outputs = model_outputs(&i->m);
        if (outputs > status) status = outputs;
    }
    return done(i, status);
}

fmi2Status fmi2CancelStep(fmi2Component c) { return refuse(c, "no step is ever pending"); }

/* ---- values -------------------------------------------------------------------------------------------------------- */

static int is(size_t reference, enum kind kind) {
    return reference < model_variables && model_table[reference].kind == kind;
}

static int settable(const instance *i, size_t reference) {
    if (model_table[reference].causality == OUTPUT) return 0;
    return model_table[reference].causality == INPUT || i->phase < STEPPING;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Real values[]) {
    instance *i = c;
    size_t k;
    for (k = 0; k < n; k++) {
        if (!is(r[k], REAL)) return refuse(i, "fmi2GetReal: there is no such Real");
        values[k] = i->m.values[r[k]];
    }
    return fmi2OK;
}

static fmi2Status get_whole(instance *i, enum kind kind, const fmi2ValueReference r[], size_t n, int values[]) {
    size_t k;
    for (k = 0; k < n; k++) {
        if (!is(r[k], kind)) return refuse(i, "there is no such Integer or Boolean");
        values[k] = (int)i->m.values[r[k]];
    }
    return fmi2OK;
}

fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Integer values[]) {
    return get_whole(c, INTEGER, r, n, values);
}

fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Boolean values[]) {
    return get_whole(c, BOOLEAN, r, n, values);
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Real values[]) {
    instance *i = c;
    size_t k;
    for (k = 0; k < n; k++) {
        if (!is(r[k], REAL) || !settable(i, r[k])) return refuse(i, "fmi2SetReal: no such Real can be set now");
        i->m.values[r[k]] = values[k];
    }
    return fmi2OK;
}

static fmi2Status set_whole(instance *i, enum kind kind, const fmi2ValueReference r[], size_t n, const int values[]) {
    size_t k;
    for (k = 0; k < n; k++) {
        if (!is(r[k], kind) || !settable(i, r[k])) return refuse(i, "no such Integer or Boolean can be set now");
        i->m.values[r[k]] = values[k];
    }
    return fmi2OK;
}

fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Integer values[]) {
    return set_whole(c, INTEGER, r, n, values);
}

fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Boolean values[]) {
    return set_whole(c, BOOLEAN, r, n, values);
}

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2String values[]) {
    (void)r, (void)values;
    return n ? refuse(c, "there are no Strings") : fmi2OK;
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2String values[]) {
    (void)r, (void)values;
    return n ? refuse(c, "there are no Strings") : fmi2OK;
}

/* ---- derivatives: none is offered ------------------------------------------------------------------------------------ */

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference r[], size_t n,
                                       const fmi2Integer order[], const fmi2Real values[]) {
    (void)r, (void)n, (void)order, (void)values;
    return refuse(c, "there are no input derivatives");
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference r[], size_t n,
                                        const fmi2Integer order[], fmi2Real values[]) {
    (void)r, (void)n, (void)order, (void)values;
    return refuse(c, "there are no output derivatives");
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknowns[], size_t m,
                                        const fmi2ValueReference knowns[], size_t n, const fmi2Real seed[],
                                        fmi2Real sensitivity[]) {
    (void)unknowns, (void)m, (void)knowns, (void)n, (void)seed, (void)sensitivity;
    return refuse(c, "there are no directional derivatives");
}

/* ---- state ----------------------------------------------------------------------------------------------------------- */

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) {
    instance *i = c;
    saved *s = *state ? *state : malloc(sizeof *s + block());
    if (!s) return refuse(i, "no memory for a state");
    memset(s, 0, sizeof *s);
    s->version = STATE_VERSION;
    strncpy(s->guid, model_guid, sizeof s->guid - 1);
    s->start = i->m.start;
    s->time = i->m.time;
    s->size = (double)block();
    s->phase = (int)i->phase;
    s->ended = i->m.ended;
    memcpy(s + 1, i->m.values, block());
    *state = s;
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
    instance *i = c;
    const saved *s = state;
    if (!s) return refuse(i, "there is no state to restore");
    if (!is_ours(s)) return refuse(i, "that state is of another FMU, or of another version of this one");
    i->m.start = s->start;
    i->m.time = s->time;
    i->m.ended = s->ended;
    i->phase = (enum phase)s->phase;
    memcpy(i->m.values, s + 1, block());
    return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
    (void)c;
    free(*state);
    *state = NULL;
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size) {
    (void)c, (void)state;
    *size = sizeof(saved) + block();
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
    if (size < sizeof(saved) + block()) return refuse(c, "too little room for a state");
    memcpy(bytes, state, sizeof(saved) + block());
    return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state) {
    saved head;
    void *s;
    if (size != sizeof(saved) + block()) return refuse(c, "these bytes are no state of this FMU");
    memcpy(&head, bytes, sizeof head);
    if (!is_ours(&head)) return refuse(c, "these bytes are a state of another FMU, or of another version of this one");
    s = *state ? *state : malloc(size);
    if (!s) return refuse(c, "no memory for a state");
    memcpy(s, bytes, size);
    *state = s;
    return fmi2OK;
}

/* ---- how a step went -------------------------------------------------------------------------------------------------- */

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value) {
    (void)c;
    if (kind != fmi2DoStepStatus) return fmi2Discard;
    *value = fmi2OK;
    return fmi2OK;
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value) {
    if (kind != fmi2LastSuccessfulTime) return fmi2Discard;
    *value = ((instance *)c)->m.start + ((instance *)c)->m.time;
    return fmi2OK;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value) {
    (void)c, (void)kind, (void)value;
    return fmi2Discard;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value) {
    if (kind != fmi2Terminated) return fmi2Discard;
    *value = ((instance *)c)->m.ended ? fmi2True : fmi2False;
    return fmi2OK;
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value) {
    (void)c, (void)kind;
    *value = "";
    return fmi2Discard;
}

/* ---- model exchange: none is offered --------------------------------------------------------------------------------- */

#include "fmi2_absent.h"
