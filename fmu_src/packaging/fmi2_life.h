/* Part of fmi2.c: an instance from its making to its end. */

enum { LINE = 64 / sizeof(slot) };

/* Give the instance a zeroed block for so much work, which begins at a multiple of 64 bytes: vectors that straddle such
   a boundary are stored at half the speed. What the old block held is kept as far as it fits. */
static int take_block(instance *i, int64_t work, size_t kept) {
    slot *memory = calloc(DCONE_SLOTS + (size_t)work + 1 + LINE, sizeof(slot));
    if (!memory) return 0;
    size_t over = (uintptr_t)(memory + DCONE_SLOTS) / sizeof(slot) % LINE;
    slot *block = memory + (over ? LINE - over : 0);
    if (kept) memcpy(block, i->block, kept);
    free(i->memory);
    i->memory = memory;
    i->block = block;
    return 1;
}

static int take_start_values(instance *i) {
    if (!take_block(i, 0, 0)) return 0;
    memset(&i->at, 0, sizeof i->at);
    i->at.phase = INSTANTIATED;
    i->at.stale = 1;
    memcpy(i->block, i->start, DCONE_SLOTS * sizeof(slot));
    return 1;
}

static int resize(instance *i, int64_t work) {
    if (work == i->at.work) return 1;
    if (!take_block(i, work, block_size(work < i->at.work ? work : i->at.work))) return 0;
    i->at.work = work;
    return 1;
}

static int fits(const struct row *row, double value) {
    return isfinite(value) && value >= row->low && value <= row->high && !(row->open && value == row->low);
}

static fmi2Status refuse_value(instance *i, fmi2ValueReference reference, double value) {
    char name[NAME_LENGTH];
    const struct row *row = row_of(reference);
    return say(i, fmi2Error, "%s = %.9g %s is out of its bounds: it must be finite, %s %.9g and at most %.9g",
               name_of(reference, name), value, row->unit, row->open ? "greater than" : "at least", row->low,
               row->high);
}

/* Whether all parameters and inputs are within their bounds. */
static fmi2Status check_bounds(instance *i) {
    for (const struct row *row = row_table; row < row_table + DCONE_ROWS; row++)
        for (int s = row->first; row->bounded && s < row->first + row->count; s++) {
            double value = (slot_code[s] & 3) == REAL ? i->block[s].real : (double)i->block[s].integer;
            if (!fits(row, value)) return refuse_value(i, (fmi2ValueReference)s, value);
        }
    return fmi2OK;
}

/* Work out state and outputs from the parameters. */
static fmi2Status settle(instance *i) {
    if (!i->at.stale) return fmi2OK;
    fmi2Status status = check_bounds(i);
    if (status != fmi2OK) return status;
    i->block[FAULT_CODE].integer = 0;
    int32_t fault = run(i, SIZE, i->at.time, 0.0);
    int64_t work = i->block[WORK_SIZE].integer;
    i->block[WORK_SIZE].integer = i->at.work;
    if (fault) return tell_fault(i, SIZE);
    if (!resize(i, work)) return say(i, fmi2Error, "no memory for %lld numbers", (long long)work);
    i->block[WORK_SIZE].integer = work;
    memset(i->block + DCONE_SLOTS, 0, (size_t)work * sizeof(slot)); /* so that the same start is the same to the bit */
    if (run(i, INITIALISE, i->at.time, 0.0)) return tell_fault(i, INITIALISE);
    i->at.stale = i->at.moved = i->at.derived = 0;
    return fmi2OK;
}

static void release(instance *i) {
    free(i->name);
    free(i->memory);
    free(i->start);
    dcone_unmap(i->tables, i->tables_size);
    free(i);
}

/* The importer's memory functions are left unused, as canNotUseMemoryManagementFunctions says: a block grows when the
   parameters ask for it, and they offer no realloc. */
fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging) {
    (void)visible;
    instance *i = calloc(1, sizeof *i);
    if (!i) return NULL;
    if (functions) i->callbacks = *functions;
    i->logged = logging ? ALL : ERRORS | DISCARDS;
    const char *given_name = name && *name ? name : DCONE_IDENTIFIER;
    i->name = malloc(strlen(given_name) + 1);
    if (i->name) strcpy(i->name, given_name);
    int good = i->name != NULL;
    if (good && type != fmi2CoSimulation) {
        say(i, fmi2Error, "this FMU is for co-simulation only");
        good = 0;
    }
    if (good && read_start_values(i, resources, guid) && take_tables(i, resources) && take_start_values(i)) return i;
    release(i);
    return NULL;
}

void fmi2FreeInstance(fmi2Component c) {
    if (c) release(c);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean has_stop, fmi2Real stop) {
    instance *i = c;
    if (!allowed(i, INSTANTIATED, "fmi2SetupExperiment")) return fmi2Error;
    if (!isfinite(start)) return say(i, fmi2Error, "the start time must be finite");
    if (has_stop && !(isfinite(stop) && stop >= start))
        return say(i, fmi2Error, "the stop time %.9g s must be finite and not before the start, %.9g s", stop, start);
    if (has_tolerance) say(i, fmi2OK, "tolerance %.9g left unused: the solver has parameters of its own", tolerance);
    i->at.time = start;
    i->at.has_stop = has_stop != fmi2False;
    i->at.stop = has_stop ? stop : 0.0;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    instance *i = c;
    if (!allowed(i, INSTANTIATED, "fmi2EnterInitializationMode")) return fmi2Error;
    i->at.phase = INITIALISING;
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    instance *i = c;
    if (!allowed(i, INITIALISING, "fmi2ExitInitializationMode")) return fmi2Error;
    fmi2Status status = settle(i);
    if (status != fmi2OK) return status;
    i->at.phase = STEPPING;
    return say(i, fmi2OK, "initialised at %.9g s, with %lld numbers of memory", i->at.time, (long long)i->at.work);
}

fmi2Status fmi2Terminate(fmi2Component c) {
    instance *i = c;
    if (!allowed(i, STEPPING | FAILED, "fmi2Terminate")) return fmi2Error;
    i->at.phase = TERMINATED;
    return say(i, fmi2OK, "terminated at %.9g s", i->at.time);
}

fmi2Status fmi2Reset(fmi2Component c) {
    instance *i = c;
    if (!i) return fmi2Error;
    if (!take_start_values(i)) return say(i, fmi2Error, "no memory");
    return say(i, fmi2OK, "reset to the start values");
}

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }
