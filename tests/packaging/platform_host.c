/* A plain importer: loads an FMU's library, makes an experiment, prints what it is asked for after every step.

   platform_host LIBRARY GUID STEP COUNT [=REFERENCE:VALUE | =REFERENCEi:VALUE | ?REFERENCE | @PATH | +PATH]...

   =7:2.5 sets a Real parameter, =7i:3 an Integer one, ?9 asks for a Real output; @PATH names a file for the serialised
   state at the end, and +PATH one that holds a serialised state to go on from. C99, and nothing but what each system calls its loader. */

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2FunctionTypes.h"

#ifdef _WIN32
#include <windows.h>
static HMODULE library;
static int load(const char *path) { return (library = LoadLibraryA(path)) != NULL; }
static void (*find(const char *name))(void) { return (void (*)(void))GetProcAddress(library, name); }
#else
#include <dlfcn.h>
static void *library;
static int load(const char *path) { return (library = dlopen(path, RTLD_NOW)) != NULL; }
static void (*find(const char *name))(void) { return (void (*)(void))dlsym(library, name); }
#endif

enum { MOST = 512, MOST_BYTES = 1 << 24 };

#define CALL(NAME) ((NAME##TYPE *)call(#NAME))

static void fail(const char *what) {
    fprintf(stderr, "%s\n", what);
    exit(1);
}

static void (*call(const char *name))(void) {
    void (*function)(void) = find(name);
    if (!function) fail(name);
    return function;
}

static void require(fmi2Status status, const char *what) {
    if (status != fmi2OK) fail(what);
}

static void log_message(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                        fmi2String message, ...) {
    (void)environment;
    (void)message;
    fprintf(stderr, "%s: status %d, %s\n", name, (int)status, category);
}

static void write_state(fmi2Component c, const char *path) {
    fmi2FMUstate state = NULL;
    size_t size = 0;
    require(CALL(fmi2GetFMUstate)(c, &state), "fmi2GetFMUstate");
    require(CALL(fmi2SerializedFMUstateSize)(c, state, &size), "fmi2SerializedFMUstateSize");
    fmi2Byte *bytes = malloc(size);
    FILE *file = fopen(path, "wb");
    if (!bytes || !file) fail(path);
    require(CALL(fmi2SerializeFMUstate)(c, state, bytes, size), "fmi2SerializeFMUstate");
    if (fwrite(bytes, 1, size, file) != size || fclose(file)) fail(path);
    free(bytes);
    require(CALL(fmi2FreeFMUstate)(c, &state), "fmi2FreeFMUstate");
}

/* Goes on from a serialised state; the time at which that is. */
static double read_state(fmi2Component c, const char *path) {
    static fmi2Byte bytes[MOST_BYTES];
    fmi2FMUstate state = NULL;
    fmi2Real time = 0.0;
    FILE *file = fopen(path, "rb");
    if (!file) fail(path);
    size_t size = fread(bytes, 1, MOST_BYTES, file);
    if (size == MOST_BYTES || fclose(file)) fail(path);
    require(CALL(fmi2DeSerializeFMUstate)(c, bytes, size, &state), "fmi2DeSerializeFMUstate");
    require(CALL(fmi2SetFMUstate)(c, state), "fmi2SetFMUstate");
    require(CALL(fmi2FreeFMUstate)(c, &state), "fmi2FreeFMUstate");
    require(CALL(fmi2GetRealStatus)(c, fmi2LastSuccessfulTime, &time), "fmi2GetRealStatus");
    return time;
}

int main(int count, char **given) {
    static fmi2ValueReference asked[MOST];
    static fmi2Real values[MOST];
    size_t n = 0;
    const char *state = NULL, *earlier = NULL;
    if (count < 5) fail("platform_host LIBRARY GUID STEP COUNT ...");
    if (!load(given[1])) fail("the library can not be loaded");
    fmi2CallbackFunctions functions = {log_message, calloc, free, NULL, NULL};
    fmi2Component c = CALL(fmi2Instantiate)("host", fmi2CoSimulation, given[2], "", &functions, fmi2False, fmi2False);
    if (!c) fail("fmi2Instantiate");
    for (int k = 5; k < count; k++) {
        char *rest;
        fmi2ValueReference reference = (fmi2ValueReference)strtoul(given[k] + 1, &rest, 10);
        if (given[k][0] == '@') {
            state = given[k] + 1;
        } else if (given[k][0] == '+') {
            earlier = given[k] + 1;
        } else if (given[k][0] == '?' && n < MOST) {
            asked[n++] = reference;
        } else if (*rest == 'i') {
            fmi2Integer value = atoi(rest + 2);
            require(CALL(fmi2SetInteger)(c, &reference, 1, &value), given[k]);
        } else {
            fmi2Real value = strtod(rest + 1, NULL);
            require(CALL(fmi2SetReal)(c, &reference, 1, &value), given[k]);
        }
    }
    require(CALL(fmi2SetupExperiment)(c, fmi2False, 0.0, 0.0, fmi2False, 0.0), "fmi2SetupExperiment");
    require(CALL(fmi2EnterInitializationMode)(c), "fmi2EnterInitializationMode");
    require(CALL(fmi2ExitInitializationMode)(c), "fmi2ExitInitializationMode");
    const double step = strtod(given[3], NULL), begin = earlier ? read_state(c, earlier) : 0.0;
    for (int i = 0; i < atoi(given[4]); i++) {
        require(CALL(fmi2DoStep)(c, begin + i * step, step, fmi2True), "fmi2DoStep");
        require(CALL(fmi2GetReal)(c, asked, n, values), "fmi2GetReal");
        for (size_t k = 0; k < n; k++) printf("%.17g%c", values[k], k + 1 < n ? ' ' : '\n');
    }
    if (state) write_state(c, state);
    require(CALL(fmi2Terminate)(c), "fmi2Terminate");
    CALL(fmi2FreeInstance)(c);
    return 0;
}
