/* Part of fmi2.c: the start values, which travel in a file beside the library, with the GUID of the whole.

   Little-endian on every machine. What writes it: start_values.py. */

#define START_FILE "start-values.bin"
#define START_MAGIC "DCONEVAL"
#define START_VERSION 1

enum { KEY_LENGTH = 48 }; /* of a GUID or a library's key, filled up with zeros */
enum { AT_CHECK = 8, AT_LIBRARY = 16, AT_GUID = 64, AT_VERSION = 112, AT_COUNT = 120, AT_VALUES = 128 };
enum { START_SIZE = AT_VALUES + 8 * DCONE_SLOTS };

static uint64_t word_at(const unsigned char *bytes) {
    uint64_t word = 0;
    for (int k = 7; k >= 0; k--) word = word << 8 | bytes[k];
    return word;
}

/* Check word of some words (the FNV-1a hash with words of eight bytes for bytes). */
static uint64_t check_word(const void *begin, size_t size) {
    uint64_t hash = UINT64_C(0xcbf29ce484222325);
    for (const unsigned char *at = begin, *end = at + size; at < end; at += 8) {
        hash = (hash ^ word_at(at)) * UINT64_C(0x100000001b3);
        hash ^= hash >> 32;
    }
    return hash;
}

/* Bytes of the file, as far as they are wanted; -1, and said why, if it can not be read. */
static long load(instance *i, const char *path, unsigned char bytes[START_SIZE + 1]) {
    FILE *file = dcone_open(path);
    size_t size = file ? fread(bytes, 1, START_SIZE + 1, file) : 0;
    int failed = !file || ferror(file);
    if (failed) say(i, fmi2Error, "the start values can not be read from %.700s: %s", path, strerror(errno));
    if (file) fclose(file);
    return failed ? -1 : (long)size;
}

/* Whether these bytes are start values for this library, whole, and of this GUID; said what they are, if not. */
static int genuine(instance *i, const char *path, const unsigned char *bytes, long size, const char *guid) {
    const char *library = (const char *)bytes + AT_LIBRARY, *own = (const char *)bytes + AT_GUID;
    if (size < AT_VALUES || memcmp(bytes, START_MAGIC, AT_CHECK))
        say(i, fmi2Error, "%.700s holds no start values", path);
    else if (word_at(bytes + AT_VERSION) != START_VERSION)
        say(i, fmi2Error, "%.700s has version %lld, expected %d", path, (long long)word_at(bytes + AT_VERSION),
            START_VERSION);
    else if (strncmp(library, DCONE_LIBRARY, KEY_LENGTH))
        say(i, fmi2Error, "%.700s belongs to another library than this one, %s", path, DCONE_LIBRARY);
    else if (size != START_SIZE || word_at(bytes + AT_COUNT) != DCONE_SLOTS)
        say(i, fmi2Error, "%.700s is cut short or too long: it must have %ld bytes", path, (long)START_SIZE);
    else if (word_at(bytes + AT_CHECK) != check_word(bytes + AT_LIBRARY, START_SIZE - AT_LIBRARY))
        say(i, fmi2Error, "%.700s is damaged: its check word does not fit", path);
    else if (!guid || strncmp(guid, own, KEY_LENGTH))
        say(i, fmi2Error, "the GUID %.200s is not that of this FMU, %.47s", guid ? guid : "(none)", own);
    else
        return 1;
    return 0;
}

/* Take the start values from the resources; 0, and said why, if they are not to be had. There are no others. */
static int read_start_values(instance *i, fmi2String location, fmi2String guid) {
    char path[PATH_LENGTH];
    if (!dcone_resource(location, START_FILE, path)) {
        say(i, fmi2Error, "the resources %.700s are not found: %s", location ? location : "", path);
        return 0;
    }
    unsigned char *bytes = malloc(START_SIZE + 1);
    i->start = malloc(DCONE_SLOTS * sizeof(slot));
    if (!bytes || !i->start) say(i, fmi2Error, "no memory for the start values");
    long size = bytes && i->start ? load(i, path, bytes) : -1;
    int good = size >= 0 && genuine(i, path, bytes, size, guid);
    for (int s = 0; good && s < DCONE_SLOTS; s++) i->start[s].bits = word_at(bytes + AT_VALUES + 8 * s);
    free(bytes);
    return good;
}
