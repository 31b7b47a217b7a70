/* What shines and what is seen: materials, KHR_lights_punctual, cameras.
 *
 * Units: emissiveFactor times emissiveStrength is a radiance of cd/m2, lights are in cd, as the specifications have it.
 * Colours are linear already. Of textures that of the base colour is read (gltf_image.c). Where one is not, what it
 * would have been multiplied with stands in for it where that makes sense, and the report says so. */
#include "import/mesh/gltf.h"

#include <math.h>
#include <stdio.h>

#define DIELECTRIC 0.04     /* f0, as the specification's default */
#define UNKNOWN_TEXTURE 0.5 /* reflectance of a base colour that is in a texture, as a share of its factor */

static double limited(double x, double lo, double hi) { return x >= lo ? NOC_MIN(x, hi) : lo; } /* NaN becomes lo */

static bool in_share(double x) { return x >= 0 && x <= 1; }

static void no_textures(const gltf *g, const json_t *pbr, const json_t *m, const char *name, noc_material *out) {
    if (json_object_get(pbr, "metallicRoughnessTexture") || json_object_get(m, "emissiveTexture"))
        geo_issue(g->issues, GEO_GUESSED, "texture of roughness, metalness or emission, which is not read", name);
    if (json_object_get(m, "emissiveTexture") &&
        (out->emission[0] > 0 || out->emission[1] > 0 || out->emission[2] > 0)) {
        /* it says where the surface shines, most often on little of it */
        memset(out->emission, 0, sizeof(out->emission));
        geo_issue(g->issues, GEO_SKIPPED, "emission by a texture, left dark", name);
    }
}

static bool is_coloured(const double rgb[3]) {
    return fmax(rgb[0], fmax(rgb[1], rgb[2])) - fmin(rgb[0], fmin(rgb[1], rgb[2])) > .01;
}

/* What of the light goes through. Alpha of 1 - a lets a share of a through; so does thin glass of that transmission,
 * in the colour that it has, as far as it is no metal (`glassy`). cutoff: alpha of the texture under which there is no
 * surface. */
static void let_through(const gltf *g, const json_t *m, const double base[4], double luminance, double glassy,
                        const char *name, bool textured, uint8_t *cutoff, noc_material *out) {
    const json_t *said = json_object_get(m, "alphaMode");
    const char *mode = json_string_value(said);
    const json_t *glass = gltf_extension(m, "KHR_materials_transmission");
    bool blend = mode && !strcmp(mode, "BLEND"), mask = mode && !strcmp(mode, "MASK");
    double said_least = mask ? gltf_number(m, "alphaCutoff", 0.5) : 0.5;
    double said_clear = gltf_number(glass, "transmissionFactor", 0);
    double alpha = limited(base[3], 0, 1), least = limited(said_least, 0, 1), clear = limited(said_clear, 0, 1);
    double through = clear * luminance * glassy * (1 - DIELECTRIC);
    *cutoff = 0;
    if (!in_share(said_least) || !in_share(said_clear) || ((blend || mask) && !in_share(base[3])))
        geo_issue(g->issues, GEO_GUESSED, "material values out of range, clamped", name);
    if (said && !blend && !mask && !(mode && !strcmp(mode, "OPAQUE")))
        geo_issue(g->issues, GEO_GUESSED, "alpha mode that is not known, taken as opaque", name);
    if (json_object_get(glass, "transmissionTexture"))
        geo_issue(g->issues, GEO_GUESSED, "texture of transmission, which is not read", name);
    if (clear > 0 && glassy < 1)
        geo_issue(g->issues, GEO_GUESSED, "glass that is a metal by its metallicFactor, which lets no light through",
                  name);
    if (noc_material_shines(out)) {
        if (blend || mask || through > 0)
            geo_issue(g->issues, GEO_GUESSED, "transparent material that emits, taken as opaque", name);
        return;
    }
    if (blend)
        through = 1 - alpha * (1 - through);
    else if (mask && alpha < least)
        through = 1;
    if (textured && (blend || mask) && alpha > 0 && through < 1) {
        if (blend)
            geo_issue(g->issues, GEO_GUESSED, "alpha of a texture that blends, taken as holes where it is below a half",
                      name);
        *cutoff = blend ? 128 : (uint8_t)NOC_MIN(ceil(NOC_MIN(least / alpha, 1) * 255), 255);
    }
    if (clear > 0 && through > 0 && is_coloured(base))
        geo_issue(g->issues, GEO_GUESSED, MESH_COLOURED_GLASS, name);
    if (clear > 0 && json_object_get(gltf_extension(m, "KHR_materials_volume"), "attenuationDistance"))
        geo_issue(g->issues, GEO_GUESSED, "glass that takes light on the way through, taken as clear inside", name);
    out->cutout = *cutoff > 0;
    out->transmittance = (float)through;
}

