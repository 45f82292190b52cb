/* Part of fmi2.c: derivatives of inputs and outputs in time, and of outputs by inputs; at the start by parameters too. */

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

/* Whether a value reference is a Real of one of these causalities, a bit each. */
static int is_real(instance *i, fmi2ValueReference reference, int accesses, const char *what) {
    char name[NAME_LENGTH];
    if (!readable(i, reference, REAL)) return 0;
    if (accesses >> (slot_code[reference] >> 2) & 1) return 1;
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
        if (!is_real(i, vr[k], 1 << INPUT, "input")) return fmi2Error;
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
        if (!is_real(i, vr[k], 1 << OUTPUT, "output")) return fmi2Error;
        if (order[k] < 1) return say(i, fmi2Error, "%s: order %d, expected 1", name_of(vr[k], name), order[k]);
        int rate = rate_slot(vr[k]);
        if (rate < 0) return say(i, fmi2Discard, "%s has no derivative that is known", name_of(vr[k], name));
        if (!isfinite(i->block[rate].real)) return refuse_infinite(i, vr[k], "has as its derivative");
        value[k] = order[k] == 1 ? i->block[rate].real : 0.0; /* beyond what is known it is zero, says section 4.2.1 */
    }
    return fmi2OK;
}

/* The derivative of an output by an input it depends on directly, or NULL. */
static const double *partial_of(const instance *i, fmi2ValueReference output, fmi2ValueReference input) {
    int low = 0, high = DCONE_PARTIALS;
    while (low < high) {
        int middle = (low + high) / 2;
        const struct partial *p = &partial_table[middle];
        fmi2ValueReference at = (fmi2ValueReference)p->output;
        if (at < output || (at == output && (fmi2ValueReference)p->input < input)) low = middle + 1;
        else high = middle;
    }
    const struct partial *p = &partial_table[low];
    if (low == DCONE_PARTIALS || (fmi2ValueReference)p->output != output) return NULL;
    return (fmi2ValueReference)p->input == input ? &i->block[p->slot].real : NULL;
}

/* Where to look beside a value, in steps from it, and what counts how much for the derivative there: exact for
   polynomials of degree 4. On both sides, else above, else below: bounds, and starts that can not be, leave one. */
enum { POINTS = 5 };
static const struct { double at[POINTS], weight[POINTS]; } stencils[] = {
    {{-2, -1, 0, 1, 2}, {1.0 / 12, -2.0 / 3, 0, 2.0 / 3, -1.0 / 12}},
    {{0, 1, 2, 3, 4}, {-25.0 / 12, 4, -3, 4.0 / 3, -1.0 / 4}},
    {{0, -1, -2, -3, -4}, {25.0 / 12, -4, 3, -4.0 / 3, 1.0 / 4}},
};
static const double BESIDE = 1e-4; /* length of a step, of the value or of what is typical for it, if that is more */

/* Start a silent twin of an instance with another value of one variable, and add by weight how much its outputs differ;
   0 if none starts so. */
static int add_twin(const instance *i, fmi2ValueReference known, double value, double weight,
                    const fmi2ValueReference unknown[], size_t n, double sum[]) {
    instance twin = *i;
    twin.callbacks.logger = NULL;
    twin.block = malloc(block_size(i->at.work) + sizeof(slot));
    if (!twin.block) return 0;
    memcpy(twin.block, i->block, block_size(i->at.work));
    twin.block[known].real = value;
    twin.at.stale = 1;
    int started = settle(&twin) == fmi2OK;
    for (size_t u = 0; started && u < n; u++)
        sum[u] += weight * (twin.block[unknown[u]].real - i->block[unknown[u]].real);
    free(twin.block);
    return started;
}

