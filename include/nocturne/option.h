/* nocturne/option.h: the tables of options that the command line, its help, its errors and the docs are made from.
 * An option names one field of a params struct. */
#ifndef NOCTURNE_OPTION_H
#define NOCTURNE_OPTION_H

#include <nocturne/image.h>
#include <nocturne/import.h>
#include <nocturne/render.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum noc_option_kind {
    NOC_OPTION_BOOL,   /* --name / --no-name; bool */
    NOC_OPTION_SWITCH, /* the same, and "auto": what is done where neither was said; noc_switch */
    NOC_OPTION_INT,    /* int */
    NOC_OPTION_UINT,   /* uint32_t */
    NOC_OPTION_REAL,   /* double */
    NOC_OPTION_CHOICE, /* an enum (int), one of choices, in order from 0 */
    NOC_OPTION_TEXT,   /* const char *; points at the caller's text */
    NOC_OPTION_TEXTS,  /* noc_texts; may be given several times; points at the caller's texts */
} noc_option_kind;

/* What a view forgets when an option changes: bits. Where the option is idle before and after (noc_option_idle),
 * nothing. What a view has learned of the lights' visibility is forgotten with NOC_RESETS_ALL alone: it is of places in
 * the scene, whatever the camera, size and other options. */
typedef enum noc_resets {
    NOC_RESETS_NOTHING = 0,
    NOC_RESETS_MEAN = 1,       /* accumulation: the picture is another one, or is to be judged anew */
    NOC_RESETS_RESERVOIRS = 2, /* samples of the frame before do not mean the same any more */
    NOC_RESETS_ALL = 7         /* as noc_view_reset does: with the frame number, and what was learned of visibility */
} noc_resets;

typedef struct noc_option {
    const char *name;  /* long name without dashes; NULL ends a table */
    const char *group; /* heading in the help */
    noc_option_kind kind;
    size_t offset;       /* of the field in its struct */
    double min, max;     /* INT, UINT, REAL; inclusive */
    const char *choices; /* CHOICE: "a|b|c" */
    const char *unit;    /* "m", "px", "cd/m2", "" */
    const char *help;    /* one line */
    /* "option=a|b,option=c": where others of its table say otherwise it changes no picture; may be NULL */
    const char *needs;
    unsigned resets; /* noc_resets; of fields of noc_render_params */
    /* CHOICE: "old=a|older=b": other names of choices, which are taken and never told; may be NULL */
    const char *aliases;
    /* REAL: other ways to write the number, such as "sqm:18.8". Fills *number and returns NULL, or returns what is
     * wrong with the text; NULL: numbers alone */
    const char *(*read)(const char *text, double *number);
} noc_option;

NOC_API const noc_option *noc_render_options(void);    /* fields of noc_render_params */
NOC_API const noc_option *noc_display_options(void);   /* fields of noc_display_params */
NOC_API const noc_option *noc_import_options(void);    /* fields of noc_import_params */
NOC_API const noc_option *noc_luminaire_options(void); /* fields of noc_luminaire_rule, which recipes say */
NOC_API const noc_option *noc_group_options(void);     /* fields of noc_group_rule, which recipes say */
NOC_API const noc_option *noc_city_options(void);      /* fields of noc_city_params */
NOC_API const noc_option *noc_builtin_options(void);   /* fields of noc_builtin_params, but for the city's */
NOC_API const noc_option *noc_camera_options(void);    /* fields of noc_camera_params */
NOC_API const noc_option *noc_device_options(void);    /* fields of noc_device_params */

/* Row of an option "preset", for tables of one's own: field preset, an int that is a noc_preset, of struct S. */
#define NOC_OPTION_PRESET(S, group)                                                                                    \
    {                                                                                                                  \
        "preset", group, NOC_OPTION_CHOICE, offsetof(S, preset), 0, 0, "still|interactive|quick", "",                  \
            "still: lists of 64 + 128 lights; interactive: 32 + 64, a tenth quicker; quick: half of the rays, and "    \
            "of a still two frames, smoothed; options beside it win"                                                   \
    }

/* Sets one field from text (TEXTS: adds to it). value is NULL for a bare bool; NOC_ERR_ARGUMENT, reported with the
 * option's name, the text and what would be right. For BOOL and SWITCH, "true/false/on/off/yes/no/1/0". */
NOC_API noc_status noc_option_set(const noc_option *option, void *params, const char *value, noc_log *log);
/* The field's present value as text, for help and metadata. Returns the length, like snprintf. */
NOC_API int noc_option_get(const noc_option *option, const void *params, char *text, size_t size);
/* Bytes of the field; of a text, those of its pointer. */
NOC_API size_t noc_option_size(const noc_option *option);
/* Is every field that table has a row for within that row? NOC_ERR_ARGUMENT after reporting the first that is not, as
 * "OF: FIELD is 0, must be in 1..9"; of says whose fields they are. What takes the params calls it itself. */
NOC_API noc_status noc_option_check(const noc_option *table, const void *params, const char *of, noc_log *log);
/* True where params lack what the option needs, so that its value changes no picture; why then tells, for a message:
 * "it needs method ris, not is". table: of params, where the options that it needs are. */
NOC_API bool noc_option_idle(const noc_option *option, const noc_option *table, const void *params, char *why,
                             size_t size);

/* Of noc_city_options and noc_builtin_options: the input that the option is for and that is not among these, such as
 * "builtin:mess". NULL: one is there, or the option is of another table. */
NOC_API const char *noc_option_needs_input(const noc_option *option, const char *const *inputs, size_t count);

#ifdef __cplusplus
}
#endif
#endif
