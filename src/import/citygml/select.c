/* select.c: which of an object's surfaces are shown.
 *
 * Level of detail: the best one at or under the limit that the object or one of its parts has; parts and installations
 * follow, and stay at a lower level where they lack that one. Surfaces with a meaning (boundedBy, openings) come before
 * the solid that they bound: a solid is shown only where there are none. Every polygon is shown once, by identity, and
 * shapes that were written twice are shown once, by their points. */
#include "import/citygml/citygml.h"
#include "import/lamps/tags.h"

#include <ctype.h>

#define MAX_LINKS 16 /* references to references */

/* ---- references ---- */

static cg_part part_of(const cg_object *object, uint32_t geometry) {
    return (cg_part)object->features.data[object->geometries.data[geometry].feature].type->part;
}

/* Room for more items; false after reporting. References that name a list twice double it from object to object. */
static bool items_room(cg_parser *p, size_t more) {
    size_t len = p->selection.items.len, cap = p->selection.items.cap;
    if (p->status || more <= cap - len)
        return !p->status;
    cg_affords(p, p->store.arena.bytes + p->store.item_bytes + NOC_MAX(2 * cap, len + more) * sizeof(cg_item),
               "what xlinks lead to, of this object");
    if (!p->status && !array_reserve(&p->selection.items, len + more))
        cg_no_memory(p);
    return !p->status;
}

static void push_item(cg_parser *p, cg_item item) {
    if (items_room(p, 1) && !array_push(&p->selection.items, item))
        cg_no_memory(p);
}

static void take_stored(cg_parser *p, const cg_stored *stored, uint32_t geometry, bool flip) {
    bool implicit = p->object.geometries.data[geometry].implicit != NULL;
    if (!items_room(p, stored->items.len))
        return;
    for (size_t i = 0; i < stored->items.len; i++) {
        cg_item item = stored->items.data[i];
        item.geometry = geometry;
        item.flip ^= flip;
        item.stored = true;
        item.elsewhere &= !implicit; /* a prototype is shown wherever it is placed */
        push_item(p, item);
    }
}

static void follow(cg_parser *p, const char *id, uint32_t geometry, bool flip, int links) {
    cg_object *object = &p->object;
    cg_selection *selection = &p->selection;
    /* References that lead in circles or multiply each other end here. */
    if (links == MAX_LINKS || ++object->steps > object->surfaces.len * 4 + 65536) {
        selection->tangled = true;
        return;
    }
    uint64_t index;
    if (!map_get(&object->ids, id, &index)) {
        if (map_get(&p->store.wanted, id, &index) && p->store.entries.data[index].found) {
            take_stored(p, &p->store.entries.data[index], geometry, flip);
            return;
        }
        if (!array_push(&selection->missing, id))
            cg_no_memory(p);
        push_item(p, (cg_item){ .geometry = geometry });
        return;
    }
    const cg_target *target = &object->targets.data[index];
    for (uint32_t i = target->first; i < target->first + target->count && !p->status; i++) {
        const cg_surface *s = &object->surfaces.data[i];
        bool turned = flip ^ s->flip ^ target->flip;
        if (s->href)
            follow(p, s->href, geometry, turned, links + 1);
        else if (++object->steps <= object->surfaces.len * 4 + 65536)
            push_item(p, (cg_item){ .polygon = s->polygon,
                                    .geometry = geometry,
                                    .flip = turned,
                                    .local = object->geometries.data[s->geometry].implicit != NULL });
    }
}

void cg_follow(cg_parser *p, const char *id, uint32_t geometry, bool flip) {
    cg_object *object = &p->object;
    if (!object->ids.len)
        for (size_t i = object->targets.len; i-- > 0;) /* backwards: of two equal ids the first holds */
            if (!map_put(&object->ids, object->targets.data[i].id, i, NULL)) {
                cg_no_memory(p);
                return;
            }
    follow(p, id, geometry, flip, 0);
}

