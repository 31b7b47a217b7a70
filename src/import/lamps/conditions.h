/* conditions: what rules for lamps and groups of lights ask (nocturne/luminaire.h), made ready.
 *
 * A reader sees a lamp's tags, and who stands it the rest. So that no tag needs to be kept, and none goes through the
 * helper's socket, readers ask the conditions on tags and hand on a bit for each. A condition's number is its place
 * among all those of the rules, and then of the groups: the same on both sides. */
#ifndef NOC_LAMP_CONDITIONS_H
#define NOC_LAMP_CONDITIONS_H

#include "import/lamps/tags.h"

typedef struct lamp_conditions lamp_conditions;

/* Of params, which must live as long. NULL after reporting what is wrong, with the rule's place, in *status; also where
 * params, which may be NULL, have none: that is NOC_OK. */
lamp_conditions *lamp_conditions_create(const noc_import_params *params, noc_log *log, noc_status *status);
void lamp_conditions_destroy(lamp_conditions *c);
/* Is any of them on the roads that a lamp stands beside? c may be NULL. */
bool lamp_conditions_ask_roads(const lamp_conditions *c);

/* Bits of the conditions that a tag of this name is asked by; c may be NULL. Is there any? */
bool lamp_conditions_of_key(const lamp_conditions *c, const char *key, uint64_t asked[GEO_CONDITIONS / 64]);
/* What conditions on tags say of a lamp without any. */
void lamp_conditions_none(const lamp_conditions *c, geo_lamp *lamp);
/* A tag of the lamp that conditions ask (asked), read as its meaning has it. decimal: as in lamp_quantity. */
void lamp_conditions_tag(const lamp_conditions *c, const uint64_t asked[GEO_CONDITIONS / 64], const lamp_tag *tag,
                         const lamp_meaning *meaning, char decimal, geo_lamp *lamp);

/* What is asked once it is known. */
typedef struct lamp_subject {
    const geo_lamp *lamp; /* NULL: no lamp, but a light of another class */
    const char *cls, *file, *street;
    const char *road; /* the word of its highway */
    bool inferred;
} lamp_subject;
/* Do all conditions of that rule, or group, hold? */
bool lamp_rule_holds(const lamp_conditions *c, size_t rule, const lamp_subject *of);
bool lamp_group_holds(const lamp_conditions *c, size_t group, const lamp_subject *of);

/* The condition of that rule, from 1 on, which a road of that highway would meet; 0: there is none. tag: of those that
 * ask the lamp's own tags for highway, else of those that ask for road. */
size_t lamp_rule_means_road(const lamp_conditions *c, size_t rule, const char *highway, bool tag);

/* A rule's or group's place: its own, or "rule 3". */
const char *lamp_rule_place(const char *place, const char *what, size_t index, char text[40]);

#endif
