/* Messages by category, of any FMU: an `instance` has the importer's `callbacks`, its `name` and the categories that
   are `logged`; `category_name` is theirs, as modelDescription.xml lists them, "logAll" being all. */

enum { ERRORS = 1, DISCARDS = 2, WARNINGS = 4, EVENTS = 8, ALL = 15 }; /* bits in the order of category_name */

/* Give a message to the importer, if its category is asked for; returns the status. */
static fmi2Status say(instance *i, fmi2Status status, const char *format, ...) {
    int category = status >= fmi2Error ? 0 : status == fmi2Discard ? 1 : status == fmi2Warning ? 2 : 3;
    if (!i || !i->callbacks.logger || !(i->logged >> category & 1)) return status;
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    i->callbacks.logger(i->callbacks.componentEnvironment, i->name, status, category_name[category], "%s", text);
    return status;
}

/* Whether an array of n elements was really given. */
static int given(instance *i, size_t n, const void *first, const void *second, const char *call) {
    if (n == 0 || (first && second)) return 1;
    say(i, fmi2Error, "%s: an array of %lu elements is NULL", call, (unsigned long)n);
    return 0;
}

/* Bit of a category, all bits for logAll, 0 for one that is not known. */
static unsigned category_bit(fmi2String name) {
    if (name && !strcmp(name, "logAll")) return ALL;
    for (int k = 0; name && k < 4; k++)
        if (!strcmp(name, category_name[k])) return 1u << k;
    return 0;
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[]) {
    instance *i = c;
    unsigned named = 0;
    if (!i || !given(i, n, categories, categories, "fmi2SetDebugLogging")) return fmi2Error;
    for (size_t k = 0; k < n; k++) {
        unsigned bit = category_bit(categories[k]);
        if (!bit)
            return say(i, fmi2Error, "there is no log category %s; there are %s, %s, %s, %s and logAll",
                       categories[k] ? categories[k] : "(NULL)", category_name[0], category_name[1], category_name[2],
                       category_name[3]);
        named |= bit;
    }
    i->logged = !on ? 0 : n ? named : ALL;
    return fmi2OK;
}
