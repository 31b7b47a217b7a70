/* Wavefront OBJ with MTL through Assimp. Researchers' night scenes come so, with their lamps as emissive surfaces.
 *
 * Units: metres; import/load/place.c says where the coordinates belong. OBJ does not say which axis is up; y is what
 * most programs write, and noc_import_params.obj_up says otherwise. MTL: Kd is the diffuse reflectance (linear), Ke the
 * radiance in cd/m2, Ks with illum 2 and above the reflectance of the glossy lobe at normal incidence, Ns its
 * Blinn-Phong exponent n, turned into the GGX lobe of the same width, alpha^2 = 2 / (n + 2) (Walter et al. 2007, eq. 37
 * ff.), map_Kd an image of the diffuse reflectance, times Kd. Assimp hears nothing of that one, which obj_library.c
 * finds; other textures are not read.
 *
 * One odd number makes Assimp refuse a file whole, so it sees a text that obj_offset.c, obj_faces.c and obj_library.c
 * made plain. */
#include "import/import.h"
#include "import/mesh/obj_faces.h"
#include "import/mesh/obj_library.h"
#include "import/mesh/obj_materials.h"
#include "import/mesh/obj_offset.h"
#include "import/mesh/obj_up.h"
#include "import/mesh/polygons.h"
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

#include <assimp/ObjMaterial.h>
#include <assimp/cfileio.h>
#include <assimp/cimport.h>
#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

/* ---- files as Assimp sees them: the OBJ from our stream, MTLs from beside it ---- */

#define ROOT "@/" /* names that begin so lie in the OBJ's folder */

typedef struct library {
    obj_folder folder;
    char *main_name; /* what the OBJ is called to Assimp: its content decides, so always .obj */
    char *data;
    size_t size, faces;
    char *missing; /* first library that could not be opened, and why */
    bool refused;  /* memory was, to what Assimp would have read */
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
        o = (open_file){ .data = lib->data, .size = lib->size };
    } else {
        const char *relative = !strncmp(name, ROOT, strlen(ROOT)) ? name + strlen(ROOT) : name;
        o.data = obj_open_library(&lib->folder, relative, &o.size, NULL, lib->issues);
        o.owned = true;
        lib->refused = lib->refused || lib->folder.refused;
        if (!o.data && !lib->missing && !lib->refused) {
            lib->missing = noc_format("%s%s cannot be opened: %s", *relative == '/' ? "" : lib->folder.path, relative,
                                      lib->folder.why);
            lib->refused = !lib->missing;
        }
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
    if (aiGetMaterialColor(m, key, 0, 0, &c) != aiReturn_SUCCESS)
        return false;
    rgb[0] = c.r;
    rgb[1] = c.g;
    rgb[2] = c.b;
    return true;
}

static bool get_float(const struct aiMaterial *m, const char *key, float *value) {
    ai_real x;
    unsigned one = 1;
    if (aiGetMaterialFloatArray(m, key, 0, 0, &x, &one) != aiReturn_SUCCESS || !isfinite(x))
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
    if (aiGetMaterialIntegerArray(m, "$mat.illum", 0, 0, &illum, &one) != aiReturn_SUCCESS)
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
    if (changed)
        geo_issue(issues, GEO_GUESSED, "material values out of range, clamped", name);
    if (get_float(m, "$mat.opacity", &opacity) && opacity < 1)
        geo_issue(issues, GEO_GUESSED, "transparent material, rendered opaque", name);
    return out;
}

/* ---- meshes ---- */

typedef struct mesh_target {
    const mesh_parts *parts;
    const obj_images *images;
    const double *offset; /* of the coordinates as Assimp has them, in the file's axes */
    bool z_up;
    obj_spread *spread;
} mesh_target;

/* Puts the polygons' triangles behind the others; false where there is no memory. */
static bool join_polygons(cut_mesh *cut, double **xyz, float **uv, uint32_t **indices, size_t *vertices) {
    size_t more = cut->extra.xyz.len / 3, corners = cut->extra.indices.len;
    double *x = more ? noc_realloc(*xyz, (*vertices + more) * 3 * sizeof(*x)) : NULL;
    *xyz = x ? x : *xyz;
    uint32_t *v = x ? noc_realloc(*indices, (cut->triangle_count * 3 + corners) * sizeof(*v)) : NULL;
    *indices = v ? v : *indices;
    float *places = v && *uv ? noc_realloc(*uv, (*vertices + more) * 2 * sizeof(*places)) : NULL;
    if (!more || !v || (*uv && !places))
        return !more;
    if (places) {
        memcpy(places + 2 * *vertices, cut->extra.uv.data, 2 * more * sizeof(*places));
        *uv = places;
    }
    memcpy(x + 3 * *vertices, cut->extra.xyz.data, 3 * more * sizeof(*x));
    for (size_t i = 0; i < corners; i++)
        v[3 * cut->triangle_count + i] = (uint32_t)*vertices + cut->extra.indices.data[i];
    *vertices += more;
    cut->triangle_count += corners / 3;
    return true;
}

