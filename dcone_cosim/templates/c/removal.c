/* An example to be replaced: it holds what it is given, and the two bodies drift along straight lines. */

const size_t model_states = 0;

fmi2Status model_start(model *m) {
    (void)m;
    return fmi2OK;
}

fmi2Status model_step(model *m, double step) {
    (void)m;
    (void)step;
    return fmi2OK;
}

fmi2Status model_outputs(model *m) {
    double sum = 0.0;
    int k;
    for (k = 0; k < 3; k++) {
        double rate = m->values[START_RELATIVE_VELOCITY_1 + k];
        double place = m->values[START_RELATIVE_POSITION_1 + k] + m->time * rate;
        m->values[RELATIVE_POSITION_1 + k] = place;
        m->values[RELATIVE_VELOCITY_1 + k] = rate;
        sum += place * place;
    }
    m->values[SEPARATION] = sqrt(sum);
    return fmi2OK;
}
