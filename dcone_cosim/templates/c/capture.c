/* An example to be replaced: the net flies straight from the chaser to a target at rest, and is captured on arrival. */

const size_t model_states = 0;

static const double catch_mass = 6.0, speed = 3.0, distance = 16.0; /* [kg], [m/s], [m] */
static const double size[3] = {4.0, 8.0, 4.0}, reach = 4.89897949; /* edges of the target, half its diagonal [m] */

fmi2Status model_start(model *m) {
    int k;
    for (k = 0; k < 3; k++) {
        double a = size[(k + 1) % 3], b = size[(k + 2) % 3];
        m->values[TARGET_INERTIA_1 + k] = m->values[TARGET_MASS] * (a * a + b * b) / 12.0;
        m->values[CATCH_INERTIA_1 + k] = 1.0;
        m->values[CHASER_VELOCITY_1 + k] = m->values[CHASER_START_VELOCITY_1 + k];
    }
    m->values[TARGET_REACH] = reach;
    m->values[TARGET_ATTITUDE_1] = 1.0;
    m->values[CHASER_VELOCITY_2] -= catch_mass * speed / m->values[CHASER_MASS];
    m->values[CATCH_MASS] = catch_mass;
    m->values[CATCH_VELOCITY_2] = speed;
    m->values[ENERGY_KINETIC] = 0.5 * catch_mass * speed * speed;
    m->values[T_CAPTURE] = -1.0;
    return fmi2OK;
}

fmi2Status model_step(model *m, double step) {
    double arrival = distance / speed;
    if (m->values[T_CAPTURE] < 0.0 && m->time + step >= arrival) m->values[T_CAPTURE] = arrival;
    return fmi2OK;
}

fmi2Status model_outputs(model *m) {
    int captured = m->values[T_CAPTURE] >= 0.0, k;
    for (k = 0; k < 3; k++) m->values[CHASER_POSITION_1 + k] = m->time * m->values[CHASER_VELOCITY_1 + k];
    m->values[CHASER_POSITION_2] -= distance;
    m->values[CATCH_POSITION_2] = captured ? 0.0 : speed * m->time - distance;
    m->values[VERTEX_POSITION_2] = m->values[CATCH_POSITION_2];
    m->values[TETHER_PAID_OUT] = m->values[CATCH_POSITION_2] - m->values[CHASER_POSITION_2];
    m->values[CAPTURED] = m->values[SETTLED] = m->values[OUTCOME] = captured;
    return fmi2OK;
}
