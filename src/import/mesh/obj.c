/* Wavefront OBJ with MTL. Researchers' night scenes come so, with their lamps as emissive surfaces.
 *
 * Units: metres; import/load/place.c says where the coordinates belong. OBJ does not say which axis is up; y is what
 * most programs write, and noc_import_params.obj_up says otherwise. MTL: Kd is the diffuse reflectance (linear), Ke the
 * radiance in cd/m2, Ks with illum 2 and above the reflectance of the glossy lobe at normal incidence, Ns its
 * Blinn-Phong exponent n, turned into the GGX lobe of the same width, alpha^2 = 2 / (n + 2) (Walter et al. 2007, eq. 37
 * ff.), d (or 1 - Tr) what of the light a surface takes, map_Kd
 * an image of the diffuse reflectance, times Kd. Assimp hears nothing of that one, which obj_library.c
 * finds; other textures are not read.
 *
 * Assimp reads the materials. Vertices and faces are read here (obj_text.c): its floats would round coordinates of a
 * CRS to half a metre, one odd number makes it refuse a file whole, and it takes 500 bytes a triangle. */
#include "import/import.h"
#include "import/mesh/obj_library.h"
#include "import/mesh/obj_materials.h"
#include "import/mesh/obj_mesh.h"
#include "import/mesh/obj_up.h"
#include "noc_config.h"
#include "scene/scene.h"

#include <math.h>
#include <stdio.h>

/* ---- probe ---- */

#define BOM "\xef\xbb\xbf" /* some editors' mark of UTF-8 */

static bool is_keyword(const char *line, size_t len) {
    static const char *const keywords[] = {
        "v",      "vt",     "vn",       "vp",       "f",     "o",      "g",          "s",        "l",   "p",
        "usemtl", "mtllib", "usemap",   "maplib",   "deg",   "cstype", "bevel",      "lod",      "fo",  "curv",
        "curv2",  "surf",   "parm",     "trim",     "hole",  "scrv",   "sp",         "end",      "con", "mg",
        "bmat",   "step",   "c_interp", "d_interp", "ctech", "stech",  "shadow_obj", "trace_obj"
    };
    size_t n = 0;
    while (n < len && line[n] != ' ' && line[n] != '\t' && line[n] != '\r')
        n++;
    for (size_t i = 0; i < NOC_COUNT(keywords); i++)
        if (strlen(keywords[i]) == n && !memcmp(line, keywords[i], n))
            return true;
    return false;
}

/* Statements of OBJ in every line that is seen whole, one of them a vertex, a group or a material. */
static bool probe(const char *head, size_t size) {
    size_t statements = 0;
    bool goes_on = false; /* a backslash at the end of the last line */
    for (const char *p = head + (size >= 3 && !memcmp(head, BOM, 3) ? 3 : 0), *end = head + size; p < end;) {
        const char *line = p, *stop = memchr(p, '\n', (size_t)(end - p));
        p = stop ? stop + 1 : end;
        size_t len = (size_t)((stop ? stop : end) - line);
        bool continued = goes_on;
        goes_on = (len && line[len - 1] == '\\') || (len > 1 && line[len - 1] == '\r' && line[len - 2] == '\\');
        if (continued)
            continue;
        while (len && (*line == ' ' || *line == '\t')) {
            line++;
            len--;
        }
        if (!len || *line == '#' || *line == '\r')
            continue;
        if (!is_keyword(line, len))
            return statements > 0 && !stop; /* the last line may be cut */
        statements++;
    }
    return statements > 0;
}

#if NOC_HAVE_ASSIMP

#include "import/mesh/assimp.h"

#include <assimp/ObjMaterial.h>
#include <assimp/cfileio.h>
#include <assimp/scene.h>

/* ---- files as Assimp sees them: an OBJ of ours, MTLs from beside the one that is read ---- */

#define ROOT "@/" /* names that begin so lie in the OBJ's folder */

