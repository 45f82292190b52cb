/* Part of fmi2.c: derivatives of inputs and outputs in time, and of outputs by inputs; all of order 1. */

/* Have the model fill the slots of its derivatives, unless they are those of now. */
static fmi2Status differentiate(instance *i, int phases, const char *call) {
    if (!allowed(i, phases, call)) return fmi2Error;
    fmi2Status status = ready(i, phases, call);
    if (status != fmi2OK || i->at.derived || DCONE_RATES + DCONE_PARTIALS == 0) return status;
    i->block[FAULT_CODE].integer = 0;
    if (run(i, DIFFERENTIATE, i->at.time, 0.0)) return tell_fault(i, DIFFERENTIATE);
    i->at.derived = 1;
    return fmi2OK;
}

/* Whether a value reference is a Real of that causality. */
static int is_real(instance *i, fmi2ValueReference reference, int access, const char *what) {
    char name[NAME_LENGTH];
    if (!readable(i, reference, REAL)) return 0;
    if (slot_code[reference] >> 2 == access) return 1;
    say(i, fmi2Error, "%s is no %s", name_of(reference, name), what);
    return 0;
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                       const fmi2Integer order[], const fmi2Real value[]) {
    instance *i = c;
    char name[NAME_LENGTH];
    const char *call = "fmi2SetRealInputDerivatives";
    if (!allowed(i, WRITE_PHASES, call)) return fmi2Error;
    if (!given(i, n, vr, value, call) || !given(i, n, order, order, call)) return fmi2Error;
    for (size_t k = 0; k < n; k++) {
        if (!is_real(i, vr[k], INPUT, "input")) return fmi2Error;
        if (order[k] != 1) return say(i, fmi2Error, "%s: order %d, expected 1", name_of(vr[k], name), order[k]);
        if (!isfinite(value[k])) return refuse_infinite(i, vr[k], "was given a rate, but");
        if (rate_slot(vr[k]) < 0) return say(i, fmi2Error, "%s is held over a step", name_of(vr[k], name));
    }
    for (size_t k = 0; k < n; k++) i->block[rate_slot(vr[k])].real = value[k];
    i->at.derived = 0;
    return fmi2OK;
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                        const fmi2Integer order[], fmi2Real value[]) {
    instance *i = c;
    char name[NAME_LENGTH];
    const char *call = "fmi2GetRealOutputDerivatives";
    fmi2Status status = differentiate(i, STEPPING | FAILED | TERMINATED, call);
    if (status != fmi2OK) return status;
    if (!given(i, n, vr, value, call) || !given(i, n, order, order, call)) return fmi2Error;
    for (size_t k = 0; k < n; k++) {
        if (!is_real(i, vr[k], OUTPUT, "output")) return fmi2Error;
        if (order[k] != 1) return say(i, fmi2Error, "%s: order %d, expected 1", name_of(vr[k], name), order[k]);
        int rate = rate_slot(vr[k]);
        if (rate < 0) return say(i, fmi2Discard, "%s has no derivative that is known", name_of(vr[k], name));
        if (!isfinite(i->block[rate].real)) return refuse_infinite(i, vr[k], "has as its derivative");
        value[k] = i->block[rate].real;
    }
    return fmi2OK;
}

/* Derivative of an output by an input; what is not in the table does not depend on it directly. */
static double partial_of(const instance *i, fmi2ValueReference output, fmi2ValueReference input) {
    int low = 0, high = DCONE_PARTIALS;
    while (low < high) {
        int middle = (low + high) / 2;
        const struct partial *p = &partial_table[middle];
        fmi2ValueReference at = (fmi2ValueReference)p->output;
        if (at < output || (at == output && (fmi2ValueReference)p->input < input)) low = middle + 1;
        else high = middle;
    }
    const struct partial *p = &partial_table[low];
    if (low == DCONE_PARTIALS || (fmi2ValueReference)p->output != output) return 0.0;
    if ((fmi2ValueReference)p->input != input) return 0.0;
    return i->block[p->slot].real;
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t n_unknown,
                                        const fmi2ValueReference known[], size_t n_known, const fmi2Real change[],
                                        fmi2Real result[]) {
    instance *i = c;
    const char *call = "fmi2GetDirectionalDerivative";
    if (DCONE_PARTIALS == 0 && i) return say(i, fmi2Error, "no output of this FMU depends directly on an input");
    fmi2Status status = differentiate(i, INITIALISING | STEPPING | FAILED | TERMINATED, call);
    if (status != fmi2OK) return status;
    if (!given(i, n_unknown, unknown, result, call) || !given(i, n_known, known, change, call)) return fmi2Error;
    for (size_t k = 0; k < n_known; k++) {
        if (!is_real(i, known[k], INPUT, "input, by which outputs are derived")) return fmi2Error;
        if (!isfinite(change[k])) return refuse_infinite(i, known[k], "is to change by");
    }
    for (size_t u = 0; u < n_unknown; u++) {
        if (!is_real(i, unknown[u], OUTPUT, "output, which can be derived")) return fmi2Error;
        double sum = 0.0;
        for (size_t k = 0; k < n_known; k++) sum += partial_of(i, unknown[u], known[k]) * change[k];
        if (!isfinite(sum)) return refuse_infinite(i, unknown[u], "has as its derivative");
        result[u] = sum;
    }
    return fmi2OK;
}
