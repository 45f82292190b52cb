/* Part of fmi2.c: the tables of the model's parts, which travel in a file beside the start values.

   The file is mapped: the system reads it once, and all instances of one unpacked FMU see the same pages, in whatever
   thread or process. It may be removed while they live, but not written to, no more than the library itself.
   Little-endian, as every machine that is built for. What writes it: table_file.py; the block in it is that of
   tables.py. */

#define TABLES_FILE "tables.bin"
#define TABLES_MAGIC "DCONETAB"
#define TABLES_VERSION 1

enum { TABLES_AT_IDENTITY = 16, TABLES_AT_VERSION = 24, TABLES_AT_COUNT = 32, TABLES_AT_WORDS = 40, TABLES_HEAD = 64 };
enum { TABLE_ROW = 4, TABLE_LINE = 8 }; /* words of a table's row in the directory; tables begin at multiples of a line */

/* Where the kernels find the block; 0 where there is none. */
static intptr_t table_block(const instance *i) { return i->tables ? (intptr_t)(i->tables + TABLES_HEAD) : 0; }

static uint64_t whole_lines(uint64_t words) { return (words + TABLE_LINE - 1) / TABLE_LINE * TABLE_LINE; }

/* Whether the directory says of so many words what lies in them, so that no kernel reads beyond. */
static int directory_fits(const unsigned char *block, uint64_t words) {
    uint64_t next = whole_lines(TABLE_ROW * DCONE_TABLES);
    for (int table = 0; table < DCONE_TABLES && next <= words; table++) {
        const unsigned char *row = block + 8 * TABLE_ROW * table;
        uint64_t count = 1;
        if (word_at(row) != next) return 0;
        for (int k = 1; k < TABLE_ROW; k++) {
            uint64_t extent = word_at(row + 8 * k);
            if (extent == 0 || extent > words / count) return 0;
            count *= extent;
        }
        next += whole_lines(count);
    }
    return next == words;
}

/* Whether the file in memory holds the tables that the start values name, whole; said what it is, if not. */
static int genuine_tables(instance *i, const char *path) {
    const unsigned char *file = i->tables;
    size_t size = i->tables_size;
    if (size < TABLES_HEAD || memcmp(file, TABLES_MAGIC, AT_CHECK))
        say(i, fmi2Error, "%.700s holds no tables", path);
    else if (word_at(file + TABLES_AT_VERSION) != TABLES_VERSION)
        say(i, fmi2Error, "%.700s has version %lld, expected %d", path, (long long)word_at(file + TABLES_AT_VERSION),
            TABLES_VERSION);
    else if (size % 8 || word_at(file + TABLES_AT_WORDS) != (size - TABLES_HEAD) / 8)
        say(i, fmi2Error, "%.700s is cut short or too long: it has %.0f bytes", path, (double)size);
    else if (word_at(file + AT_CHECK) != check_word(file + TABLES_AT_IDENTITY, size - TABLES_AT_IDENTITY))
        say(i, fmi2Error, "%.700s is damaged: its check word does not fit", path);
    else if (word_at(file + TABLES_AT_COUNT) != DCONE_TABLES || !directory_fits(file + TABLES_HEAD, size / 8 - 8))
        say(i, fmi2Error, "%.700s does not hold %d tables, as this library needs them", path, DCONE_TABLES);
    else if (word_at(file + TABLES_AT_IDENTITY) != i->start[TABLES].bits)
        say(i, fmi2Error, "%.700s holds other tables than those of this FMU", path);
    else
        return 1;
    return 0;
}

/* Take the tables from the resources, once the start values are there; 0, and said why, if they are not to be had. */
static int take_tables(instance *i, fmi2String location) {
    char path[PATH_LENGTH];
    if (DCONE_TABLES == 0) return 1;
    if (!dcone_resource(location, TABLES_FILE, path)) {
        say(i, fmi2Error, "the resources %.700s are not found: %s", location ? location : "", path);
        return 0;
    }
    i->tables = dcone_map(path, &i->tables_size);
    if (!i->tables) say(i, fmi2Error, "the tables can not be read from %.700s: %s", path, strerror(errno));
    return i->tables && genuine_tables(i, path);
}
