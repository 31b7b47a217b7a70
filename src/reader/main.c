/* nocturne-reader: reads one file for libnocturne, which starts it. What comes in and goes out is the library's
 * business. */
#include <nocturne/import.h>
#include <stdio.h>

int main(void) {
    int status = noc_reader_main();
    if (status)
        fputs("nocturne-reader: libnocturne starts this program; by hand it does nothing\n", stderr);
    return status;
}
