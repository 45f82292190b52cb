/* The FMI 2.0 co-simulation interface of every model here, free of any model.

   An instance is one block of 8-byte slots: first the record (parameters, inputs, state, outputs; a value reference is
   a slot), then the work memory, whose size the model tells once its parameters are known. Getting, setting and
   serialising the FMU state are copies of that block. The generated model.h tells slots, bounds, derivatives and
   faults; the start values come with the FMU, in its resources, and so do the tables that parts of the model read:
   these are never in the block.

   This file holds the instance and the way into the model; the parts at its end hold the functions of FMI, by idea.
   Nothing is global but constants, so instances may live side by side, in one thread or in several. */

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "fmi2Functions.h"
#include "resources.h"

/* One row of the model's table: the slots it takes, and what they may hold. A `#` in its name stands for an index. */
struct row { int first, count, columns, bounded, open; double low, high, typical; const char *name, *unit; };
struct fault { int code, severity, names; const char *text; };   /* names: its index is a value reference */
struct rate { int slot, rate; };               /* an input or output, and the slot of its time derivative */
struct partial { int output, input, slot; };   /* an output, an input it depends on, and the slot of the derivative */

#include "model.h"

enum { REAL = 1, INTEGER = 2, BOOLEAN = 3 };
enum { HIDDEN = 0, OUTPUT = 1, PARAMETER = 2, INPUT = 3 };
enum { SIZE = 0, INITIALISE = 1, STEP = 2, REFRESH = 3, DIFFERENTIATE = 4, GO_ON = 5 };
enum { UNDER_WAY = -2 };   /* the entry's answer when a step is not done yet */
enum { WORK_SIZE = 0, FAULT_CODE = 1, FAULT_INDEX = 2, FAULT_TIME = 3, FAULT_VALUE = 4 };
enum { TABLES = 5, TABLES_AT = 6 };
enum { SEVERITY_ERROR = 0, SEVERITY_DISCARD = 1, SEVERITY_END = 2 };

/* Where an instance is in the state machine of FMI 2.0; each call is allowed in a set of these. */
enum { INSTANTIATED = 1, INITIALISING = 2, STEPPING = 4, FAILED = 8, TERMINATED = 16, BROKEN = 32, ANYWHERE = 63 };

typedef union { double real; int64_t integer; uint64_t bits; } slot;

/* All of an instance's condition that is not in its block; saved with it. */
typedef struct {
    int64_t phase;
    int64_t stale;       /* parameters were set since the outputs were last worked out */
    int64_t moved;       /* inputs were, while stepping */
    int64_t derived;     /* the derivatives are those of now */
    int64_t ended;       /* the model came to its own end */
    int64_t has_stop;
    int64_t work;        /* slots of work memory */
    double time, stop;   /* last communication point; where the experiment ends */
} condition;

typedef struct {
    fmi2CallbackFunctions callbacks;
    char *name;
    unsigned logged;     /* categories that are told, one bit each */
    condition at;
    slot *memory;        /* what was allocated */
    slot *block;         /* in it: record, then work */
    slot *start;         /* record, as the FMU's resources have it */
    const unsigned char *tables; /* their file in memory, read only; NULL where the model has none */
    size_t tables_size;
} instance;

/* ---- the model's entry, one for each processor it was compiled for ------------------------------------------------ */

#define ARRAY void *, void *, int64_t, int64_t, slot *, int64_t, int64_t
typedef int32_t entry_function(int32_t *result, void **exception, int64_t command, ARRAY, ARRAY, double time,
                               double step);

#include "processor.h"

static intptr_t table_block(const instance *i);

static int32_t run(instance *i, int64_t command, double time, double step) {
    int32_t result = 0;
    void *exception = NULL;
    i->block[TABLES_AT].integer = table_block(i);
    int32_t status = entry(&result, &exception, command,
                           NULL, NULL, 1, DCONE_SLOTS * 8, i->block, 1, DCONE_SLOTS * 8,
                           NULL, NULL, i->at.work, 8, i->block + DCONE_SLOTS, i->at.work, 8, time, step);
    i->block[TABLES_AT].integer = 0; /* so that no address is in a saved state */
    return status ? -1 : result;
}

static size_t block_size(int64_t work) { return (size_t)(DCONE_SLOTS + work) * sizeof(slot); }

#include "fmi2_log.h"
#include "fmi2_messages.h"
#include "fmi2_start.h"
#include "fmi2_tables.h"
#include "fmi2_life.h"
#include "fmi2_values.h"
#include "fmi2_derivatives.h"
#include "fmi2_step.h"
#include "fmi2_state.h"
#include "fmi2_absent.h"
