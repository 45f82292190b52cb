/* Where an unpacked FMU keeps its resources: see resources.h. */

#ifndef _WIN32
#define _GNU_SOURCE /* for dladdr */
#include <dlfcn.h>
#include <sys/mman.h>
#include <sys/stat.h>
#else
#define WIN32_LEAN_AND_MEAN
#include <windows.h>
#include <io.h>
#endif

#include <errno.h>
#include <stdint.h>
#include <string.h>

#include "resources.h"

/* ---- what differs between systems ---------------------------------------------------------------------------------- */

static const char within = 0; /* an address in this library */

#ifdef _WIN32
static const char separators[] = "/\\";

FILE *dcone_open(const char *path) {
    wchar_t wide[PATH_LENGTH];
    return MultiByteToWideChar(CP_UTF8, 0, path, -1, wide, PATH_LENGTH) ? _wfopen(wide, L"rb") : NULL;
}

static int own_path(char path[PATH_LENGTH]) {
    HMODULE library;
    wchar_t wide[PATH_LENGTH];
    DWORD how = GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS | GET_MODULE_HANDLE_EX_FLAG_UNCHANGED_REFCOUNT;
    if (!GetModuleHandleExW(how, (LPCWSTR)&within, &library)) return 0;
    DWORD length = GetModuleFileNameW(library, wide, PATH_LENGTH);
    if (length == 0 || length == PATH_LENGTH) return 0;
    return WideCharToMultiByte(CP_UTF8, 0, wide, -1, path, PATH_LENGTH, NULL, NULL) > 0;
}

static const void *map(FILE *file, size_t *size) {
    HANDLE handle = (HANDLE)_get_osfhandle(_fileno(file));
    LARGE_INTEGER length;
    int known = GetFileSizeEx(handle, &length);
    HANDLE mapping = known ? CreateFileMappingW(handle, NULL, PAGE_READONLY, 0, 0, NULL) : NULL;
    const void *memory = mapping ? MapViewOfFile(mapping, FILE_MAP_READ, 0, 0, 0) : NULL;
    if (mapping) CloseHandle(mapping);
    if (!memory) errno = EIO;
    else *size = (size_t)length.QuadPart;
    return memory;
}

static void unmap(const void *memory, size_t size) { (void)size, UnmapViewOfFile(memory); }
#else
static const char separators[] = "/";

FILE *dcone_open(const char *path) { return fopen(path, "rb"); }

static int own_path(char path[PATH_LENGTH]) {
    Dl_info about;
    if (!dladdr(&within, &about) || !about.dli_fname || strlen(about.dli_fname) >= PATH_LENGTH) return 0;
    strcpy(path, about.dli_fname);
    return 1;
}

static const void *map(FILE *file, size_t *size) {
    struct stat about;
    if (fstat(fileno(file), &about)) return NULL;
    *size = (size_t)about.st_size;
    void *memory = mmap(NULL, *size, PROT_READ, MAP_PRIVATE, fileno(file), 0);
    return memory == MAP_FAILED ? NULL : memory;
}

static void unmap(const void *memory, size_t size) { munmap((void *)(uintptr_t)memory, size); }
#endif

const void *dcone_map(const char *path, size_t *size) {
    FILE *file = dcone_open(path);
    if (!file) return NULL;
    const void *memory = map(file, size);
    int reason = errno;
    fclose(file);
    errno = reason;
    return memory;
}

void dcone_unmap(const void *memory, size_t size) {
    if (memory) unmap(memory, size);
}

/* ---- URIs ---------------------------------------------------------------------------------------------------------- */

static char lower(char c) { return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c; }

/* Whether a text begins with a word, which is in lower case. */
static int begins(const char *text, const char *word) {
    while (*word && lower(*text) == *word) text++, word++;
    return !*word;
}

static int digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    return lower(c) >= 'a' && lower(c) <= 'f' ? lower(c) - 'a' + 10 : -1;
}

/* Put what %XX stands for in its place; a % that begins no such thing is left. */
static void decode(char *text) {
    char *to = text;
    for (const char *from = text; *from; to++) {
        int high = *from == '%' ? digit(from[1]) : -1, low = high >= 0 ? digit(from[2]) : -1;
        *to = low >= 0 && high + low > 0 ? (char)(16 * high + low) : *from;
        from += low >= 0 && high + low > 0 ? 3 : 1;
    }
    *to = 0;
}

/* Whether a text begins with the letter of a drive, as in C:/ or C|/. */
static int on_drive(const char *text) {
    return lower(text[0]) >= 'a' && lower(text[0]) <= 'z' && (text[1] == ':' || text[1] == '|') &&
           (text[2] == '/' || text[2] == '\\' || !text[2]);
}

/* What follows "file:" as a path, in its place; NULL for a file on another machine. */
static char *path_of(char *text) {
    if (text[0] == '/' && text[1] == '/') {
        char *host = text + 2, *end = host + strcspn(host, separators);
        if (on_drive(host)) text = host;
        else if (end == host || (begins(host, "localhost") && end == host + strlen("localhost"))) text = end;
        else if (!strchr(separators, '\\')) return NULL; /* elsewhere than on Windows nothing is opened by its host */
    }
    decode(text);
    if (strchr(separators, '\\') && text[0] == '/' && on_drive(text + 1)) text++;
    if (strchr(separators, '\\') && on_drive(text)) text[1] = ':';
    return text;
}

/* Folder of the resources beside this library, which lies two folders deep in the unpacked FMU. */
static int beside_library(char path[PATH_LENGTH]) {
    const char *up = "../../resources";
    if (!own_path(path)) return 0;
    size_t folder = strlen(path);
    while (folder > 0 && !strchr(separators, path[folder - 1])) folder--;
    if (folder + strlen(up) >= PATH_LENGTH) return 0;
    strcpy(path + folder, up);
    return 1;
}

int dcone_resource(const char *location, const char *name, char path[PATH_LENGTH]) {
    char text[PATH_LENGTH], *folder = text;
    const char *wrong = NULL;
    if (!location || !*location) {
        if (!beside_library(text)) wrong = "no location was given, and that of the library is not known";
    } else if (strlen(location) >= PATH_LENGTH) {
        wrong = "the location is too long";
    } else {
        strcpy(text, location);
        if (begins(text, "file:") && !(folder = path_of(text + strlen("file:")))) wrong = "they are on another machine";
    }
    if (!wrong) {
        size_t length = strlen(folder);
        const char *slash = length && strchr(separators, folder[length - 1]) ? "" : "/";
        if (length + strlen(slash) + strlen(name) >= PATH_LENGTH) wrong = "the location is too long";
        else snprintf(path, PATH_LENGTH, "%s%s%s", folder, slash, name);
    }
    if (wrong) snprintf(path, PATH_LENGTH, "%s", wrong);
    return !wrong;
}
