/* Part of fmi2.c: the FMU state. It holds no pointer, so it is good in any process that has loaded an
   FMU with this library and these tables, whatever start values that one has. */

#define MAGIC "DCONEFMU"
#define STATE_VERSION 3

/* What a saved state begins with, in memory and serialised; the block follows. */
typedef struct {
    uint64_t nothing;    /* zero: some tools free a state where its address is asked for, and so free NULL */
    char magic[8];
    uint64_t check;      /* of all that follows it, in a serialised state */
    char library[KEY_LENGTH];
    int64_t version;
    condition at;
} saved;

typedef char state_head_as_told[sizeof(saved) == DCONE_STATE_HEAD ? 1 : -1];

static size_t state_size(int64_t work) { return sizeof(saved) + block_size(work); }

static uint64_t check_of(const void *state, int64_t work) {
    const size_t at = offsetof(saved, library);
    return check_word((const char *)state + at, state_size(work) - at);
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) {
    instance *i = c;
    if (!allowed(i, ANYWHERE, "fmi2GetFMUstate") || !given(i, 1, state, state, "fmi2GetFMUstate")) return fmi2Error;
    saved *s = *state;
    if (s && s->at.work != i->at.work) {
        free(s);
        s = NULL;
    }
    if (!s) s = malloc(state_size(i->at.work));
    *state = s;
    if (!s) return say(i, fmi2Error, "no memory for the FMU state");
    memset(s, 0, sizeof *s);
    memcpy(s->magic, MAGIC, sizeof s->magic);
    strncpy(s->library, DCONE_LIBRARY, sizeof s->library - 1);
    s->version = STATE_VERSION;
    s->at = i->at;
    memcpy(s + 1, i->block, block_size(i->at.work));
    return fmi2OK;
}

/* Whether a state is one of this library; `size` counts its bytes, SIZE_MAX where they are not known. */
static fmi2Status usable(instance *i, const saved *s, size_t size) {
    int64_t phase = s->at.phase, work = s->at.work;
    if (size < sizeof *s || s->nothing || memcmp(s->magic, MAGIC, sizeof s->magic))
        return say(i, fmi2Error, "this is no saved state of such an FMU");
    if (s->version != STATE_VERSION)
        return say(i, fmi2Error, "the saved state has version %lld, expected %d", (long long)s->version, STATE_VERSION);
    if (strncmp(s->library, DCONE_LIBRARY, sizeof s->library))
        return say(i, fmi2Error, "the saved state belongs to another library than this one, %s", DCONE_LIBRARY);
    if (work < 0 || work > INT64_C(1) << 40 || (size != SIZE_MAX && size != state_size(work)))
        return say(i, fmi2Error, "the saved state is damaged: its size does not fit its %lld numbers of memory",
                   (long long)work);
    if (phase <= 0 || phase > BROKEN || (phase & (phase - 1)))
        return say(i, fmi2Error, "the saved state is damaged: there is no phase %lld", (long long)phase);
    if (!isfinite(s->at.time) || !isfinite(s->at.stop))
        return say(i, fmi2Error, "the saved state is damaged: its time is not finite");
    return fmi2OK;
}

/* Whether the record in a state fits what it is put into: the work memory beside it, and the tables of this FMU. */
static fmi2Status consistent(instance *i, const saved *s) {
    slot work, tables;
    const char *record = (const char *)(s + 1);
    memcpy(&work, record + WORK_SIZE * sizeof work, sizeof work);
    memcpy(&tables, record + TABLES * sizeof tables, sizeof tables);
    if (work.integer != s->at.work)
        return say(i, fmi2Error, "the saved state is damaged: %lld numbers of memory, but its record needs %lld",
                   (long long)s->at.work, (long long)work.integer);
    if (tables.bits != i->start[TABLES].bits)
        return say(i, fmi2Error, "the saved state belongs to other tables than those of this FMU");
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
    instance *i = c;
    const saved *s = state;
    if (!allowed(i, ANYWHERE, "fmi2SetFMUstate") || !given(i, 1, state, state, "fmi2SetFMUstate")) return fmi2Error;
    if (usable(i, s, SIZE_MAX) != fmi2OK || consistent(i, s) != fmi2OK) return fmi2Error;
    if (!resize(i, s->at.work)) return say(i, fmi2Error, "no memory for the FMU state");
    i->at = s->at;
    memcpy(i->block, s + 1, block_size(s->at.work));
    return say(i, fmi2OK, "back in the state of %.9g s", i->at.time);
}

/* A state is memory of its own: it is given back even when the instance is gone. */
fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
    if (state) {
        free(*state);
        *state = NULL;
    }
    return c ? fmi2OK : fmi2Error;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size) {
    if (!c || !given(c, 1, state, size, "fmi2SerializedFMUstateSize")) return fmi2Error;
    if (usable(c, state, SIZE_MAX) != fmi2OK) return fmi2Error;
    *size = state_size(((saved *)state)->at.work);
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
    if (!c || !given(c, 1, state, bytes, "fmi2SerializeFMUstate")) return fmi2Error;
    if (usable(c, state, SIZE_MAX) != fmi2OK) return fmi2Error;
    size_t needed = state_size(((saved *)state)->at.work);
    if (size < needed)
        return say(c, fmi2Error, "the buffer of %.0f bytes is too small for the FMU state, %.0f bytes", (double)size,
                   (double)needed);
    uint64_t check = check_of(state, ((saved *)state)->at.work);
    memcpy(bytes, state, needed);
    memcpy(bytes + offsetof(saved, check), &check, sizeof check);
    return fmi2OK;
}

/* What `state` points to is written only: it may never have held anything. */
fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state) {
    saved head;
    if (!c || !given(c, 1, bytes, state, "fmi2DeSerializeFMUstate")) return fmi2Error;
    if (size < sizeof head) return say(c, fmi2Error, "this is no saved state of such an FMU: it is too short");
    memcpy(&head, bytes, sizeof head);
    if (usable(c, &head, size) != fmi2OK) return fmi2Error;
    if (check_of(bytes, head.at.work) != head.check)
        return say(c, fmi2Error, "the saved state is damaged: its check word does not fit");
    saved *copy = malloc(size);
    if (!copy) return say(c, fmi2Error, "no memory for the FMU state");
    memcpy(copy, bytes, size);
    if (consistent(c, copy) != fmi2OK) {
        free(copy);
        return fmi2Error;
    }
    *state = copy;
    return fmi2OK;
}
