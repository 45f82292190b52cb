/* Says where each location, a line of the input in UTF-8, leads: the path of the file "it" there, and what that holds,
   which must be the same whether it is read or mapped. */

#include <string.h>

#include "resources.h"

int main(void) {
    char location[PATH_LENGTH], path[PATH_LENGTH];
    while (fgets(location, sizeof location, stdin)) {
        char word[16] = "-";
        location[strcspn(location, "\r\n")] = 0;
        int found = dcone_resource(location, "it", path);
        FILE *file = found ? dcone_open(path) : NULL;
        if (file && fscanf(file, "%15s", word) != 1) strcpy(word, "empty");
        if (file) fclose(file);
        size_t size = 0;
        const void *mapped = found ? dcone_map(path, &size) : NULL;
        if (!mapped != !file || (mapped && (size != strlen(word) || memcmp(mapped, word, size)))) strcpy(word, "differs");
        dcone_unmap(mapped, size);
        printf("%d %s %s\n", found, word, path);
    }
    return 0;
}
