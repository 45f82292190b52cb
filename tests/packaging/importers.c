/* An FMU run as other tools run it: the calls they make, in their order, with the arguments they give.

       importers LIBRARY GUID RESOURCES STEP VARIABLES

   RESOURCES is the path of the unpacked folder. VARIABLES is a file with a line for each variable: its type (r, i, b),
   its causality (p, i, o), its value reference, whether a user sets it, and to what. Every tool runs STEPS steps; the
   library is loaded, run by all of them, unloaded, and all that once more. Prints, for each tool, the Real outputs at
   the end as hexadecimal floats on a line; returns 0 if every call gave what was expected.

   Source   FMUComplianceChecker: src/FMI2/fmi2_cs_sim.c, fmi2_check.c. Reference-FMUs: fmusim/FMI2CSSimulation.c.
            fmi4c: test/fmi4c_test_fmi2.c. MasterSim: MasterSim/src/MSIM_FMUSlave.cpp, MSIM_AlgorithmGaussSeidel.cpp */

#include <math.h>
#include <stdarg.h>
#include <string.h>

#include "loaded.h"

enum { STEPS = 6, MOST = 4000 };

struct variable { char type, causality; fmi2ValueReference reference; int set; double value; };
typedef struct { fmi2ValueReference reference[MOST]; size_t count; } list;

static struct variable variables[MOST];
static size_t variable_count;
static list reals, integers, booleans; /* outputs */
static const char *library_path, *guid, *resources;
static double step;

static fmi2ComponentEnvironment environment; /* what the tool gave, and is to get back */
static char name[80];                        /* likewise, but as a copy: this one is gone when the instance is made */
static char instance_name[80];
static int heard, reserved;

static void hear(fmi2ComponentEnvironment from, fmi2String who, fmi2Status status, fmi2String category,
                 fmi2String message, ...) {
    (void)status;
    va_list arguments;
    va_start(arguments, message);
    vsnprintf(last, sizeof last, message, arguments);
    va_end(arguments);
    heard++;
    EXPECT(1, from == environment && !strcmp(who, instance_name) && who != name && category != NULL);
}

static void *reserve(size_t count, size_t size) { return reserved++, calloc(count, size); }
static void give_back(void *memory) { if (memory) reserved--, free(memory); }

/* `prefix` and `suffix` are put about the folder of resources, as the tool spells a location. */
static fmi2Component make(const char *who, const char *prefix, const char *suffix, fmi2Boolean logging,
                          fmi2ComponentEnvironment from) {
    char location[4096];
    fmi2CallbackFunctions callbacks = {hear, reserve, give_back, NULL, from};
    static fmi2CallbackFunctions kept; /* FMI has them stay where they are */
    kept = callbacks;
    environment = from;
    snprintf(location, sizeof location, "%s%s%s", prefix, resources, suffix);
    snprintf(name, sizeof name, "%s", who);
    snprintf(instance_name, sizeof instance_name, "%s", who);
    fmi2Component c = Instantiate(name, fmi2CoSimulation, guid, location, &kept, fmi2False, logging);
    EXPECT(1, c != NULL);
    if (!c) exit(4);
    memset(name, '?', sizeof name - 1);
    return c;
}

static void set(fmi2Component c, const struct variable *v) {
    fmi2Integer whole = (fmi2Integer)v->value;
    if (v->type == 'r') EXPECT(fmi2OK, SetReal(c, &v->reference, 1, &v->value));
    if (v->type == 'i') EXPECT(fmi2OK, SetInteger(c, &v->reference, 1, &whole));
    if (v->type == 'b') EXPECT(fmi2OK, SetBoolean(c, &v->reference, 1, &whole));
}

/* Set what a user sets, of one causality, one by one. */
static void set_chosen(fmi2Component c, char causality) {
    for (size_t k = 0; k < variable_count; k++)
        if (variables[k].set && variables[k].causality == causality) set(c, &variables[k]);
}

static void read_one_by_one(fmi2Component c) {
    for (size_t k = 0; k < variable_count; k++) {
        const struct variable *v = &variables[k];
        double real = NAN;
        fmi2Integer whole = -99;
        if (v->type == 'r') EXPECT(fmi2OK, GetReal(c, &v->reference, 1, &real));
        if (v->type == 'i') EXPECT(fmi2OK, GetInteger(c, &v->reference, 1, &whole));
        if (v->type == 'b') EXPECT(fmi2OK, GetBoolean(c, &v->reference, 1, &whole));
        EXPECT(1, v->type == 'r' ? isfinite(real) : v->type == 'i' ? whole != -99 : whole == 0 || whole == 1);
    }
}

/* The outputs of each type by one call, also where there are none. */
static void read_lists(fmi2Component c) {
    static double real[MOST];
    static fmi2Integer whole[MOST];
    EXPECT(fmi2OK, GetReal(c, reals.reference, reals.count, real));
    EXPECT(fmi2OK, GetInteger(c, integers.reference, integers.count, whole));
    EXPECT(fmi2OK, GetBoolean(c, booleans.reference, booleans.count, whole));
    EXPECT(fmi2OK, GetString(c, NULL, 0, NULL));
}

