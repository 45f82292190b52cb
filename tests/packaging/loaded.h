/* An FMU's library, loaded as a tool loads it, and calls that are told when they give what was not expected. */

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>

#include "fmi2FunctionTypes.h"

#define FUNCTIONS(DO)                                                                                                  \
    DO(GetVersion) DO(GetTypesPlatform) DO(SetDebugLogging) DO(Instantiate) DO(FreeInstance) DO(SetupExperiment)       \
    DO(EnterInitializationMode) DO(ExitInitializationMode) DO(Terminate) DO(Reset) DO(GetReal) DO(GetInteger)          \
    DO(GetBoolean) DO(GetString) DO(SetReal) DO(SetInteger) DO(SetBoolean) DO(SetString) DO(GetFMUstate)               \
    DO(SetFMUstate) DO(FreeFMUstate) DO(SerializedFMUstateSize) DO(SerializeFMUstate) DO(DeSerializeFMUstate)          \
    DO(GetDirectionalDerivative) DO(SetRealInputDerivatives) DO(GetRealOutputDerivatives) DO(DoStep) DO(CancelStep)    \
    DO(GetStatus) DO(GetRealStatus) DO(GetIntegerStatus) DO(GetBooleanStatus) DO(GetStringStatus)

#define DECLARE(NAME) static fmi2##NAME##TYPE *NAME;
FUNCTIONS(DECLARE)

static int failures, checks;
static char last[2048]; /* the latest message of the FMU */

#define EXPECT(STATUS, CALL)                                                                                           \
    do {                                                                                                               \
        int got = (int)(CALL);                                                                                         \
        checks++;                                                                                                      \
        if (got != (int)(STATUS)) {                                                                                    \
            failures++;                                                                                                \
            fprintf(stderr, "line %d: %s gave %d, expected %d (%s)\n", __LINE__, #CALL, got, (int)(STATUS), last);     \
        }                                                                                                              \
    } while (0)

static void *load(const char *path) {
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        fprintf(stderr, "%s\n", dlerror());
        exit(2);
    }
#define LOOK_UP(NAME)                                                                                                  \
    *(void **)&NAME = dlsym(library, "fmi2" #NAME);                                                                    \
    if (!NAME) exit(3);
    FUNCTIONS(LOOK_UP)
    return library;
}