typedef struct library {
    obj_folder folder;
    char *main_name; /* what the OBJ is called to Assimp: its content decides, so always .obj */
    char *data;      /* the OBJ's */
    size_t size;
    NOC_ARRAY(char) asked; /* what Assimp reads in its place */
    bool refused;          /* memory was, to what Assimp would have read */
    obj_images images;
    geo_issues *issues;
} library;

typedef struct open_file {
    char *data;
    size_t size, pos;
    bool owned;
} open_file;

static size_t file_read(struct aiFile *f, char *to, size_t size, size_t count) {
    open_file *o = (open_file *)f->UserData;
    size_t items = size ? NOC_MIN(count, (o->size - o->pos) / size) : 0;
    memcpy(to, o->data + o->pos, items * size);
    o->pos += items * size;
    return items;
}

static size_t file_write(struct aiFile *f, const char *from, size_t size, size_t count) { return 0; }
static size_t file_tell(struct aiFile *f) { return ((open_file *)f->UserData)->pos; }
static size_t file_size(struct aiFile *f) { return ((open_file *)f->UserData)->size; }
static void file_flush(struct aiFile *f) {}

static enum aiReturn file_seek(struct aiFile *f, size_t offset, enum aiOrigin origin) {
    open_file *o = (open_file *)f->UserData;
    size_t base = origin == aiOrigin_CUR ? o->pos : origin == aiOrigin_END ? o->size : 0;
    size_t pos = base + offset; /* offsets from the end come as wrapped negatives */
    if (pos > o->size)
        return aiReturn_FAILURE;
    o->pos = pos;
    return aiReturn_SUCCESS;
}

static struct aiFile *library_open(struct aiFileIO *io, const char *name, const char *mode) {
    library *lib = (library *)io->UserData;
    open_file o = { 0 };
    if (!strcmp(name, lib->main_name)) {
        o = (open_file){ .data = lib->asked.data, .size = lib->asked.len };
    } else {
        const char *relative = !strncmp(name, ROOT, strlen(ROOT)) ? name + strlen(ROOT) : name;
        o.data = obj_open_library(&lib->folder, relative, &o.size, NULL, lib->issues);
        o.owned = true;
        lib->refused = lib->refused || lib->folder.refused;
        if (!o.data)
            return NULL;
    }
    struct aiFile *f = noc_calloc(1, sizeof(*f));
    open_file *held = noc_alloc(sizeof(*held));
    if (!f || !held) {
        lib->refused = true;
        free(f);
        free(held);
        if (o.owned)
            free(o.data);
        return NULL;
    }
    *held = o;
    *f = (struct aiFile){ .ReadProc = file_read,
                          .WriteProc = file_write,
                          .TellProc = file_tell,
                          .FileSizeProc = file_size,
                          .SeekProc = file_seek,
                          .FlushProc = file_flush,
                          .UserData = (char *)held };
    return f;
}

static void library_close(struct aiFileIO *io, struct aiFile *f) {
    open_file *o = (open_file *)f->UserData;
    if (o->owned)
        free(o->data);
    free(o);
    free(f);
}

/* ---- materials ---- */

static bool get_colour(const struct aiMaterial *m, const char *key, float rgb[3]) {
    struct aiColor4D c = { 0 };
    if (assimp.aiGetMaterialColor(m, key, 0, 0, &c) != aiReturn_SUCCESS)
        return false;
    rgb[0] = c.r;
    rgb[1] = c.g;
    rgb[2] = c.b;
    return true;
}

static bool get_float(const struct aiMaterial *m, const char *key, float *value) {
    ai_real x;
    unsigned one = 1;
    if (assimp.aiGetMaterialFloatArray(m, key, 0, 0, &x, &one) != aiReturn_SUCCESS || !isfinite(x))
        return false;
    *value = (float)x;
    return true;
}

static void clamp_colour(float rgb[3], float hi, bool *changed) {
    for (int i = 0; i < 3; i++) {
        float x = rgb[i] >= 0 ? NOC_MIN(rgb[i], hi) : 0; /* NaN becomes 0 */
        *changed |= x != rgb[i];
        rgb[i] = x;
    }
}