static void print_reals(fmi2Component c) {
    static double real[MOST];
    EXPECT(fmi2OK, GetReal(c, reals.reference, reals.count, real));
    for (size_t k = 0; k < reals.count; k++) printf("%a%c", real[k], k + 1 < reals.count ? ' ' : '\n');
}

/* FMUChecker, by FMILibrary: all variables read one at a time, parameters too; no stop time; the inputs set before each
   step; time added up, the last step cut to the end. */
static void run_checker(void) {
    int cookie;
    EXPECT(0, strcmp(GetVersion(), "2.0"));
    EXPECT(0, strcmp(GetTypesPlatform(), "default"));
    fmi2Component c = make("Test FMI 2.0 CS", "file://", "", fmi2True, &cookie);
    set_chosen(c, 'p');
    set_chosen(c, 'i');
    EXPECT(fmi2OK, SetupExperiment(c, fmi2False, 1e-4, 0.0, fmi2False, 0.0));
    EXPECT(fmi2OK, EnterInitializationMode(c));
    EXPECT(fmi2OK, ExitInitializationMode(c));
    read_one_by_one(c);
    double time = 0.0, end = STEPS * step, h = step;
    while (time < end) {
        double next = time + h;
        if (next > end - 1e-3 * h) h = end - time, next = end;
        set_chosen(c, 'i');
        EXPECT(fmi2OK, DoStep(c, time, h, fmi2True));
        time = next;
        read_one_by_one(c);
    }
    print_reals(c);
    EXPECT(fmi2OK, Terminate(c));
    FreeInstance(c);
    EXPECT(1, heard > 0);
}

static void save(fmi2Component c, fmi2Byte **bytes, size_t *size) {
    fmi2FMUstate state = NULL;
    EXPECT(fmi2OK, GetFMUstate(c, &state));
    EXPECT(fmi2OK, SerializedFMUstateSize(c, state, size));
    *bytes = calloc(*size, 1);
    EXPECT(fmi2OK, SerializeFMUstate(c, state, *bytes, *size));
    EXPECT(fmi2OK, FreeFMUstate(c, &state));
}

/* What was saved, in an instance that has seen nothing else; the pointer was never given a value. */
static void restore(fmi2Component c, const fmi2Byte bytes[], size_t size) {
    fmi2FMUstate state = (fmi2FMUstate)(size_t)0xdeadbeef;
    EXPECT(fmi2OK, DeSerializeFMUstate(c, bytes, size, &state));
    EXPECT(fmi2OK, SetFMUstate(c, state));
    EXPECT(fmi2OK, FreeFMUstate(c, &state));
}

/* fmusim: no logging; inputs set again in initialization mode; times i h; the state at half the way kept in a file, and
   gone on from in another instance that is never initialised. */
static void run_fmusim(void) {
    int cookie;
    fmi2Byte *bytes = NULL;
    size_t size = 0;
    for (int part = 0; part < 2; part++) {
        fmi2Component c = make("instance1", "file://", "/", fmi2False, &cookie);
        if (part) restore(c, bytes, size);
        set_chosen(c, part ? 'i' : 'p');
        if (!part) {
            EXPECT(fmi2OK, SetupExperiment(c, fmi2True, 1e-6, 0.0, fmi2False, 0.0));
            EXPECT(fmi2OK, EnterInitializationMode(c));
            set_chosen(c, 'i');
            EXPECT(fmi2OK, ExitInitializationMode(c));
        }
        for (int k = part * STEPS / 2; k < (part + 1) * STEPS / 2; k++) {
            read_lists(c);
            set_chosen(c, 'i');
            EXPECT(fmi2OK, DoStep(c, k * step, step, fmi2True));
        }
        if (part) print_reals(c);
        else save(c, &bytes, &size);
        EXPECT(fmi2OK, Terminate(c));
        FreeInstance(c);
    }
    free(bytes);
}

/* fmi4c: a path for a location, no environment; Reals asked of every output, whatever its type, and what is answered
   ignored; one step beyond the end, of which nothing was said. */
static void run_fmi4c(void) {
    fmi2Component c = make("fmi4c", "", "", fmi2True, NULL);
    set_chosen(c, 'p');
    set_chosen(c, 'i');
    EXPECT(fmi2OK, SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0));
    EXPECT(fmi2OK, EnterInitializationMode(c));
    EXPECT(fmi2OK, ExitInitializationMode(c));
    double time = 0.0, value;
    while (time <= STEPS * step) {
        set_chosen(c, 'i');
        if (time == STEPS * step) print_reals(c);
        EXPECT(fmi2OK, DoStep(c, time, step, fmi2True));
        for (size_t k = 0; k < variable_count; k++)
            if (variables[k].causality == 'o')
                EXPECT(variables[k].type == 'r' ? fmi2OK : fmi2Error, GetReal(c, &variables[k].reference, 1, &value));
        time += step;
    }
    EXPECT(fmi2OK, Terminate(c));
    FreeInstance(c);
}

