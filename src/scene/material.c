/* Materials, and what each class of surface is made of. */
#include "scene/scene.h"

/* A dry road of class R3, which roads are by default. */
#define ROAD_ALBEDO .073f
#define ROAD_F0 .04f
#define ROAD_ROUGHNESS .8f

/* Reflectances: typical values for dry surfaces (IESNA Lighting Handbook, building materials). */
#define CLASSES                                                                                                        \
    CLASS(NOC_CLASS_OTHER, "other", .30f, .30f, .30f, 0, 1)                                                            \
    CLASS(NOC_CLASS_WALL, "wall", .46f, .42f, .36f, 0, 1)                                                              \
    CLASS(NOC_CLASS_ROOF, "roof", .26f, .15f, .11f, .02f, .7f)                                                         \
    CLASS(NOC_CLASS_GROUND, "ground", .20f, .20f, .19f, 0, 1)                                                          \
    CLASS(NOC_CLASS_CLOSURE, "closure", .30f, .30f, .30f, 0, 1)                                                        \
    CLASS(NOC_CLASS_WINDOW, "window", .05f, .06f, .07f, .06f, .15f)                                                    \
    CLASS(NOC_CLASS_DOOR, "door", .20f, .13f, .08f, .04f, .5f)                                                         \
    CLASS(NOC_CLASS_INSTALLATION, "installation", .38f, .36f, .33f, 0, 1)                                              \
    CLASS(NOC_CLASS_TERRAIN, "terrain", .17f, .17f, .14f, 0, 1)                                                        \
    CLASS(NOC_CLASS_ROAD, "road", ROAD_ALBEDO, ROAD_ALBEDO, ROAD_ALBEDO, ROAD_F0, ROAD_ROUGHNESS)                      \
    CLASS(NOC_CLASS_SIDEWALK, "sidewalk", .25f, .24f, .23f, .02f, .8f)                                                 \
    CLASS(NOC_CLASS_GREEN, "green", .08f, .13f, .05f, 0, 1)                                                            \
    CLASS(NOC_CLASS_TREE, "tree", .07f, .12f, .04f, 0, 1)                                                              \
    CLASS(NOC_CLASS_WATER, "water", .02f, .03f, .04f, .02f, .12f)                                                      \
    CLASS(NOC_CLASS_BRIDGE, "bridge", .30f, .29f, .27f, 0, 1)                                                          \
    CLASS(NOC_CLASS_FURNITURE, "furniture", .22f, .22f, .22f, .04f, .5f)                                               \
    CLASS(NOC_CLASS_LAMP, "lamp", .10f, .10f, .10f, .04f, .4f)                                                         \
    CLASS(NOC_CLASS_VEHICLE, "vehicle", .20f, .05f, .05f, .05f, .25f)

#define CLASS(id, text, r, g, b, spec, rough) [id] = text,
const char *const noc_label_names[NOC_LABEL_COUNT] = { CLASSES[NOC_CLASS_COUNT] = "wall with windows",
                                                       "wall, too small",
                                                       "wall, tilted",
                                                       "party wall",
                                                       "wall of a shed or the like",
                                                       "wall with its own windows" };
#undef CLASS
#define CLASS(id, text, r, g, b, spec, rough)                                                                          \
    [id] = { .albedo = { r, g, b }, .f0 = spec, .roughness = rough, .cls = id },
static const noc_material class_materials[NOC_CLASS_COUNT] = { CLASSES };
#undef CLASS

const char *noc_class_name(noc_class cls) { return (unsigned)cls < NOC_CLASS_COUNT ? noc_label_names[cls] : "unknown"; }

noc_material noc_class_material(noc_class cls) {
    return class_materials[(unsigned)cls < NOC_CLASS_COUNT ? cls : NOC_CLASS_OTHER];
}

/* Fitted by Q0 and S1 as tests/core/test_road_classes.c computes them from the material: dry roads with the f0 of
 * stone, wet ones with that of water. docs/defaults.md says where the standards' values are from. */