static bool is_coloured(const float rgb[3]) {
    return NOC_MAX(rgb[0], NOC_MAX(rgb[1], rgb[2])) - NOC_MIN(rgb[0], NOC_MIN(rgb[1], rgb[2])) > .01f;
}

/* Illumination models of an MTL that let light through: 4, 6, 7 and 9. */
static bool is_glass(int illum) { return illum == 4 || illum == 6 || illum == 7 || illum == 9; }

static noc_material convert_material(const struct aiMaterial *m, const char *name, geo_issues *issues) {
    noc_material out = noc_class_material(NOC_CLASS_OTHER);
    float ks[3] = { 0 }, ns = 0, opacity = 1;
    int illum = -1;
    unsigned one = 1;
    bool changed = false;
    get_colour(m, "$clr.diffuse", out.albedo);
    get_colour(m, "$clr.emissive", out.emission);
    clamp_colour(out.albedo, 1, &changed);
    clamp_colour(out.emission, 1e12f, &changed);
    if (assimp.aiGetMaterialIntegerArray(m, "$mat.illum", 0, 0, &illum, &one) != aiReturn_SUCCESS)
        illum = -1;
    if (illum >= 2 && get_colour(m, "$clr.specular", ks) && get_float(m, "$mat.shininess", &ns)) {
        clamp_colour(ks, 1, &changed);
        out.f0 = 0.2126f * ks[0] + 0.7152f * ks[1] + 0.0722f * ks[2];
        out.f0 = NOC_MIN(out.f0, 1);
        float alpha2 = 2 / (NOC_MAX(ns, 0) + 2);
        out.roughness = NOC_CLAMP(sqrtf(sqrtf(alpha2)), .05f, 1);
    }
    /* together they reflect no more than falls in */
    float most = NOC_MAX(out.albedo[0], NOC_MAX(out.albedo[1], out.albedo[2]));
    if (most + out.f0 > 1)
        for (int i = 0; i < 3; i++)
            out.albedo[i] *= (1 - out.f0) / most;
    bool clear = get_float(m, "$mat.opacity", &opacity) && opacity < 1;
    float tf[3] = { 1, 1, 1 };
    get_colour(m, "$clr.transparent", tf);
    if (!clear && is_glass(illum)) {
        clamp_colour(tf, 1, &changed);
        opacity = 1 - (0.2126f * tf[0] + 0.7152f * tf[1] + 0.0722f * tf[2]);
        clear = opacity > 0; /* a filter of 1 is also what is said of none */
        opacity = clear ? opacity : 1;
        geo_issue(issues, GEO_GUESSED,
                  clear ? "glass by its illum, as clear as its Tf"
                        : "glass by its illum, taken as opaque without d or Tr",
                  name);
    }
    if (changed || !(opacity >= 0 && opacity <= 1))
        geo_issue(issues, GEO_GUESSED, "material values out of range, clamped", name);
    if (clear && noc_material_shines(&out))
        geo_issue(issues, GEO_GUESSED, "transparent material that emits, taken as opaque", name);
    else if (clear)
        out.transmittance = 1 - NOC_MAX(opacity, 0);
    if (out.transmittance > 0 && is_coloured(tf))
        geo_issue(issues, GEO_GUESSED, MESH_COLOURED_GLASS, name);
    return out;
}

/* ---- from its text to a scene ---- */

/* The material of so many, without or with its image. */
static noc_status add_material(const obj_target *to, const struct aiMaterial *from, const char *name,
                               const obj_image *texture, int *material) {
    noc_material converted = convert_material(from, name, to->parts->issues);
    mesh_image image = { .name = texture ? texture->name : NULL,
                         .wrap = texture && texture->clamp ? NOC_WRAP_CLAMP : NOC_WRAP_REPEAT };
    bool black = true; /* as some programs write it beside a texture */
    for (int k = 0; k < 3; k++)
        black = black && converted.albedo[k] == 0;
    for (int k = 0; k < 3; k++)
        image.albedo[k] = black ? 1 : converted.albedo[k];
    return to->parts->material(to->parts->ctx, &converted, name, texture ? &image : NULL, material);
}