/* MasterSim: tolerance and stop time; each step made, taken back, and made again; never terminated. Two instances. */
static void run_mastersim(void) {
    fmi2Component c[2];
    fmi2FMUstate before[2] = {NULL, NULL};
    for (int s = 0; s < 2; s++) {
        c[s] = make("slave", "file://", "", fmi2True, NULL);
        set_chosen(c[s], 'p');
        EXPECT(fmi2OK, SetupExperiment(c[s], fmi2True, 1e-5, 0.0, fmi2True, STEPS * step));
        EXPECT(fmi2OK, EnterInitializationMode(c[s]));
        set_chosen(c[s], 'i');
        read_lists(c[s]);
        EXPECT(fmi2OK, ExitInitializationMode(c[s]));
        read_lists(c[s]);
    }
    double time = 0.0;
    for (int k = 0; k < STEPS; k++, time += step) {
        for (int s = 0; s < 2; s++) EXPECT(fmi2OK, GetFMUstate(c[s], &before[s]));
        for (int iteration = 0; iteration < 2; iteration++)
            for (int s = 0; s < 2; s++) {
                if (iteration) EXPECT(fmi2OK, SetFMUstate(c[s], before[s]));
                set_chosen(c[s], 'i');
                EXPECT(fmi2OK, DoStep(c[s], time, step, fmi2False));
                read_lists(c[s]);
            }
    }
    print_reals(c[0]);
    for (int s = 0; s < 2; s++) EXPECT(fmi2OK, FreeFMUstate(c[s], &before[s]));
    FreeInstance(c[0]);
    FreeInstance(c[1]);
}

/* What none of them asks for, but any may: nothing at all, in every state; what is pending; other logging. */
static void ask_for_nothing(void) {
    fmi2Component c = make("idle", "file://", "", fmi2False, NULL);
    fmi2Status status;
    fmi2Integer whole;
    fmi2String text;
    int before = heard;
    EXPECT(fmi2OK, SetDebugLogging(c, fmi2True, 0, NULL));
    for (int state = 0; state < 4; state++) {
        int readable = state > 0 ? fmi2OK : fmi2Error, writable = state < 3 ? fmi2OK : fmi2Error;
        EXPECT(readable, GetReal(c, NULL, 0, NULL));
        EXPECT(readable, GetInteger(c, NULL, 0, NULL));
        EXPECT(readable, GetBoolean(c, NULL, 0, NULL));
        EXPECT(readable, GetString(c, NULL, 0, NULL));
        EXPECT(writable, SetReal(c, NULL, 0, NULL));
        EXPECT(writable, SetInteger(c, NULL, 0, NULL));
        EXPECT(writable, SetBoolean(c, NULL, 0, NULL));
        EXPECT(writable, SetString(c, NULL, 0, NULL));
        EXPECT(fmi2Error, CancelStep(c));
        EXPECT(state > 1 ? fmi2Discard : fmi2Error, GetStatus(c, fmi2DoStepStatus, &status));
        EXPECT(state > 1 ? fmi2Discard : fmi2Error, GetIntegerStatus(c, fmi2DoStepStatus, &whole));
        EXPECT(state > 1 ? fmi2Discard : fmi2Error, GetStringStatus(c, fmi2PendingStatus, &text));
        if (state == 0) EXPECT(fmi2OK, EnterInitializationMode(c)); /* without an experiment */
        if (state == 1) EXPECT(fmi2OK, ExitInitializationMode(c));
        if (state == 2) EXPECT(fmi2OK, Terminate(c));
    }
    EXPECT(1, heard > before);
    FreeInstance(c);
}

static void read_variables(const char *path) {
    FILE *file = fopen(path, "r");
    struct variable v;
    if (!file) exit(2);
    while (fscanf(file, " %c %c %u %d %lf", &v.type, &v.causality, &v.reference, &v.set, &v.value) == 5) {
        if (variable_count == MOST) exit(2);
        variables[variable_count++] = v;
        list *of = v.type == 'r' ? &reals : v.type == 'i' ? &integers : &booleans;
        if (v.causality == 'o') of->reference[of->count++] = v.reference;
    }
    fclose(file);
}

int main(int count, char **words) {
    if (count != 6) return 2;
    library_path = words[1], guid = words[2], resources = words[3], step = atof(words[4]);
    read_variables(words[5]);
    for (int round = 0; round < 2; round++) {
        void *library = load(library_path);
        run_checker();
        run_fmusim();
        run_fmi4c();
        run_mastersim();
        ask_for_nothing();
        EXPECT(0, dlclose(library));
        EXPECT(1, dlopen(library_path, RTLD_NOW | RTLD_NOLOAD) == NULL); /* it is gone, and nothing of it holds it */
    }
    EXPECT(0, reserved);
    fprintf(stderr, "%d checks, %d failed, %d messages\n", checks, failures, heard);
    return failures ? 1 : 0;
}
