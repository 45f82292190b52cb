/* Where an unpacked FMU keeps its resources. Knows no FMI, and alone here knows one system from another. */

#include <stdio.h>

enum { PATH_LENGTH = 4096 };

/* Path of a file among the resources; 0, and a reason in the place of the path, where there is none.

   location    as fmi2Instantiate is given it: a file URI in any of its spellings, or a plain path. Some tools give none:
               NULL or "" stands for the resources of the unpacked FMU that this library lies in */
int dcone_resource(const char *location, const char *name, char path[PATH_LENGTH]);

/* Open a file for reading; the path is UTF-8 on every system. */
FILE *dcone_open(const char *path);

/* A file as memory that can only be read, at the address of a page; NULL, and errno, where that can not be had. The
   system lets go of it when it is given back, or the process ends. */
const void *dcone_map(const char *path, size_t *size);

/* Give it back; NULL is none. */
void dcone_unmap(const void *memory, size_t size);
