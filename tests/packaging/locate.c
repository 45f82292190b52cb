/* Says where each location, a line of the input in UTF-8, leads: the path of the file "it" there, and what that holds. */

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
        printf("%d %s %s\n", found, word, path);
    }
    return 0;
}