static const noc_road_class road_classes[] = {
    { "R1", .211f, .04f, .95f, .10, .25 },
    { "R2", .090f, .04f, .883f, .07, .58 },
    { "R3", ROAD_ALBEDO, ROAD_F0, ROAD_ROUGHNESS, .07, 1.11 },
    { "R4", .066f, .04f, .748f, .08, 1.55 },
    { "W1", .091f, .02f, .614f, .114, 3.2 },
    { "W2", .088f, .02f, .53f, .150, 5.7 },
    { "W3", .082f, .02f, .461f, .196, 8.6 },
    { "W4", .075f, .02f, .407f, .247, 12.6 },
    { NULL, 0, 0, 0, 0, 0 },
};

const noc_road_class *noc_road_classes(void) { return road_classes; }

/* Is it the surface of one of the wet classes? */
static bool is_wet_road(const noc_material *m) {
    for (const noc_road_class *c = road_classes; c->name; c++)
        if (*c->name == 'W' && m->albedo[0] == c->albedo && m->albedo[1] == c->albedo && m->albedo[2] == c->albedo &&
            m->f0 == c->f0 && m->roughness == c->roughness)
            return true;
    return false;
}

/* A. Angstrom, "The albedo of various surfaces of ground", Geografiska Annaler 7 (1925) 323-342. The roughness makes
 * the road as light to a driver as class W2 of wet surfaces (Q0 .150; W. van Bommel, Road Lighting, Springer 2015): a
 * film that follows the grains, without puddles. */
noc_material noc_material_wet(const noc_material *dry) {
    const float n2 = 1.333f * 1.333f, film = 0.52f;
    noc_material m = dry ? *dry : noc_class_material(NOC_CLASS_OTHER);
    if (is_wet_road(&m))
        return m;
    for (int i = 0; i < 3; i++)
        m.albedo[i] = m.albedo[i] / (n2 * (1 - m.albedo[i]) + m.albedo[i]);
    m.f0 = 0.02f;
    m.roughness = NOC_MIN(m.roughness, film);
    return m;
}

noc_material noc_material_metal(const noc_material *material, float metalness) {
    const float dielectric = 0.04f;
    noc_material m = material ? *material : noc_class_material(NOC_CLASS_OTHER);
    float share = metalness >= 0 ? NOC_MIN(metalness, 1) : 0; /* NaN becomes 0 */
    float luminance = 0.2126f * m.albedo[0] + 0.7152f * m.albedo[1] + 0.0722f * m.albedo[2];
    m.f0 = dielectric + share * (luminance - dielectric);
    for (int i = 0; i < 3; i++)
        m.albedo[i] = NOC_MIN(m.albedo[i] * (1 - share), 1 - m.f0);
    return m;
}

static bool in_range(float x, float lo, float hi) { return x >= lo && x <= hi; } /* false for NaN */

const char *noc_material_fault(const noc_scene *scene, const noc_material *m) {
    if (m->texture < 0 || (size_t)m->texture > scene->textures.len)
        return "there is no such texture";
    bool emits = m->emission[0] > 0 || m->emission[1] > 0 || m->emission[2] > 0;
    if (!in_range(m->transmittance, 0, 1))
        return "transmittance must be in 0..1";
    if (emits && noc_material_lets_through(m))
        return "a surface that emits lets no light through";
    bool ok = in_range(m->f0, 0, 1) && in_range(m->roughness, 0.05f, 1) && (unsigned)m->cls < NOC_CLASS_COUNT;
    for (int i = 0; i < 3; i++)
        ok = ok && in_range(m->albedo[i], 0, 1) && in_range(m->emission[i], 0, 1e12f);
    return ok ? NULL : "albedo and f0 must be in 0..1, roughness in 0.05..1, emission finite and not negative";
}

noc_material_record noc_material_record_of(const noc_material *m) {
    noc_material_record r = { .f0 = m->f0, .alpha = m->roughness * m->roughness };
    memcpy(r.albedo, m->albedo, sizeof(r.albedo));
    memcpy(r.emission, m->emission, sizeof(r.emission));
    return r;
}