void cg_resolve(cg_parser *p) {
    cg_object *object = &p->object;
    object->steps = 0;
    p->selection.tangled = false;
    p->selection.items.len = p->selection.missing.len = 0;
    for (size_t i = 0; i < object->surfaces.len && !p->status; i++) {
        const cg_surface *s = &object->surfaces.data[i];
        if (s->href)
            cg_follow(p, s->href, s->geometry, s->flip);
        else
            push_item(p, (cg_item){ .polygon = s->polygon,
                                    .geometry = s->geometry,
                                    .flip = s->flip,
                                    .local = object->geometries.data[s->geometry].implicit != NULL });
    }
}

/* ---- level of detail ---- */

/* Whether the surface bounds its body, so that it has a meaning of its own. */
static bool is_boundary(const cg_object *object, uint32_t geometry) {
    cg_part part = part_of(object, geometry);
    return part == CG_PART_BOUNDARY || part == CG_PART_OPENING;
}

static uint32_t body_of(const cg_object *object, uint32_t feature) {
    for (;; feature = object->features.data[feature].parent) {
        uint8_t part = object->features.data[feature].type->part;
        if (part == CG_PART_BODY || part == CG_PART_INSTALLATION || object->features.data[feature].parent == CG_NONE)
            return feature;
    }
}

/* Coordinates about a reference point, used as if they were places. */
static bool misplaced(const cg_item *item, const cg_geometry *g) { return item->local && !g->implicit; }

static int highest(unsigned levels) { return levels ? 31 - __builtin_clz(levels) : -1; }

static void find_levels(cg_parser *p) {
    const cg_object *object = &p->object;
    cg_selection *s = &p->selection;
    s->bodies.len = 0;
    for (uint32_t i = 0; i < object->features.len; i++)
        if (!array_push(&s->bodies, ((cg_body){ .owner = body_of(object, i), .lod = -1 }))) {
            cg_no_memory(p);
            return;
        }
    for (size_t i = 0; i < s->items.len; i++) {
        const cg_geometry *g = &object->geometries.data[s->items.data[i].geometry];
        cg_body *body = &s->bodies.data[s->bodies.data[g->feature].owner];
        if (misplaced(&s->items.data[i], g))
            continue;
        if (s->items.data[i].polygon)
            body->levels |= (uint8_t)(1u << g->lod);
        else
            body->waiting |= (uint8_t)(1u << g->lod);
    }
}

static void choose_levels(cg_parser *p) {
    const cg_object *object = &p->object;
    cg_selection *s = &p->selection;
    unsigned allowed = (2u << p->max_lod) - 1, bodies = 0, installations = 0, waiting = 0;
    for (size_t i = 0; i < s->bodies.len; i++) {
        bool installation = object->features.data[i].type->part == CG_PART_INSTALLATION;
        *(installation ? &installations : &bodies) |= s->bodies.data[i].levels;
        waiting |= s->bodies.data[i].waiting;
    }
    s->above = ((bodies | installations | waiting) & ~allowed) != 0;
    s->lod = highest(bodies & allowed);
    if (s->lod < 0)
        s->lod = highest(installations & allowed);
    if (s->lod < 0)
        s->lod = highest(waiting & allowed);
    if (s->lod < 0)
        return;
    for (size_t i = 0; i < s->bodies.len; i++) {
        cg_body *body = &s->bodies.data[i];
        unsigned levels = body->levels | (1u << s->lod & body->waiting);
        /* The object's own geometry stands for all of it, so a lower level of it would lie inside its parts. */
        unsigned fits = i == 0 || s->lod == 0 ? 1u << s->lod : ((2u << s->lod) - 1) & ~1u;
        body->lod = (int8_t)highest(levels & fits);
    }
}

/* ---- what is shown ---- */

static uint64_t mix(uint64_t x) {
    x = (x ^ x >> 31) * 0x7fb5d329728ea185u;
    x = (x ^ x >> 27) * 0x81dadef4bc2dd44du;
    return x ^ x >> 33;
}