/* Derivatives of outputs at the start by one parameter or input; 0 if no two starts can be compared. */
static int differ(const instance *i, fmi2ValueReference known, const fmi2ValueReference unknown[], size_t n,
                  double slope[]) {
    double here = i->block[known].real, step = BESIDE * fmax(fabs(here), row_of(known)->typical);
    for (size_t s = 0; s < sizeof stencils / sizeof *stencils; s++) {
        int good = 1;
        memset(slope, 0, n * sizeof *slope);
        for (int p = 0; p < POINTS && good; p++) {
            double weight = stencils[s].weight[p] / step;
            if (weight != 0.0) good = add_twin(i, known, here + stencils[s].at[p] * step, weight, unknown, n, slope);
        }
        if (good) return 1;
    }
    return 0;
}

/* In initialization mode: exact where the model tells the derivative, else from starts beside this one. */
static fmi2Status derive_start(instance *i, const fmi2ValueReference unknown[], size_t n_unknown,
                               const fmi2ValueReference known[], size_t n_known, const fmi2Real change[],
                               fmi2Real result[]) {
    char name[NAME_LENGTH];
    double *slope = malloc((n_unknown + 1) * sizeof *slope);
    if (!slope) return say(i, fmi2Error, "no memory for %lu derivatives", (unsigned long)n_unknown);
    fmi2Status status = fmi2OK;
    for (size_t k = 0; k < n_known && status == fmi2OK; k++) {
        if (!differ(i, known[k], unknown, n_unknown, slope))
            status = say(i, fmi2Discard, "no derivative by %s: the model can start on neither side of %.9g",
                         name_of(known[k], name), i->block[known[k]].real);
        for (size_t u = 0; u < n_unknown && status == fmi2OK; u++) {
            const double *told = partial_of(i, unknown[u], known[k]);
            result[u] += (told ? *told : slope[u]) * change[k];
        }
    }
    free(slope);
    return status;
}

/* While stepping: what is not in the table does not depend on an input directly. */
static void derive_now(const instance *i, const fmi2ValueReference unknown[], size_t n_unknown,
                       const fmi2ValueReference known[], size_t n_known, const fmi2Real change[], fmi2Real result[]) {
    for (size_t u = 0; u < n_unknown; u++)
        for (size_t k = 0; k < n_known; k++) {
            const double *told = partial_of(i, unknown[u], known[k]);
            if (told) result[u] += *told * change[k];
        }
}

/* Whether these can be derived, and by those. */
static int derivable(instance *i, const fmi2ValueReference unknown[], size_t n_unknown,
                     const fmi2ValueReference known[], size_t n_known, const fmi2Real change[]) {
    int starting = i->at.phase == INITIALISING;
    for (size_t k = 0; k < n_known; k++) {
        if (!is_real(i, known[k], 1 << INPUT | starting << PARAMETER, "input, by which outputs are derived")) return 0;
        if (isfinite(change[k])) continue;
        refuse_infinite(i, known[k], "is to change by");
        return 0;
    }
    for (size_t u = 0; u < n_unknown; u++)
        if (!is_real(i, unknown[u], 1 << OUTPUT, "output, which can be derived")) return 0;
    return 1;
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t n_unknown,
                                        const fmi2ValueReference known[], size_t n_known, const fmi2Real change[],
                                        fmi2Real result[]) {
    instance *i = c;
    const char *call = "fmi2GetDirectionalDerivative";
    if (!DCONE_DIFFERENTIABLE) return say(i, fmi2Error, "%s: this FMU provides no directional derivatives", call);
    fmi2Status status = differentiate(i, INITIALISING | STEPPING | FAILED | TERMINATED, call);
    if (status != fmi2OK) return status;
    if (!given(i, n_unknown, unknown, result, call) || !given(i, n_known, known, change, call)) return fmi2Error;
    if (!derivable(i, unknown, n_unknown, known, n_known, change)) return fmi2Error;
    for (size_t u = 0; u < n_unknown; u++) result[u] = 0.0;
    if (i->at.phase == INITIALISING)
        status = derive_start(i, unknown, n_unknown, known, n_known, change, result);
    else
        derive_now(i, unknown, n_unknown, known, n_known, change, result);
    for (size_t u = 0; u < n_unknown && status == fmi2OK; u++)
        if (!isfinite(result[u])) return refuse_infinite(i, unknown[u], "has as its derivative");
    return status;
}
