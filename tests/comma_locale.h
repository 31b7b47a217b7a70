/* A locale whose decimal point is a comma, as a host program may have set. */
#ifndef NOC_TEST_COMMA_LOCALE_H
#define NOC_TEST_COMMA_LOCALE_H

#include "test.h"

#include <locale.h>
#include <stdbool.h>

/* Sets it for the whole process: one that is installed, else one made in `folder` by localedef. false where there is
 * neither. */
static inline bool set_comma_locale(const char *folder) {
    static const char *const installed[] = { "de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "cs_CZ.UTF-8" };
    for (size_t i = 0; i < sizeof(installed) / sizeof(*installed); i++)
        if (setlocale(LC_ALL, installed[i]))
            return *localeconv()->decimal_point == ',';
    char command[600];
    snprintf(command, sizeof(command), "localedef -i de_DE -f UTF-8 '%s/de_DE.UTF-8' >/dev/null 2>&1", folder);
    setenv("LOCPATH", folder, 1);
    return !system(command) && setlocale(LC_ALL, "de_DE.UTF-8") && *localeconv()->decimal_point == ',';
}

#define REQUIRE_COMMA_LOCALE(folder)                                                                                   \
    if (!set_comma_locale(folder)) {                                                                                   \
        print_message("# skipped: no locale with a decimal comma is here, and localedef makes none\n");                \
        skip();                                                                                                        \
    }

#endif