/* Of the points, whatever the order: the same polygon may start elsewhere or run the other way round. */
static uint64_t shape_of(const cg_polygon *polygon) {
    uint64_t sum = 0;
    size_t points = 0;
    for (uint32_t r = 0; r < polygon->ring_count; r++)
        points += polygon->ring_size[r];
    for (size_t i = 0; i < points; i++) {
        uint64_t bits[3];
        memcpy(bits, polygon->xyz + 3 * i, sizeof(bits));
        sum += mix(bits[0] + mix(bits[1] + mix(bits[2])));
    }
    return sum ? sum : 1;
}

/* Adds the shape; false if it was there. */
static bool add_shape(cg_selection *s, const cg_polygon *polygon) {
    uint64_t shape = shape_of(polygon);
    size_t mask = s->shapes.len - 1, i = (size_t)shape & mask;
    for (; s->shapes.data[i]; i = (i + 1) & mask)
        if (s->shapes.data[i] == shape)
            return false;
    s->shapes.data[i] = shape;
    return true;
}

static void clear_shapes(cg_parser *p) {
    cg_selection *s = &p->selection;
    size_t size = 64;
    while (size < s->items.len * 2)
        size *= 2;
    if (!array_reserve(&s->shapes, size)) {
        cg_no_memory(p);
        return;
    }
    s->shapes.len = size;
    memset(s->shapes.data, 0, size * sizeof(*s->shapes.data));
}

static void show(cg_parser *p, cg_item *item, bool compare, bool remember) {
    cg_selection *s = &p->selection;
    cg_polygon *polygon = item->polygon;
    if (!p->object.geometries.data[item->geometry].implicit) {
        bool again = polygon->shown == p->selections || polygon->shown == CG_EMITTED || item->elsewhere;
        if (!again && remember && !add_shape(s, polygon))
            item->twin = again = compare;
        if (again) {
            s->duplicates++;
            return;
        }
        polygon->shown = p->selections;
    }
    item->shown = true;
    s->shown++;
}

/* Notes what each body has at its level. Returns whether any has both surfaces of its own and a second account of them.
 */
static bool survey(cg_parser *p) {
    const cg_object *object = &p->object;
    cg_selection *s = &p->selection;
    bool own = false, aggregate = false;
    for (size_t i = 0; i < s->items.len; i++) {
        const cg_item *item = &s->items.data[i];
        const cg_geometry *g = &object->geometries.data[item->geometry];
        cg_body *body = &s->bodies.data[s->bodies.data[g->feature].owner];
        if (!item->polygon || g->lod != body->lod || g->implicit)
            continue;
        const cg_feature_type *type = object->features.data[g->feature].type;
        bool boundary = type->part == CG_PART_BOUNDARY && type->cls != NOC_CLASS_CLOSURE;
        body->boundaries |= boundary;
        aggregate |= boundary || g->role == CG_ROLE_SOLID;
        own |= !is_boundary(object, item->geometry) && g->role == CG_ROLE_SURFACES;
    }
    return own && aggregate;
}

void cg_select(cg_parser *p) {
    const cg_object *object = &p->object;
    cg_selection *s = &p->selection;
    s->shown = s->duplicates = 0;
    if (++p->selections == CG_EMITTED)
        p->selections = 1;
    find_levels(p);
    if (!p->status)
        choose_levels(p);
    if (p->status || s->lod < 0)
        return;
    bool shapes = survey(p);
    if (shapes)
        clear_shapes(p);
    if (p->status)
        return;
    bool transport = object->features.data[0].type->kind == GEO_TRANSPORT;
    for (int meaning = 1; meaning >= 0; meaning--) {
        for (size_t i = 0; i < s->items.len; i++) {
            cg_item *item = &s->items.data[i];
            const cg_geometry *g = &object->geometries.data[item->geometry];
            const cg_body *body = &s->bodies.data[s->bodies.data[g->feature].owner];
            if (!item->polygon || misplaced(item, g) || g->lod != body->lod ||
                is_boundary(object, item->geometry) != (meaning == 1))
                continue;
            /* What the boundaries say already. A road's own surface is the sum of its traffic areas as well. */
            bool told = meaning == 0 && body->boundaries && (g->role == CG_ROLE_SOLID || transport);
            if (told && !g->implicit)
                s->duplicates++;
            else
                show(p, item, meaning == 0 && g->role == CG_ROLE_SURFACES, shapes);
        }
    }
}