/* Without its texture. in_image: what the texture is to be multiplied with. */
static noc_material convert_material(const gltf *g, const json_t *m, const char *name, bool textured, float in_image[3],
                                     uint8_t *cutoff) {
    noc_material out = noc_class_material(NOC_CLASS_OTHER);
    const json_t *pbr = json_object_get(m, "pbrMetallicRoughness");
    double base[4] = { 1, 1, 1, 1 }, emission[3] = { 0, 0, 0 };
    gltf_numbers(pbr, "baseColorFactor", 4, base);
    gltf_numbers(m, "emissiveFactor", 3, emission);
    double strength = gltf_number(gltf_extension(m, "KHR_materials_emissive_strength"), "emissiveStrength", 1);
    for (int k = 0; k < 3; k++)
        out.emission[k] = (float)limited(emission[k] * strength, 0, 1e12);
    bool mapped = json_object_get(pbr, "metallicRoughnessTexture") != NULL;
    no_textures(g, pbr, m, name, &out);
    double metallic = mapped ? 0 : limited(gltf_number(pbr, "metallicFactor", 1), 0, 1);
    double roughness = mapped ? 0.8 : limited(gltf_number(pbr, "roughnessFactor", 1), 0, 1), luminance = 0;
    for (int k = 0; k < 3; k++) {
        in_image[k] = (float)(limited(base[k], 0, 1) * (1 - metallic));
        base[k] = limited(base[k], 0, 1) * (textured ? UNKNOWN_TEXTURE : 1);
        luminance += base[k] * (k == 0 ? 0.2126 : k == 1 ? 0.7152 : 0.0722);
    }
    /* one colourless lobe: a metal's takes the luminance of its colour */
    double f0 = DIELECTRIC + metallic * (luminance - DIELECTRIC);
    for (int k = 0; k < 3; k++)
        out.albedo[k] = (float)NOC_MIN(base[k] * (1 - metallic), 1 - f0);
    out.f0 = (float)limited(f0, 0, 1);
    out.roughness = (float)limited(roughness, 0.05, 1);
    out.two_sided = json_is_true(json_object_get(m, "doubleSided"));
    let_through(g, m, base, luminance, 1 - metallic, name, textured, cutoff, &out);
    return out;
}

const json_t *gltf_material_of(const gltf *g, const json_t *primitive, size_t *index) {
    const json_t *m = gltf_index(primitive, "material", index) ? gltf_item(g, "materials", *index) : NULL;
    if (!m)
        *index = json_array_size(json_object_get(g->root, "materials"));
    return m;
}

noc_status gltf_material(gltf *g, const json_t *primitive, bool placed, int *index) {
    size_t number;
    const json_t *m = gltf_material_of(g, primitive, &number);
    if (!m && json_object_get(primitive, "material"))
        geo_issue(g->issues, GEO_GUESSED, "material that is not there, the default one instead", "primitive");
    int *have = &g->materials[2 * number + placed];
    noc_status status = NOC_OK;
    if (!*have) {
        const char *name = json_string_value(json_object_get(m, "name"));
        char told[32];
        snprintf(told, sizeof(told), "material %zu", number);
        name = name ? name : told;
        noc_material converted = noc_class_material(NOC_CLASS_OTHER);
        gltf_texture texture;
        float in_image[3];
        bool textured = m && gltf_texture_of(g, m, &texture);
        uint8_t cutoff = 0;
        if (m)
            converted = convert_material(g, m, name, textured, in_image, &cutoff);
        if (textured && !placed && g->told)
            geo_issue(g->issues, GEO_GUESSED,
                      g->images ? "texture without places in it, plain material"
                                : "textures are not read, plain material",
                      name);
        *have = noc_scene_add_material(g->scene, &converted) + 1;
        const char *own = json_string_value(json_object_get(m, "name"));
        if (*have && own && noc_scene_name_material(g->scene, *have - 1, own))
            return NOC_ERR_MEMORY;
        status = !*have   ? NOC_ERR_UNSUPPORTED /* said by the scene */
                 : placed ? gltf_texture_give(g, &texture, *have - 1, in_image, cutoff, name)
                          : NOC_OK;
    }
    *index = *have - 1;
    return status;
}

noc_status gltf_place(const gltf *g, const double yup[3], double out[3]) {
    out[0] = yup[0];
    out[1] = 0 - yup[2]; /* no -0 */
    out[2] = yup[1];
    return g->place->points(g->place->ctx, out, 1);
}

/* Place of a node, and the unit vectors of its -z and its y there. */
static noc_status place_frame(const gltf *g, const gltf_frame *frame, double at[3], double look[3], double up[3]) {
    const double *m = frame->m;
    double ahead[3], above[3], *out[2] = { look, up };
    for (int k = 0; k < 3; k++) {
        ahead[k] = m[9 + k] - m[6 + k];
        above[k] = m[9 + k] + m[3 + k];
    }
    noc_status status = gltf_place(g, m + 9, at);
    status = status ? status : gltf_place(g, ahead, look);
    status = status ? status : gltf_place(g, above, up);
    for (int i = 0; i < 2 && !status; i++) {
        double length = 0;
        for (int k = 0; k < 3; k++)
            out[i][k] -= at[k], length += out[i][k] * out[i][k];
        for (int k = 0; k < 3; k++)
            out[i][k] = length > 0 ? out[i][k] / sqrt(length) : 0;
    }
    return status;
}

