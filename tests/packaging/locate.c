/* Says where each location on the command line leads: the path of the file "it" there, and what that begins with.

       locate LOCATION ... */

#include "resources.h"

int main(int count, char **given) {
    for (int k = 1; k < count; k++) {
        char path[PATH_LENGTH], word[16] = "";
        int found = dcone_resource(given[k], "it", path);
        FILE *file = found ? dcone_open(path) : NULL;
        if (file && fscanf(file, "%15s", word) != 1) word[0] = 0;
        if (file) fclose(file);
        printf("%d %s %s\n", found, file ? word : "-", path);
    }
    return 0;
}