/* The materials by their names; what has none, or one that is not there, has the first. */
static noc_status add_meshes(const struct aiScene *from, const obj_text *text, const obj_target *to) {
    noc_map numbers = { 0 };
    int *materials = noc_alloc(((size_t)from->mNumMaterials + 1) * 2 * sizeof(*materials)); /* see add_material */
    bool memory = materials != NULL;
    obj_builder builder = { .to = to, .text = text };
    noc_status status = NOC_OK;
    for (unsigned i = from->mNumMaterials; i-- && memory;) { /* of one name the first */
        struct aiString name = { 0 };
        assimp.aiGetMaterialString(from->mMaterials[i], "?mat.name", 0, 0, &name);
        memory = map_put(&numbers, name.data, i, NULL);
        materials[2 * i] = materials[2 * i + 1] = -1;
    }
    for (size_t i = 0; i < text->meshes.len && memory && !status && from->mNumMaterials; i++) {
        const obj_mesh *mesh = &text->meshes.data[i];
        uint64_t number = 0, image_number;
        struct aiString name = { 0 };
        if (mesh->material)
            map_get(&numbers, mesh->material, &number);
        assimp.aiGetMaterialString(from->mMaterials[number], "?mat.name", 0, 0, &name);
        const obj_image *image =
            map_get(&to->images->of, name.data, &image_number) ? &to->images->list.data[image_number] : NULL;
        if (image && !mesh->placed) {
            geo_issue(to->parts->issues, GEO_GUESSED, "texture without places in it, plain material", name.data);
            image = NULL;
        }
        int *material = &materials[2 * number + (image != NULL)];
        if (*material < 0)
            status = add_material(to, from->mMaterials[number], name.data, image, material);
        if (!status)
            status = obj_add_mesh(&builder, i, *material, image);
    }
    obj_builder_free(&builder);
    map_free(&numbers);
    free(materials);
    return memory ? status : noc_no_memory(to->parts->log, "OBJ");
}

static noc_status read_obj(const char *path, library *lib, const obj_text *text, const obj_target *to) {
    struct aiFileIO io = { .OpenProc = library_open, .CloseProc = library_close, .UserData = (char *)lib };
    const struct aiScene *from = assimp.aiImportFileEx(lib->main_name, 0, &io);
    noc_status status;
    if (lib->refused) {
        status = noc_no_memory(to->parts->log, path);
    } else if (!from) {
        const char *why = assimp.aiGetErrorString();
        status = noc_error(to->parts->log, NOC_ERR_FORMAT, "%s: OBJ: %s", path, why && *why ? why : "not readable");
    } else {
        if (lib->folder.missing) {
            noc_warn(to->parts->log, "%s: default material, because %s", path, lib->folder.missing);
            geo_issue(lib->issues, GEO_GUESSED, "library of materials that cannot be read, default material", "mtllib");
        }
        status = add_meshes(from, text, to);
    }
    assimp.aiReleaseImport(from);
    return status;
}

static void plain_lines(library *lib) {
    if (lib->size >= 3 && !memcmp(lib->data, BOM, 3))
        memset(lib->data, ' ', 3);
    if (!memchr(lib->data, '\n', lib->size)) /* lines that end as they did on old Macs */
        for (size_t i = 0; i < lib->size; i++)
            lib->data[i] = lib->data[i] == '\r' ? '\n' : lib->data[i];
}