/* ---- meaning of codes ---- */

static bool has_word(const char *text, const char *const *words) {
    char lower[128];
    size_t n = 0;
    for (; text[n] && n < sizeof(lower) - 1; n++)
        lower[n] = (char)tolower((unsigned char)text[n]);
    lower[n] = 0;
    for (; *words; words++)
        if (strstr(lower, *words))
            return true;
    return false;
}

static const char *const green_words[] = { "green",  "grass", "lawn",     "plant",  "tree",   "flower", "vegetation",
                                           "forest", "park",  "agricult", "garden", "meadow", NULL };

/* Codes of CityGML's code lists (OGC 12-019, annex C) and of PLATEAU's (TrafficArea_function and so on). */
static int traffic_class(long long code, bool plateau) {
    if (plateau)
        return code >= 2000 && code < 3000 ? NOC_CLASS_SIDEWALK : NOC_CLASS_ROAD;
    switch (code) {
    case 2:
    case 4:
    case 19:
    case 22: return NOC_CLASS_SIDEWALK; /* footpath, foot and cycle path, platform, stairs */
    case 30: return NOC_CLASS_GREEN;    /* green spaces */
    default: return NOC_CLASS_ROAD;
    }
}

static int land_class(long long code, bool plateau) {
    if (plateau)
        return code >= 201 && code <= 203 ? NOC_CLASS_GREEN : code == 204 ? NOC_CLASS_WATER : -1;
    return code / 1000 == 3 ? NOC_CLASS_GREEN : code / 1000 == 4 ? NOC_CLASS_WATER : -1;
}

/* Of city furniture. The standard's list (OGC 12-019, C.4): 1150 street lamp, latern or candelabra, 1170 lamp post,
 * 1220 directional spot light, 1230 floodlight mast. Project PLATEAU's: 4200 lighting facilities. */
static bool lamp_code(long long code, bool plateau) {
    return plateau ? code == 4200 : code == 1150 || code == 1170 || code == 1220 || code == 1230;
}

/* 1000 communication fixture to 1540 others */
bool cg_standard_function(const char *word) {
    long long code;
    return noc_parse_int(word, &code) && code > 1030 && code <= 1540 && code % 10 == 0;
}

int cg_function_class(const cg_feature_type *type, const char *word, bool plateau) {
    static const char *const feet[] = { "foot", "sidewalk", "pedestrian", "pavement", NULL };
    static const char *const water[] = { "water", "lake", "river", NULL };
    long long code;
    bool number = noc_parse_int(word, &code);
    if (cg_may_be_lamp(type)) {
        bool furniture = type->kind == GEO_FURNITURE;
        bool lamp = number ? furniture && lamp_code(code, plateau) : lamp_object_word(word) > 0;
        return lamp ? NOC_CLASS_LAMP : -1;
    }
    if (type->kind == GEO_LANDUSE)
        return number                        ? land_class(code, plateau)
               : has_word(word, water)       ? NOC_CLASS_WATER
               : has_word(word, green_words) ? NOC_CLASS_GREEN
                                             : -1;
    if (type->kind != GEO_TRANSPORT || type->part != CG_PART_BOUNDARY)
        return -1;
    if (type->cls == NOC_CLASS_ROAD && number)
        return traffic_class(code, plateau);
    if (type->cls == NOC_CLASS_ROAD && has_word(word, feet))
        return NOC_CLASS_SIDEWALK;
    bool green = number ? (plateau ? code / 1000 == 5 : code == 1020 || code == 1230) : has_word(word, green_words);
    return green ? NOC_CLASS_GREEN : -1;
}
