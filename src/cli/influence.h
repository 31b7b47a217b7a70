/* nocturne influence: what its files share. */
#ifndef NOC_CLI_INFLUENCE_H
#define NOC_CLI_INFLUENCE_H

#include "site.h"

/* Arguments of render that it takes, too, and its own. */
typedef struct influence_args {
    render_args render;
    noc_texts regions;
    const char *lamp, *csv, *classes;
    uint32_t class_bits; /* of classes; 0: the library's */
    bool json, count_windows;
    int top;
    double time, error; /* s; relative */
} influence_args;

/* Inputs to tables. */
typedef struct influence_job {
    influence_args *args;
    cli_site site;
    const char *lead;  /* printed before the next answer */
    const char *asked; /* the region that is answered now, and what is found of it */
    noc_region *region;
    noc_region_info region_info;
    noc_influence_row *rows;
    size_t count;
    noc_influence_sum sum;
    noc_influence_class classes[NOC_CLASS_COUNT]; /* where the region is one of areas */
    size_t class_count;
    char buried[128]; /* why a point is dark; "": it lies in the open */
    char *csv;        /* of the regions until now; NULL: none yet */
} influence_job;

bool influence_has_eye(const char *region);

/* influence_lamp.c: --lamp */
noc_status influence_tell_lamp(influence_job *job);

/* influence_out.c */
void influence_print_maintenance(const influence_job *job); /* a line, where it is not 1 */
void influence_json_tags(const char *tags);
noc_status influence_print(influence_job *job);       /* the table, or JSON */
bool influence_csv_alone(const influence_args *args); /* in place of the table: --csv - */
noc_status influence_add_csv(influence_job *job);     /* the region's rows to job->csv */
noc_status influence_write_csv(influence_job *job);   /* all of them, to where it is asked for */

#endif
