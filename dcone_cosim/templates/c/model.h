/* What model.c tells fmu.c, and the other way round. */

#ifndef MODEL_H
#define MODEL_H

#include <stddef.h>

#include "fmi2Functions.h"

enum kind { REAL, INTEGER, BOOLEAN };
enum causality { PARAMETER, INPUT, OUTPUT };

/* One row of the table of variables. Its place in the table is its value reference. */
struct variable {
    const char *name;
    enum kind kind;
    enum causality causality;
    double start;
};

/* One instance. The numbers of all kinds are doubles; the FMU's state is `values`, `states` and the times. */
typedef struct model {
    double *values; /* one per row of the table */
    double *states; /* model_states of them, yours to use */
    double start;   /* the importer's time at the begin [s] */
    double time;    /* reached, since the begin [s]: every instant the model takes or tells counts from there */
    int ended;      /* the model is over for good: set it, set time to when, and return fmi2Discard */
    const fmi2CallbackFunctions *callbacks;
} model;

extern const struct variable model_table[];
extern const size_t model_variables;
extern const size_t model_states;
extern const char *const model_guid;

/* Begin, at m->time = 0, with the parameters as set. */
fmi2Status model_start(model *m);

/* Advance from m->time by `step` [s]; fmu.c moves the time on afterwards. */
fmi2Status model_step(model *m, double step);

/* Bring the outputs up to m->time. */
fmi2Status model_outputs(model *m);

/* Tell the importer something; returns the status, for `return model_say(m, fmi2Error, "...")`. */
fmi2Status model_say(model *m, fmi2Status status, const char *text);

#endif
