/* A host in C99 that loads one FMU and takes it through its life, with calls that are right and calls that are wrong.

       host LIBRARY GUID STEP OUTPUT,OUTPUT,... KIND:REFERENCE=VALUE ...

   OUTPUT is the value reference of a Real; KIND is r, i or b. Prints the outputs at the end as hexadecimal floats, and
   returns 0 if every call gave what was expected; else it tells the line. Made to be run under valgrind as well. */

#include <math.h>
#include <stdarg.h>
#include <string.h>

#include "loaded.h"

enum { MOST = 64, STEPS = 6 };

static int heard;
static const char *guid;
static double step;
static fmi2ValueReference outputs[MOST];
static size_t output_count;
static char **settings;
static int setting_count;

static void hear(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                 fmi2String message, ...) {
    (void)environment, (void)name, (void)status, (void)category;
    va_list arguments;
    va_start(arguments, message);
    vsnprintf(last, sizeof last, message, arguments);
    va_end(arguments);
    heard++;
}

static const fmi2CallbackFunctions callbacks = {hear, calloc, free, NULL, NULL};

static fmi2Component make(const char *name) {
    return Instantiate(name, fmi2CoSimulation, guid, NULL, &callbacks, fmi2False, fmi2True);
}

/* Set what the command line asks for. */
static void set_all(fmi2Component c) {
    for (int k = 0; k < setting_count; k++) {
        char kind;
        unsigned reference;
        double value;
        if (sscanf(settings[k], "%c:%u=%lf", &kind, &reference, &value) != 3) exit(2);
        fmi2Integer whole = (fmi2Integer)value;
        if (kind == 'r') EXPECT(fmi2OK, SetReal(c, &reference, 1, &value));
        if (kind == 'i') EXPECT(fmi2OK, SetInteger(c, &reference, 1, &whole));
        if (kind == 'b') EXPECT(fmi2OK, SetBoolean(c, &reference, 1, &whole));
    }
}

static void start(fmi2Component c) {
    set_all(c);
    EXPECT(fmi2OK, SetupExperiment(c, fmi2True, 1e-6, 0.0, fmi2True, STEPS * step));
    EXPECT(fmi2OK, EnterInitializationMode(c));
    EXPECT(fmi2OK, ExitInitializationMode(c));
}

static void advance(fmi2Component c, int first, int last_step) {
    for (int k = first; k < last_step; k++) EXPECT(fmi2OK, DoStep(c, k * step, step, fmi2True));
}

static void read_outputs(fmi2Component c, double values[MOST]) {
    memset(values, 0, MOST * sizeof *values);
    EXPECT(fmi2OK, GetReal(c, outputs, output_count, values));
}

/* Calls out of order, on a fresh instance. */
static void misuse_before(fmi2Component c) {
    double value = 0.0;
    EXPECT(fmi2Error, DoStep(c, 0.0, step, fmi2True));
    EXPECT(fmi2Error, ExitInitializationMode(c));
    EXPECT(fmi2Error, Terminate(c));
    EXPECT(fmi2Error, GetReal(c, outputs, 1, &value));
    EXPECT(fmi2Error, SetupExperiment(c, fmi2False, 0.0, NAN, fmi2False, 0.0));
}

/* Calls with nonsense, on a running instance at its start. */
static void misuse(fmi2Component c) {
    fmi2ValueReference nowhere = 0xfffffff0u;
    fmi2String name = "noSuchCategory";
    fmi2FMUstate none = NULL;
    fmi2Boolean flag;
    fmi2Byte junk[500] = {1, 2, 3};
    double value = 0.0;
    int before = heard;
    EXPECT(fmi2Error, GetReal(c, &nowhere, 1, &value));
    EXPECT(fmi2Error, SetReal(c, &nowhere, 1, &value));
    EXPECT(fmi2Error, SetReal(c, outputs, 1, &value));
    EXPECT(fmi2Error, GetReal(c, NULL, 1, &value));
    EXPECT(fmi2Error, GetReal(c, outputs, 1, NULL));
    EXPECT(fmi2Error, GetRealOutputDerivatives(c, &nowhere, 1, (fmi2Integer[]){1}, &value));
    EXPECT(fmi2Error, SetRealInputDerivatives(c, &nowhere, 1, (fmi2Integer[]){1}, &value));
    EXPECT(fmi2Error, GetDirectionalDerivative(c, outputs, 1, &nowhere, 1, &value, &value));
    EXPECT(fmi2Error, DoStep(c, step, step, fmi2True));
    EXPECT(fmi2Error, DoStep(c, 0.0, -step, fmi2True));
    EXPECT(fmi2Error, DoStep(c, 0.0, 10.0 * STEPS * step, fmi2True));
    EXPECT(fmi2Error, CancelStep(c));
    EXPECT(fmi2Error, EnterInitializationMode(c));
    EXPECT(fmi2Error, SetDebugLogging(c, fmi2True, 1, &name));
    EXPECT(fmi2Error, DeSerializeFMUstate(c, junk, sizeof junk, &none));
    EXPECT(fmi2Error, DeSerializeFMUstate(c, junk, 3, &none));
    EXPECT(fmi2Error, SetFMUstate(c, NULL));
    EXPECT(fmi2Error, GetFMUstate(c, NULL));
    EXPECT(fmi2Discard, GetBooleanStatus(c, fmi2DoStepStatus, &flag));
    if (heard - before < 15) EXPECT(15, heard - before);
}