/* Libraries of the text, and a triangle, without which Assimp refuses a file. */
static bool ask_for_materials(library *lib, const obj_chunks *text) {
    static const char triangle[] = "v 0 0 0\nf 1 1 1\n";
    bool memory = true;
    for (size_t i = 0; i < text->asked.len && memory; i++) {
        const char *p = text->asked.data[i], *newline = memchr(p, '\n', (size_t)(text->stop - p));
        const char *end = newline ? newline : text->stop;
        while (p < end && (*p == ' ' || *p == '\t'))
            p++;
        size_t n = (size_t)(end - p);
        if (n > 7 && (!memcmp(p, "mtllib", 6) || !memcmp(p, "usemtl", 6)))
            memory = array_append(&lib->asked, p, n) && array_push(&lib->asked, '\n');
    }
    return memory && array_append(&lib->asked, triangle, sizeof(triangle) - 1);
}

static noc_status read_parts(const char *path, noc_stream *stream, const noc_import_params *params,
                             const mesh_parts *parts, const char **format) {
    *format = "OBJ";
    library lib = { .issues = parts->issues };
    const char *slash = strrchr(path, '/'), *base = slash ? slash + 1 : path, *dot = strchr(base, '.');
    const char *name = noc_stream_name(stream);
    bool textures = !params || params->textures;
    noc_status status = noc_stream_read_all(stream, parts->log, &lib.data, &lib.size);
    if (status)
        return status;
    char *folder = noc_strndup(path, (size_t)(base - path));
    lib.folder = (obj_folder){ .path = folder,
                               .anywhere = params && params->allow_outside,
                               .listener = noc_stream_listener(stream),
                               .textures = textures };
    lib.main_name = noc_format(ROOT "%.*s.obj", (int)(dot ? dot - base : (ptrdiff_t)strlen(base)), base);
    obj_spread spread = { 0 };
    obj_text text = { 0 };
    obj_chunks chunks = { 0 };
    const obj_target to = {
        .parts = parts, .images = &lib.images, .z_up = params && params->obj_up == NOC_OBJ_UP_Z, .spread = &spread
    };
    plain_lines(&lib);
    status =
        folder && lib.main_name && obj_chunks_cut(&chunks, lib.data, lib.size, (int)import_threads(params, OBJ_THREADS))
            ? obj_plain_materials(&chunks, &lib.folder, textures ? &lib.images : NULL, noc_stream_budget(stream),
                                  parts->issues, name, parts->log)
            : noc_no_memory(parts->log, path);
    if (!status &&
        (!obj_text_read(&text, &chunks, lib.images.list.len > 0, parts->issues) || !ask_for_materials(&lib, &chunks)))
        status = noc_no_memory(parts->log, name);
    obj_chunks_free(&chunks);
    free(lib.data);
    const char *why_not = !status && text.faces.len ? assimp_load() : NULL;
    if (why_not)
        status = noc_error(parts->log, NOC_ERR_UNSUPPORTED, "%s: OBJ needs Assimp, which cannot be loaded: %s", path,
                           why_not);
    if (!status && text.faces.len) {
        status = read_obj(path, &lib, &text, &to);
        if (!status)
            obj_check_up(&spread, to.z_up, path, parts->log);
    }
    obj_text_free(&text);
    obj_images_free(&lib.images);
    array_free(&lib.asked);
    free(folder);
    free(lib.main_name);
    free(lib.folder.missing);
    return status;
}

static noc_status read_mesh(const char *path, noc_stream *stream, const noc_import_params *params, noc_scene *scene,
                            const mesh_place *place, geo_issues *issues, const char **format) {
    mesh_scene to = { .scene = scene, .place = place, .issues = issues };
    const mesh_parts parts = mesh_scene_parts(&to);
    return read_parts(path, stream, params, &parts, format);
}

static bool foreign(const char *head, size_t size) { return true; }

const noc_reader noc_reader_mesh = { .name = "OBJ",
                                     .reads = NOC_READS_MESH,
                                     .probe = probe,
                                     .read_mesh = read_mesh,
                                     .read_parts = read_parts,
                                     .foreign = foreign,
                                     .load = assimp_load };

#else

const noc_reader noc_reader_mesh = { .name = "OBJ",
                                     .reads = NOC_READS_MESH,
                                     .probe = probe,
                                     .missing = "OBJ files need Assimp, which this build is without" };

#endif
