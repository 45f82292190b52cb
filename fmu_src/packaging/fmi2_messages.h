/* Part of fmi2.c: names, faults of the kernel, and the order of calls. */

enum { NAME_LENGTH = 160 };

/* The row a slot belongs to: the last that begins at or before it. */
static const struct row *row_of(fmi2ValueReference reference) {
    int low = 0, high = DCONE_ROWS;
    while (high - low > 1) {
        int middle = (low + high) / 2;
        if ((fmi2ValueReference)row_table[middle].first <= reference) low = middle;
        else high = middle;
    }
    return &row_table[low];
}

/* Name of the variable in a slot, with its indices. */
static const char *name_of(fmi2ValueReference reference, char text[NAME_LENGTH]) {
    const struct row *row = row_of(reference);
    int element = (int)reference - row->first, used = 0, n = 0;
    int index[] = {element / row->columns + 1, element % row->columns + 1};
    for (const char *c = row->name; *c && n < NAME_LENGTH - 12; c++) {
        if (*c == '#' && used < 2) n += snprintf(text + n, (size_t)(NAME_LENGTH - n), "%d", index[used++]);
        else text[n++] = *c;
    }
    text[n] = 0;
    return text;
}

/* Tell why the kernel stopped: the text of its fault, which, how much and when. */
static fmi2Status tell_fault(instance *i, int64_t command) {
    const slot *r = i->block;
    const struct fault *f = fault_table;
    while (f->code && f->code != r[FAULT_CODE].integer) f++;
    int refused = command == STEP && f->severity != SEVERITY_ERROR;
    i->at.phase = refused ? FAILED : BROKEN;
    if (refused && f->severity == SEVERITY_END) {
        i->at.ended = 1;
        if (r[FAULT_TIME].real >= i->at.time) i->at.time = r[FAULT_TIME].real;
    }
    fmi2Status status = refused ? fmi2Discard : fmi2Error;
    double value = r[FAULT_VALUE].real, when = r[FAULT_TIME].real;
    int64_t index = r[FAULT_INDEX].integer;
    char name[NAME_LENGTH];
    if (f->names && index > FAULT_VALUE && index < DCONE_SLOTS)
        return say(i, status, "%s (%s, value %.9g, at %.9g s)", f->text, name_of((fmi2ValueReference)index, name),
                   value, when);
    if (!index) return say(i, status, "%s (value %.9g, at %.9g s)", f->text, value, when);
    return say(i, status, "%s (index %lld, value %.9g, at %.9g s)", f->text, (long long)index, value, when);
}

/* Whether a call may be made now; `phases` are those in which it may. */
static int allowed(instance *i, int phases, const char *call) {
    if (!i) return 0;
    if (i->at.phase & phases) return 1;
    const char *where = i->at.phase == INSTANTIATED   ? "instantiated and not yet initialising"
                        : i->at.phase == INITIALISING ? "initialising"
                        : i->at.phase == STEPPING     ? "stepping"
                        : i->at.phase == TERMINATED   ? "terminated"
                        : i->at.phase == BROKEN       ? "broken by an earlier error"
                        : i->at.ended                 ? "at its own end"
                                                      : "left in a step that was discarded";
    say(i, fmi2Error, "%s is not allowed while the instance is %s, at %.9g s", call, where, i->at.time);
    return 0;
}