/* image: NULL: none, or the mesh has no places in it. */
static noc_status add_mesh(const mesh_target *to, const struct aiMesh *m, int material, const obj_image *image) {
    size_t vertices = m->mNumVertices;
    double *xyz = noc_alloc_large(vertices * 3, sizeof(*xyz));
    uint32_t *indices = noc_alloc_large((size_t)m->mNumFaces * 6, sizeof(*indices));
    float *uv = image ? noc_alloc_large(vertices * 2, sizeof(*uv)) : NULL;
    const char *name = m->mName.length ? m->mName.data : NULL;
    cut_mesh cut = {
        .xyz = xyz, .uv = uv, .indices = indices, .issues = to->parts->issues, .name = name ? name : "unnamed"
    };
    bool memory = xyz && indices && (uv || !image);
    for (size_t i = 0; i < vertices && memory && uv; i++) {
        const struct aiVector3D *at = &m->mTextureCoords[0][i];
        uv[2 * i] = (float)(at->x * image->scale[0] + image->offset[0]);
        uv[2 * i + 1] = (float)(at->y * image->scale[1] + image->offset[1]);
    }
    for (size_t i = 0; i < vertices && memory; i++) {
        const struct aiVector3D *v = &m->mVertices[i];
        double x = v->x + to->offset[0], y = v->y + to->offset[1], z = v->z + to->offset[2];
        xyz[3 * i] = x;
        xyz[3 * i + 1] = to->z_up ? y : 0 - z; /* no -0 */
        xyz[3 * i + 2] = to->z_up ? z : y;
    }
    for (size_t i = 0; i < m->mNumFaces && memory; i++)
        cut_face(&cut, m->mFaces[i].mIndices, m->mFaces[i].mNumIndices);
    memory = memory && !cut.extra.no_memory && join_polygons(&cut, &xyz, &uv, &indices, &vertices);
    if (memory)
        obj_spread_add(to->spread, xyz, vertices, indices, cut.triangle_count);
    noc_mesh mesh = { .vertex_count = vertices,
                      .positions = xyz,
                      .triangle_count = cut.triangle_count,
                      .indices = indices,
                      .material = material,
                      .uv = uv,
                      .name = name };
    noc_status status = memory ? to->parts->mesh(to->parts->ctx, &mesh, xyz) : noc_no_memory(to->parts->log, cut.name);
    geo_triangles_free(&cut.extra);
    free(xyz);
    free(uv);
    free(indices);
    return status;
}

