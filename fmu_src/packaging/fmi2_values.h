/* Part of fmi2.c: reading and writing variables. */

/* Slot of a variable at the interface of the type asked for, or NULL with a message. */
static slot *readable(instance *i, fmi2ValueReference reference, int kind) {
    if (reference >= DCONE_SLOTS || (slot_code[reference] & 3) != kind || slot_code[reference] >> 2 == HIDDEN) {
        say(i, fmi2Error, "value reference %u is no variable of the type asked for", reference);
        return NULL;
    }
    return &i->block[reference];
}

/* Bring the outputs up to date before they are read: after parameters were set, or inputs they depend on directly. */
static fmi2Status ready(instance *i, int phases, const char *call) {
    if (!allowed(i, phases, call)) return fmi2Error;
    if (i->at.phase == INITIALISING) return settle(i);
    if (i->at.phase == BROKEN) return say(i, fmi2Warning, "%s: what an earlier error left, for debugging only", call);
    if (DCONE_PARTIALS > 0 && i->at.phase == STEPPING && i->at.moved) {
        i->block[FAULT_CODE].integer = 0;
        if (run(i, REFRESH, i->at.time, 0.0)) return tell_fault(i, REFRESH);
        i->at.moved = 0;
    }
    return fmi2OK;
}

static fmi2Status refuse_infinite(instance *i, fmi2ValueReference reference, const char *verb) {
    char name[NAME_LENGTH];
    return say(i, fmi2Error, "%s %s a number that is not finite", name_of(reference, name), verb);
}

enum { READ_PHASES = INITIALISING | STEPPING | FAILED | TERMINATED | BROKEN };
enum { WRITE_PHASES = INSTANTIATED | INITIALISING | STEPPING };

#define GET(NAME, TYPE, KIND, FIELD, USABLE)                                                                           \
    fmi2Status NAME(fmi2Component c, const fmi2ValueReference vr[], size_t n, TYPE value[]) {                          \
        instance *i = c;                                                                                               \
        fmi2Status status = ready(i, READ_PHASES, #NAME);                                                              \
        if (status > fmi2Warning || !given(i, n, vr, value, #NAME)) return fmi2Error;                                  \
        for (size_t k = 0; k < n; k++) {                                                                               \
            const slot *s = readable(i, vr[k], KIND);                                                                  \
            if (!s) return fmi2Error;                                                                                  \
            if (!(USABLE)) return refuse_infinite(i, vr[k], "is");                                                     \
            value[k] = (TYPE)s->FIELD;                                                                                 \
        }                                                                                                              \
        return status;                                                                                                 \
    }

/* Whether a variable may be set now. */
static fmi2Status writable(instance *i, fmi2ValueReference reference) {
    char name[NAME_LENGTH];
    int access = slot_code[reference] >> 2;
    if (access == INPUT || (access == PARAMETER && i->at.phase != STEPPING)) return fmi2OK;
    return say(i, fmi2Error, access == PARAMETER ? "%s is a parameter, fixed once the initialisation is over"
                                                 : "%s is an output and can not be set", name_of(reference, name));
}

/* Slot of the time derivative of an input or output; -1 if it has none. */
static int rate_slot(fmi2ValueReference reference) {
    int low = 0, high = DCONE_RATES;
    while (low < high) {
        int middle = (low + high) / 2;
        if ((fmi2ValueReference)rate_table[middle].slot < reference) low = middle + 1;
        else high = middle;
    }
    return low < DCONE_RATES && (fmi2ValueReference)rate_table[low].slot == reference ? rate_table[low].rate : -1;
}

/* What follows from a variable having been set: outputs are out of date, and an input no longer moves. */
static void note_set(instance *i, fmi2ValueReference reference) {
    if (i->at.phase != STEPPING) i->at.stale = 1;
    i->at.moved = 1;
    i->at.derived = 0;
    if (slot_code[reference] >> 2 == INPUT && rate_slot(reference) >= 0) i->block[rate_slot(reference)].real = 0.0;
}

/* A call sets all of its values or none. Parameters may pass through values out of bounds until they are used. */
#define SET(NAME, TYPE, KIND, FIELD, USABLE, STORED)                                                                   \
    fmi2Status NAME(fmi2Component c, const fmi2ValueReference vr[], size_t n, const TYPE value[]) {                    \
        instance *i = c;                                                                                               \
        if (!allowed(i, WRITE_PHASES, #NAME) || !given(i, n, vr, value, #NAME)) return fmi2Error;                      \
        for (size_t k = 0; k < n; k++) {                                                                               \
            if (!readable(i, vr[k], KIND) || writable(i, vr[k]) != fmi2OK) return fmi2Error;                           \
            if (!(USABLE)) return refuse_infinite(i, vr[k], "was given");                                              \
            if (KIND != BOOLEAN && i->at.phase == STEPPING && !fits(row_of(vr[k]), (double)value[k]))                  \
                return refuse_value(i, vr[k], (double)value[k]);                                                       \
        }                                                                                                              \
        for (size_t k = 0; k < n; k++) {                                                                               \
            i->block[vr[k]].FIELD = STORED;                                                                            \
            note_set(i, vr[k]);                                                                                        \
        }                                                                                                              \
        return fmi2OK;                                                                                                 \
    }

GET(fmi2GetReal, fmi2Real, REAL, real, isfinite(s->real))
GET(fmi2GetInteger, fmi2Integer, INTEGER, integer, 1)
GET(fmi2GetBoolean, fmi2Boolean, BOOLEAN, integer, 1)
SET(fmi2SetReal, fmi2Real, REAL, real, isfinite(value[k]), value[k])
SET(fmi2SetInteger, fmi2Integer, INTEGER, integer, 1, value[k])
SET(fmi2SetBoolean, fmi2Boolean, BOOLEAN, integer, 1, value[k] != 0)

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2String value[]) {
    (void)vr, (void)value;
    if (!allowed(c, READ_PHASES, "fmi2GetString")) return fmi2Error;
    return n == 0 ? fmi2OK : say(c, fmi2Error, "this FMU has no String variables");
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2String value[]) {
    (void)vr, (void)value;
    if (!allowed(c, WRITE_PHASES, "fmi2SetString")) return fmi2Error;
    return n == 0 ? fmi2OK : say(c, fmi2Error, "this FMU has no String variables");
}
