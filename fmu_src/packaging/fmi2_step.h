/* Part of fmi2.c: stepping, and what is said of a step afterwards. */

enum { ASKED_PHASES = STEPPING | FAILED | TERMINATED };

enum { TELL_EVERY = 5 };   /* seconds of a clock on the wall between two words of a long step */

/* What a time may be off by rounding where a master adds up steps: some last digits of it, and a share of the step. */
static double slack(double time, double share, double step) { return 16.0 * DBL_EPSILON * fabs(time) + share * step; }

/* Whether a master that stands at `time` means where the FMU stands. A gap is closed by the step, so that it is to be
   seen only where it is more than rounding. */
static int meets(const instance *i, double time, double step) {
    return fabs(time - i->at.time) <= slack(fmax(fabs(time), fabs(i->at.time)), 1e-6, step);
}

/* Whether a step ends before the stop, where millions of steps added up may be off by more than one is. */
static int within_stop(const instance *i, double time, double step) {
    return !i->at.has_stop || time + step <= i->at.stop + slack(i->at.stop, 1e-2, step);
}

/* Have the model make a step, which it leaves now and then; say where it is when that takes long. */
static int32_t make_step(instance *i, double span) {
    time_t told = time(NULL);
    int32_t answer = run(i, STEP, i->at.time, span);
    while (answer == UNDER_WAY) {
        if (difftime(time(NULL), told) >= TELL_EVERY) {
            told = time(NULL);
            say(i, fmi2OK, "at %.9g s, in the step to %.9g s", i->block[FAULT_TIME].real, i->at.time + span);
        }
        answer = run(i, GO_ON, i->at.time, span);
    }
    return answer;
}

/* An error if an input that moves would end out of its bounds. */
static fmi2Status check_ends(instance *i, double span) {
    for (int k = 0; k < DCONE_MOVING; k++) {
        fmi2ValueReference input = (fmi2ValueReference)moving_table[k].slot;
        double end = i->block[input].real + i->block[moving_table[k].rate].real * span;
        if (!fits(row_of(input), end)) return refuse_value(i, input, end);
    }
    return fmi2OK;
}

/* A rate of an input lasts one step; from here on the inputs are held. */
static void hold_inputs(instance *i) {
    for (int k = 0; k < DCONE_MOVING; k++) i->block[moving_table[k].rate].real = 0.0;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_return) {
    instance *i = c;
    (void)no_return;
    if (!allowed(i, STEPPING, "fmi2DoStep")) return fmi2Error;
    if (!isfinite(time) || !(step >= 0.0) || !isfinite(step))
        return say(i, fmi2Error, "a step from %.17g s of %.17g s can not be made", time, step);
    if (!meets(i, time, step))
        return say(i, fmi2Error, "the step begins at %.17g s, but the FMU stands at %.17g s", time, i->at.time);
    if (!within_stop(i, time, step))
        return say(i, fmi2Error, "the step to %.17g s goes beyond the stop time, %.17g s", time + step, i->at.stop);
    if (step == 0.0) return fmi2OK;
    /* a master that adds up times drifts by rounding: the gap is closed, so that the model sees none */
    double span = (time - i->at.time) + step;
    if (span <= 0.0) { /* a step of last digits only: the FMU is there already, and waits for the master */
        hold_inputs(i);
        i->at.derived = 0;
        return fmi2OK;
    }
    if (check_ends(i, span) != fmi2OK) return fmi2Error;
    i->block[FAULT_CODE].integer = 0;
    i->at.derived = 0;
    if (make_step(i, span)) return tell_fault(i, STEP);
    hold_inputs(i); /* where the model has left them: where they have come to */
    i->at.moved = 0;
    i->at.time = time + step;
    return fmi2OK;
}

fmi2Status fmi2CancelStep(fmi2Component c) {
    return say(c, fmi2Error, "fmi2CancelStep is not allowed: no step is ever pending");
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value) {
    instance *i = c;
    if (!allowed(i, ASKED_PHASES, "fmi2GetRealStatus") || !given(i, 1, value, value, "fmi2GetRealStatus"))
        return fmi2Error;
    if (kind != fmi2LastSuccessfulTime) return say(i, fmi2Discard, "the one Real status is fmi2LastSuccessfulTime");
    *value = i->at.time;
    return fmi2OK;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value) {
    instance *i = c;
    if (!allowed(i, ASKED_PHASES, "fmi2GetBooleanStatus") || !given(i, 1, value, value, "fmi2GetBooleanStatus"))
        return fmi2Error;
    if (kind != fmi2Terminated) return say(i, fmi2Discard, "the one Boolean status is fmi2Terminated");
    *value = i->at.ended ? fmi2True : fmi2False;
    return fmi2OK;
}

/* The other kinds tell of steps that are done later, which none here are. */
static fmi2Status none_pending(instance *i, const char *call) {
    return allowed(i, ASKED_PHASES, call) ? say(i, fmi2Discard, "%s: no step is ever pending", call) : fmi2Error;
}

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value) {
    (void)kind, (void)value;
    return none_pending(c, "fmi2GetStatus");
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value) {
    (void)kind, (void)value;
    return none_pending(c, "fmi2GetIntegerStatus");
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value) {
    (void)kind, (void)value;
    return none_pending(c, "fmi2GetStringStatus");
}