static bool usable(const double *v, size_t n, double most) {
    for (size_t i = 0; i < n; i++)
        if (!(fabs(v[i]) < most))
            return false;
    return true;
}

/* The falloff between the cones is the scene's own (NOC_LIGHT_SPOT). */
static void set_cones(const gltf *g, const json_t *spot, noc_light *l, const char *name) {
    double outer = gltf_number(spot, "outerConeAngle", M_PI / 4), inner = gltf_number(spot, "innerConeAngle", 0);
    if (!(inner >= 0 && inner < outer && outer <= M_PI / 2 + 1e-6)) /* the extension's own limits */
        geo_issue(g->issues, GEO_GUESSED, "cones of a spot light that no light can have, limited", name);
    l->kind = NOC_LIGHT_SPOT;
    l->outer_deg = limited(outer * 180 / M_PI, 1, 90);
    l->inner_deg = limited(inner * 180 / M_PI, 0, l->outer_deg);
}

noc_status gltf_light(gltf *g, const json_t *node, const gltf_frame *frame, const char *name) {
    const json_t *use = gltf_extension(node, "KHR_lights_punctual");
    size_t index;
    if (!use)
        return NOC_OK;
    const json_t *list = json_object_get(gltf_extension(g->root, "KHR_lights_punctual"), "lights");
    const json_t *light = gltf_index(use, "light", &index) ? json_array_get(list, index) : NULL;
    const char *type = json_string_value(json_object_get(light, "type"));
    double colour[3] = { 1, 1, 1 }, intensity = gltf_number(light, "intensity", 1), look[3], up[3];
    noc_light l = { .kind = NOC_LIGHT_POINT, .name = name };
    gltf_numbers(light, "color", 3, colour);
    if (!type) {
        geo_issue(g->issues, GEO_SKIPPED, "light that is not there, or of no type", name);
        return NOC_OK;
    }
    if (strcmp(type, "point") && strcmp(type, "spot")) {
        geo_issue(g->issues, GEO_SKIPPED,
                  strcmp(type, "directional") ? "light of an unknown type" : "directional light", name);
        return NOC_OK;
    }
    for (int k = 0; k < 3; k++)
        l.emission[k] = (float)limited(colour[k] * intensity, 0, 1e12);
    if (intensity < 0 || colour[0] < 0 || colour[1] < 0 || colour[2] < 0)
        geo_issue(g->issues, GEO_GUESSED, "light of negative intensity or colour, taken as 0", name);
    if (!(l.emission[0] > 0 || l.emission[1] > 0 || l.emission[2] > 0))
        return NOC_OK; /* switched off */
    noc_status status = place_frame(g, frame, l.position, look, up);
    if (status)
        return status;
    bool aimed = look[0] != 0 || look[1] != 0 || look[2] != 0;
    if (!usable(l.position, 3, 1e7) || (*type == 's' && !aimed)) {
        geo_issue(g->issues, GEO_SKIPPED, "light whose place is not finite, or that looks nowhere", name);
        return NOC_OK;
    }
    if (*type == 's') {
        set_cones(g, json_object_get(light, "spot"), &l, name);
        memcpy(l.direction, look, sizeof(l.direction));
    }
    return noc_scene_add_light(g->scene, &l) < 0 ? NOC_ERR_ARGUMENT : NOC_OK;
}

noc_status gltf_camera(gltf *g, const json_t *node, const gltf_frame *frame, const char *name) {
    size_t index;
    if (!json_object_get(node, "camera"))
        return NOC_OK;
    const json_t *camera = gltf_index(node, "camera", &index) ? gltf_item(g, "cameras", index) : NULL;
    const json_t *perspective = json_object_get(camera, "perspective");
    if (!perspective) {
        geo_issue(g->issues, GEO_SKIPPED, camera ? "camera without perspective" : "camera that is not there", name);
        return NOC_OK;
    }
    noc_camera c = { .fov_deg = gltf_number(perspective, "yfov", 0) * 180 / M_PI };
    double look[3];
    noc_status status = place_frame(g, frame, c.eye, look, c.up);
    if (status)
        return status;
    for (int k = 0; k < 3; k++)
        c.target[k] = c.eye[k] + 10 * look[k];
    bool aimed = look[0] != 0 || look[1] != 0 || look[2] != 0, upright = c.up[0] != 0 || c.up[1] != 0 || c.up[2] != 0;
    if (!(c.fov_deg >= 1 && c.fov_deg <= 170) || !usable(c.eye, 3, 1e7) || !aimed || !upright) {
        geo_issue(g->issues, GEO_SKIPPED, "camera that looks nowhere, or whose angle is not within 1 to 170 degrees",
                  name);
        return NOC_OK;
    }
    return noc_scene_set_camera(g->scene, &c);
}
