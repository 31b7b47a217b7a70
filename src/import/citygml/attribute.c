/* attribute.c: what an object says of itself: its class, function, usage and name, and generic attributes,
 * which carry their names in XML in CityGML 1.0 and 2.0, and as elements in 3.0. */
#include "import/citygml/citygml.h"
#include "import/lamps/tags.h"
#include "import/use.h"

#include <math.h>
#include <stdio.h>

#define MOST_STOREYS 250
#define MOST_METRES 1000

#define MOST 256 /* attributes of an object, or of a part of it, that are kept */

/* Furniture, generic objects, and what is mounted on buildings and bridges. */
bool cg_may_be_lamp(const cg_feature_type *type) {
    static const char installation[] = "Installation";
    size_t n = strlen(type->name), m = strlen(installation);
    if (type->part == CG_PART_INSTALLATION && n > m && !strcmp(type->name + n - m, installation))
        return true;
    return type->kind == GEO_FURNITURE ||
           (type->kind == GEO_OTHER && type->part == CG_PART_BODY && !strncmp(type->name, "Generic", 7));
}

void cg_attribute_add(cg_parser *p, uint32_t feature, const char *key, const char *value, bool generic) {
    cg_object *object = &p->object;
    cg_feature *of = &object->features.data[feature];
    value += strspn(value, " \t\r\n");
    if (of->attributes == MOST || !*value || !cg_object_room(p))
        return;
    size_t n = strlen(value);
    while (n && strchr(" \t\r\n", value[n - 1]))
        n--;
    cg_attribute a = { arena_strdup(&object->arena, key), arena_strndup(&object->arena, value, n), feature, generic };
    if (!a.key || !a.value || !array_push(&object->attributes, a))
        cg_no_memory(p);
    of->first_attribute = of->attributes++ ? of->first_attribute : (uint32_t)object->attributes.len - 1;
    of->end_attribute = (uint32_t)object->attributes.len;
}

const char *cg_attribute_get(const cg_object *object, uint32_t feature, const char *key) {
    const cg_feature *of = &object->features.data[feature];
    for (size_t i = of->first_attribute; i < of->end_attribute; i++) {
        const cg_attribute *a = &object->attributes.data[i];
        if (a->feature == feature && !a->generic && !strcmp(a->key, key))
            return a->value;
    }
    return NULL;
}

bool cg_attribute_start(cg_parser *p, cg_frame *frame, const char *name) {
    if (frame->feature == CG_NONE || frame->geometry != CG_NONE || frame->in_attribute ||
        !cg_may_be_lamp(p->object.features.data[frame->feature].type))
        return false;
    snprintf(p->attribute, sizeof(p->attribute), "%s", name ? name : "");
    frame->in_attribute = true;
    return true;
}

/* The unit of "urn:ogc:def:uom:UCUM::[ft_i]", "#ft" and the like; EPSG's feet are 9002 and 9003. */
static const char *unit_of(const char *uom) {
    const char *unit = uom;
    for (const char *c = uom; *c; c++)
        if (strchr(":#/", *c))
            unit = c + 1;
    unit += *unit == '[';
    return !strcmp(unit, "9002") || !strcmp(unit, "9003") ? "ft" : unit;
}

void cg_attribute_end(cg_parser *p, const cg_frame *frame) {
    if (p->text == CG_TEXT_WORD && frame[-1].name.code == CG_HEIGHT) {
        p->word[p->word_len] = 0;
        cg_note_building(p, frame->feature, "measuredHeight", p->word);
        return;
    }
    if (!frame->in_attribute || p->text != CG_TEXT_WORD)
        return;
    p->word[p->word_len] = 0;
    if (frame->name.code == CG_ATTRIBUTE_NAME) {
        snprintf(p->attribute, sizeof(p->attribute), "%s", p->word);
        return;
    }
    char value[sizeof(p->word) + sizeof(p->uom)];
    const char *unit = unit_of(p->uom);
    snprintf(value, sizeof(value), "%s%s%s", p->word, *unit ? " " : "", unit);
    if (*p->attribute)
        cg_attribute_add(p, frame->feature, p->attribute, value, true);
}

/* What a building says of its use goes before what its parts say, functions before usages, and those before classes.
 * Storeys are those of the building itself; 9999 and the like stand for none. */
void cg_note_building(cg_parser *p, uint32_t index, const char *key, const char *word) {
    const cg_feature_type *type = p->object.features.data[index].type;
    double storeys, height;
    int times;
    if (type->kind != GEO_BUILDING || type->part != CG_PART_BODY || !strcmp(key, "name"))
        return;
    if (!strcmp(key, "storeysAboveGround")) {
        if (index == 0 && noc_parse_double(word, &storeys) && storeys >= 0 && storeys <= MOST_STOREYS)
            p->object.storeys = storeys;
        return;
    }
    if (!strcmp(key, "measuredHeight")) {
        char text[sizeof(p->word) + sizeof(p->uom)];
        snprintf(text, sizeof(text), "%s %s", word, p->xml ? unit_of(p->uom) : "");
        if (lamp_quantity(text, LAMP_METRES, 1, '.', &height, &times) &&
            height <= MOST_METRES) /* the greatest of several */
            p->object.features.data[index].height = fmax(height, p->object.features.data[index].height);
        return;
    }
    noc_building_use use = building_use_told(key, word);
    int rank = (index == 0 ? 4 : 0) + (!strcmp(key, "function") ? 3 : !strcmp(key, "usage") ? 2 : 1);
    if (use == NOC_USE_UNKNOWN || rank <= p->object.use_rank)
        return;
    p->object.use = use;
    p->object.use_rank = rank;
}