bool noc_material_of_light(const noc_material *m) {
    return m->cls == NOC_CLASS_LAMP && m->albedo[0] == 0 && m->albedo[1] == 0 && m->albedo[2] == 0 && m->f0 == 0 &&
           !m->two_sided;
}

static int add_material(noc_scene *scene, const noc_material *m, uint32_t uses) {
    if (scene->no_memory)
        return -1;
    const char *wrong = noc_material_fault(scene, m);
    if (wrong) {
        noc_error(scene->log, NOC_ERR_ARGUMENT, "material: %s", wrong);
        return -1;
    }
    noc_scene *to = noc_scene_adding(scene);
    if (!to)
        return -1;
    if (!array_reserve(&to->materials, to->materials.len + 1) ||
        !array_reserve(&to->material_records, to->materials.len + 1) ||
        !array_reserve(&to->material_uses, to->materials.len + 1)) {
        noc_scene_out_of_memory(scene);
        return -1;
    }
    to->materials.data[to->materials.len++] = *m;
    to->material_records.data[to->material_records.len++] = noc_material_record_of(m);
    to->material_uses.data[to->material_uses.len++] = uses;
    if (to == scene)
        scene->lets_through |= noc_material_lets_through(m); /* else its commit sees to it: frames ask */
    return (int)noc_scene_material_count(scene) - 1;
}

int noc_scene_add_material(noc_scene *scene, const noc_material *m) {
    if (scene && m)
        return add_material(scene, m, NOC_NOT_OF_LIGHTS);
    noc_null(scene ? scene->log : NULL, __func__);
    return -1;
}

noc_status noc_scene_name_material(noc_scene *scene, int material, const char *name) {
    if (!scene)
        return noc_null(NULL, __func__);
    if (scene->no_memory)
        return NOC_ERR_MEMORY;
    if (material < 0 || (size_t)material >= noc_scene_material_count(scene))
        return noc_error(scene->log, NOC_ERR_ARGUMENT, "material %d: there is no such material", material);
    const char *kept = NULL;
    size_t before = scene->material_names.len;
    if (!noc_scene_keep_name(scene, name, &kept))
        return NOC_ERR_MEMORY;
    if ((size_t)material >= before) {
        if (!array_reserve(&scene->material_names, (size_t)material + 1)) {
            noc_scene_out_of_memory(scene);
            return NOC_ERR_MEMORY;
        }
        for (size_t i = before; i <= (size_t)material; i++)
            scene->material_names.data[i] = NULL;
        scene->material_names.len = (size_t)material + 1;
    }
    scene->material_names.data[material] = kept;
    return NOC_OK;
}

int noc_scene_find_material(const noc_scene *scene, const char *name, int from) {
    for (size_t i = (size_t)NOC_MAX(from, 0); scene && name && i < scene->material_names.len; i++)
        if (scene->material_names.data[i] && !strcmp(scene->material_names.data[i], name))
            return (int)i;
    return -1;
}

noc_status noc_scene_get_material(const noc_scene *scene, int material, noc_material *out, const char **name) {
    if (!scene || !out)
        return noc_null(scene ? scene->log : NULL, __func__);
    *out = (noc_material){ 0 };
    if (material < 0 || (size_t)material >= scene->materials.len)
        return noc_error(scene->log, NOC_ERR_ARGUMENT,
                         "material %d: the scene has no such material, or it is not committed yet", material);
    *out = scene->materials.data[material];
    if (name)
        *name = (size_t)material < scene->material_names.len ? scene->material_names.data[material] : NULL;
    return NOC_OK;
}

int noc_scene_add_light_material(noc_scene *scene, const noc_material *m) {
    noc_slots *slots = &scene->light_materials;
    if (slots->taken == slots->free.len)
        return add_material(scene, m, 0);
    noc_edit edit = { .kind = NOC_EDIT_MATERIAL, .index = noc_slot_next(slots, 0), .material = *m };
    if (!array_push(&scene->edits, edit)) {
        noc_scene_out_of_memory(scene);
        return -1;
    }
    noc_slot_take(slots);
    return (int)edit.index;
}