/* The material of so many, without or with its image. */
static noc_status add_material(const mesh_target *to, const struct aiMaterial *from, const char *name,
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

static noc_status add_scene(const struct aiScene *from, const mesh_target *to) {
    int *materials = noc_alloc(((size_t)from->mNumMaterials + 1) * 2 * sizeof(*materials)); /* see add_material */
    if (!materials)
        return noc_no_memory(to->parts->log, "OBJ");
    noc_status status = NOC_OK;
    memset(materials, 0xff, ((size_t)from->mNumMaterials + 1) * 2 * sizeof(*materials));
    for (unsigned i = 0; i < from->mNumMeshes && !status; i++) {
        const struct aiMesh *m = from->mMeshes[i];
        if (!m->mVertices || m->mMaterialIndex >= from->mNumMaterials)
            continue;
        struct aiString name = { 0 };
        uint64_t number;
        aiGetMaterialString(from->mMaterials[m->mMaterialIndex], "?mat.name", 0, 0, &name);
        const obj_image *image = map_get(&to->images->of, name.data, &number) ? &to->images->list.data[number] : NULL;
        if (image && !m->mTextureCoords[0]) {
            geo_issue(to->parts->issues, GEO_GUESSED, "texture without places in it, plain material", name.data);
            image = NULL;
        }
        int *material = &materials[2 * (size_t)m->mMaterialIndex + (image != NULL)];
        if (*material < 0)
            status = add_material(to, from->mMaterials[m->mMaterialIndex], name.data, image, material);
        if (!status)
            status = add_mesh(to, m, *material, image);
    }
    free(materials);
    return status;
}

static noc_status read_obj(const char *path, library *lib, const mesh_target *to) {
    struct aiFileIO io = { .OpenProc = library_open, .CloseProc = library_close, .UserData = (char *)lib };
    struct aiPropertyStore *settings = aiCreatePropertyStore();
    aiSetImportPropertyInteger(settings, AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    aiSetImportPropertyInteger(settings, AI_CONFIG_PP_RVC_FLAGS,
                               aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_COLORS |
                                   (lib->images.list.len ? 0 : aiComponent_TEXCOORDS) | aiComponent_TEXTURES);
    const struct aiScene *from = aiImportFileExWithProperties(lib->main_name,
                                                              aiProcess_SortByPType | aiProcess_RemoveComponent |
                                                                  aiProcess_JoinIdenticalVertices,
                                                              &io, settings);
    noc_status status;
    if (lib->refused) {
        status = noc_no_memory(to->parts->log, path);
    } else if (!from) {
        const char *why = aiGetErrorString();
        status = noc_error(to->parts->log, NOC_ERR_FORMAT, "%s: OBJ: %s", path, why && *why ? why : "not readable");
    } else {
        if (lib->missing) {
            noc_warn(to->parts->log, "%s: default material, because %s", path, lib->missing);
            geo_issue(lib->issues, GEO_GUESSED, "library of materials that cannot be read, default material", "mtllib");
        }
        status = add_scene(from, to);
    }
    aiReleaseImport(from);
    aiReleasePropertyStore(settings);
    return status;
}

static void plain_lines(library *lib) {
    if (lib->size >= 3 && !memcmp(lib->data, BOM, 3))
        memset(lib->data, ' ', 3);
    if (!memchr(lib->data, '\n', lib->size)) /* lines that end as they did on old Macs */
        for (size_t i = 0; i < lib->size; i++)
            lib->data[i] = lib->data[i] == '\r' ? '\n' : lib->data[i];
}

static noc_status plain_text(library *lib, double offset[3], const char *name, noc_log *log) {
    obj_numbers bad = { 0 };
    bool places = lib->images.list.len > 0;
    noc_status status = obj_plain_vertices(&lib->data, &lib->size, places, offset, &bad, lib->issues, name, log);
    lib->faces = status ? 0 : obj_plain_faces(lib->data, lib->size, places, &bad, lib->issues);
    array_free(&bad);
    return status;
}

static noc_status read_parts(const char *path, noc_stream *stream, const noc_import_params *params,
                             const mesh_parts *parts, const char **format) {
    *format = "OBJ";
    library lib = { .issues = parts->issues };
    double offset[3];
    const char *slash = strrchr(path, '/'), *base = slash ? slash + 1 : path, *dot = strchr(base, '.');
    const char *name = noc_stream_name(stream);
    bool textures = !params || params->textures;
    noc_status status = noc_stream_read_all(stream, parts->log, &lib.data, &lib.size);
    if (status)
        return status;
    char *folder = noc_strndup(path, (size_t)(base - path));
    lib.folder = (obj_folder){ .path = folder, .anywhere = params && params->allow_outside, .textures = textures };
    lib.main_name = noc_format(ROOT "%.*s.obj", (int)(dot ? dot - base : (ptrdiff_t)strlen(base)), base);
    obj_spread spread = { 0 };
    const mesh_target to = { .parts = parts,
                             .images = &lib.images,
                             .offset = offset,
                             .z_up = params && params->obj_up == NOC_OBJ_UP_Z,
                             .spread = &spread };
    plain_lines(&lib);
    status = folder && lib.main_name
                 ? obj_plain_materials(lib.data, lib.size, &lib.folder, textures ? &lib.images : NULL,
                                       noc_stream_budget(stream), parts->issues, name, parts->log)
                 : noc_no_memory(parts->log, path);
    if (!status)
        status = plain_text(&lib, offset, name, parts->log);
    if (!status && lib.faces) { /* Assimp refuses a file without any */
        status = read_obj(path, &lib, &to);
        if (!status)
            obj_check_up(&spread, to.z_up, path, parts->log);
    }
    obj_images_free(&lib.images);
    free(folder);
    free(lib.main_name);
    free(lib.missing);
    free(lib.data);
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
                                     .foreign = foreign };

#else

const noc_reader noc_reader_mesh = { .name = "OBJ",
                                     .reads = NOC_READS_MESH,
                                     .probe = probe,
                                     .missing = "OBJ files need Assimp, which this build is without" };

#endif