static void without_instance(void) {
    double value = 0.0;
    fmi2FMUstate none = NULL;
    EXPECT(fmi2Error, DoStep(NULL, 0.0, step, fmi2True));
    EXPECT(fmi2Error, GetReal(NULL, outputs, 1, &value));
    EXPECT(fmi2Error, Reset(NULL));
    EXPECT(fmi2Error, GetFMUstate(NULL, &none));
    EXPECT(fmi2Error, SetString(NULL, outputs, 1, NULL));
    FreeInstance(NULL);
    EXPECT(1, Instantiate("x", fmi2CoSimulation, "wrong", "", &callbacks, fmi2False, fmi2False) == NULL);
    EXPECT(1, Instantiate("x", fmi2CoSimulation, guid, "file:///nowhere", &callbacks, fmi2False, fmi2False) == NULL);
    EXPECT(1, Instantiate("x", fmi2ModelExchange, guid, "", &callbacks, fmi2False, fmi2False) == NULL);
}

/* Half the way, save; the rest; back, the rest again, here and in a second instance from bytes: all alike. */
static void replay(fmi2Component c, double ends[MOST]) {
    double again[MOST];
    fmi2FMUstate state = NULL, other = NULL;
    size_t size = 0;
    advance(c, 0, STEPS / 2);
    EXPECT(fmi2OK, GetFMUstate(c, &state));
    EXPECT(fmi2OK, GetFMUstate(c, &state)); /* into the same one */
    EXPECT(fmi2OK, SerializedFMUstateSize(c, state, &size));
    fmi2Byte *bytes = malloc(size);
    if (!bytes) exit(2);
    EXPECT(fmi2Error, SerializeFMUstate(c, state, bytes, size - 1));
    EXPECT(fmi2OK, SerializeFMUstate(c, state, bytes, size));
    advance(c, STEPS / 2, STEPS);
    read_outputs(c, ends);
    EXPECT(fmi2OK, SetFMUstate(c, state));
    advance(c, STEPS / 2, STEPS);
    read_outputs(c, again);
    EXPECT(0, memcmp(ends, again, sizeof again));
    fmi2Component second = make(NULL);
    EXPECT(fmi2Error, DeSerializeFMUstate(second, bytes, size - 8, &other));
    EXPECT(fmi2OK, DeSerializeFMUstate(second, bytes, size, &other));
    bytes[size - 5] ^= 1;
    EXPECT(fmi2Error, DeSerializeFMUstate(second, bytes, size, &other));
    EXPECT(fmi2OK, SetFMUstate(second, other));
    advance(second, STEPS / 2, STEPS);
    read_outputs(second, again);
    EXPECT(0, memcmp(ends, again, sizeof again));
    EXPECT(fmi2OK, FreeFMUstate(second, &other));
    EXPECT(fmi2OK, FreeFMUstate(c, &state));
    EXPECT(1, state == NULL);
    EXPECT(fmi2OK, FreeFMUstate(c, &state));
    free(bytes);
#ifndef FORGETFUL
    FreeInstance(second);
#endif
}

int main(int count, char **words) {
    double first[MOST], second[MOST];
    if (count < 5) return 2;
    load(words[1]);
    guid = words[2];
    step = atof(words[3]);
    for (char *word = strtok(words[4], ","); word && output_count < MOST; word = strtok(NULL, ","))
        outputs[output_count++] = (fmi2ValueReference)atoi(word);
    settings = words + 5;
    setting_count = count - 5;
    EXPECT(0, strcmp(GetVersion(), "2.0"));
    EXPECT(0, strcmp(GetTypesPlatform(), "default"));
    without_instance();
    fmi2Component c = make("hosted");
    if (!c) return 3;
    misuse_before(c);
    start(c);
    misuse(c);
    EXPECT(fmi2OK, DoStep(c, 0.0, 0.0, fmi2True));
    replay(c, first);
    EXPECT(fmi2Error, DoStep(c, STEPS * step, step, fmi2True)); /* beyond the stop time */
    EXPECT(fmi2OK, Terminate(c));
    EXPECT(fmi2Error, DoStep(c, STEPS * step, step, fmi2True));
    EXPECT(fmi2OK, Reset(c));
    start(c);
    replay(c, second);
    EXPECT(0, memcmp(first, second, sizeof first));
    FreeInstance(c);
    for (size_t k = 0; k < output_count; k++) printf("%a\n", first[k]);
    fprintf(stderr, "%d checks, %d failed, %d messages\n", checks, failures, heard);
    return failures ? 1 : 0;
}
