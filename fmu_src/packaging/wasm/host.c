/* What an FMU's library has of a page that holds it, in the place of a system: its resources, which the page has in
   memory, and its messages, which the page hears. Stands for resources.c where the library is WebAssembly. */

#define _GNU_SOURCE /* for fmemopen */
#include <errno.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"
#include "resources.h"

#define OF_THE_PAGE(name) __attribute__((import_module("dcone"), import_name(name))) extern

/* Bytes of a file among the resources; -1 where there is none of that name. */
OF_THE_PAGE("size") int32_t page_size_of(const char *name);
/* Write them there. */
OF_THE_PAGE("read") void page_read(const char *name, void *bytes);
/* Hear a message. */
OF_THE_PAGE("say") void page_say(int32_t status, const char *text);

static void hear(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status, fmi2String category,
                 fmi2String format, ...) {
    char text[1024];
    va_list arguments;
    (void)environment, (void)instance, (void)category;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    page_say(status, text);
}

/* Callbacks for fmi2Instantiate, which a page cannot make: they hold an address of code. */
const fmi2CallbackFunctions *dcone_callbacks(void) {
    static const fmi2CallbackFunctions callbacks = {hear, calloc, free, NULL, NULL};
    return &callbacks;
}

int dcone_resource(const char *location, const char *name, char path[PATH_LENGTH]) {
    (void)location;
    snprintf(path, PATH_LENGTH, "%s", name);
    return 1;
}

/* The stream keeps a copy, which goes with it. */
FILE *dcone_open(const char *path) {
    size_t size = 0;
    void *bytes = (void *)(uintptr_t)dcone_map(path, &size);
    FILE *file = bytes ? fmemopen(NULL, size, "w+") : NULL;
    if (file) {
        fwrite(bytes, 1, size, file);
        rewind(file);
    }
    free(bytes);
    return file;
}

const void *dcone_map(const char *path, size_t *size) {
    int32_t length = page_size_of(path);
    void *bytes = length > 0 ? aligned_alloc(64, ((size_t)length + 63) / 64 * 64) : NULL;
    if (!bytes) {
        errno = length < 0 ? ENOENT : ENOMEM;
        return NULL;
    }
    page_read(path, bytes);
    *size = (size_t)length;
    return bytes;
}

void dcone_unmap(const void *memory, size_t size) {
    (void)size;
    free((void *)(uintptr_t)memory);
}
