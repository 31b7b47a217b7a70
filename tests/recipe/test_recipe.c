/* Recipes: what they say, and what is wrong with them. */
#include "../memory.h"

#include <math.h>
#include <nocturne/nocturne.h>
#include <sys/stat.h>

static char folder[] = "/tmp/nocturne-recipe-XXXXXX";
static char path[100], last_error[1000];
static int errors;

static void on_message(void *user, noc_log_level level, const char *text) {
    (void)user;
    if (level == NOC_LOG_ERROR) {
        errors++;
        snprintf(last_error, sizeof(last_error), "%s", text);
    }
}

static int make_folder(void **state) {
    (void)state;
    bool made = mkdtemp(folder) != NULL;
    snprintf(path, sizeof(path), "%s/city.yaml", folder);
    return !made;
}

static int remove_folder(void **state) {
    (void)state;
    unlink(path);
    return rmdir(folder);
}

static void write_recipe(const char *text, size_t size) {
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    assert_int_equal(fwrite(text, 1, size, f), size);
    assert_int_equal(fclose(f), 0);
}

static noc_status load(const char *text, noc_recipe **recipe) {
    write_recipe(text, strlen(text));
    errors = 0;
    *last_error = 0;
    noc_log_params params = noc_log_default_params();
    params.message = on_message;
    noc_log *log = noc_log_create(&params);
    noc_status status = noc_recipe_load(path, log, recipe);
    noc_log_destroy(log);
    return status;
}

static const noc_option *row(const noc_option *table, const char *name) {
    while (table->name && strcmp(table->name, name))
        table++;
    return table->name ? table : NULL;
}

static const char whole[] =
    "# a city\n"
    "nocturne: 1\n"
    "name: \"The town: at night\"\n"
    "inputs: [a.gml, /b/c.osm, 'builtin:mess', '@list', '@/list']\n"
    "crs: EPSG:25832\n"
    "preset: interactive\n"
    "sky: bortle:5\n"
    "jitter: off\n"
    "lights: 77\n"
    "lamps:\n"
    "  files: [l.csv, m.csv]\n"
    "  columns: 'height=H'\n"
    "  height: 8.5\n"
    "materials:\n"
    "  wall: { albedo: 0.5, roughness: 0.8 }\n"
    "  road: { albedo: [.1, .2, .3], f0: .05 }\n"
    "luminaires:\n"
    "  - { match: { LAMP: [HPS*, SON], watts: '>= 70 W' }, kelvin: 2050, profile: a/b.ies }\n"
    "  - tilt: 15\n"
    "    shape: sphere\n"
    "groups:\n"
    "  main: { match: { street: 'Main *' }, scale: 0.5 }\n"
    "  lamps: { on: off, colour: '#ff8000' }\n"
    "cameras:\n"
    "  near: { eye: [1, -2.5, 3], target: '4,5,6', crs: scene, fov: 70 }\n"
    "  far: { view: aerial }\n"
    "paths:\n"
    "  flight: { loop: on, keys: [{camera: near, fov: 20}, {view: street, seconds: 4, hour: 23},"
    " {eye: [1, 2, 3], target: [4, 5, 6], crs: scene, seconds: 9.5}] }\n"
    "  still: { keys: [{fov: 35, camera: far}] }\n";

static void test_all_that_it_says(void **state) {
    (void)state;
    noc_recipe *r;
    assert_int_equal(load(whole, &r), NOC_OK);
    assert_true(noc_recipe_is(path));
    const noc_recipe_info *info = noc_recipe_get_info(r);
    char expected[200];
    assert_string_equal(info->name, "The town: at night");
    assert_int_equal(info->input_count, 5);
    snprintf(expected, sizeof(expected), "%s/a.gml", folder);
    assert_string_equal(info->inputs[0], expected);
    assert_string_equal(info->inputs[1], "/b/c.osm");
    assert_string_equal(info->inputs[2], "builtin:mess");
    snprintf(expected, sizeof(expected), "@%s/list", folder);
    assert_string_equal(info->inputs[3], expected);
    assert_string_equal(info->inputs[4], "@/list");
    assert_true(info->has_preset && info->preset == NOC_PRESET_INTERACTIVE);

    noc_import_params import = noc_import_default_params();
    assert_int_equal(noc_recipe_set(r, row(noc_import_options(), "crs"), &import, NULL), NOC_OK);
    assert_int_equal(noc_recipe_set(r, row(noc_import_options(), "lamp-height"), &import, NULL), NOC_OK);
    import.lamps.count = 1; /* what was there is replaced */
    assert_int_equal(noc_recipe_set(r, row(noc_import_options(), "lamps"), &import, NULL), NOC_OK);
    assert_int_equal(noc_recipe_set(r, row(noc_import_options(), "lamp-columns"), &import, NULL), NOC_OK);
    assert_string_equal(import.crs, "EPSG:25832");
    assert_true(import.lamp_height == 8.5);
    assert_int_equal(import.lamps.count, 2);
    snprintf(expected, sizeof(expected), "%s/m.csv", folder);
    assert_string_equal(import.lamps.text[1], expected);
    assert_int_equal(import.lamp_columns.count, 1);
    assert_string_equal(import.lamp_columns.text[0], "height=H");
    noc_render_params render = noc_render_default_params();
    assert_int_equal(noc_recipe_set(r, row(noc_render_options(), "sky"), &render, NULL), NOC_OK);
    assert_int_equal(noc_recipe_set(r, row(noc_render_options(), "jitter"), &render, NULL), NOC_OK);
    assert_true(fabs(render.sky - 1.298446e-3) < 1e-8 && !render.jitter);
    noc_builtin_params builtin = noc_builtin_default_params();
    assert_int_equal(noc_recipe_set(r, row(noc_builtin_options(), "lights"), &builtin, NULL), NOC_OK);
    assert_int_equal(builtin.lights, 77);
    assert_int_equal(noc_recipe_set(r, row(noc_render_options(), "seed"), &render, NULL), NOC_ERR_ARGUMENT);
    size_t count = 0;
    while (noc_recipe_option(r, count))
        count++;
    assert_int_equal(count, 7);
    assert_ptr_equal(noc_recipe_option(r, 0), row(noc_import_options(), "crs"));

    assert_int_equal(info->material_count, 2);
    const noc_material *wall = &info->materials[0], *road = &info->materials[1];
    assert_true(wall->cls == NOC_CLASS_WALL && wall->albedo[2] == .5f && wall->roughness == .8f);
    assert_true(road->cls == NOC_CLASS_ROAD && road->albedo[1] == .2f && road->f0 == .05f);
    assert_true(road->roughness == noc_class_material(NOC_CLASS_ROAD).roughness);
    assert_int_equal(info->camera_count, 2);
    const noc_camera_params *near = &info->cameras[0].params, *far = &info->cameras[1].params;
    assert_string_equal(info->cameras[0].name, "near");
    assert_string_equal(near->eye, "1,-2.5,3");
    assert_string_equal(near->target, "4,5,6");
    assert_string_equal(near->crs, "scene");
    assert_true(near->fov == 70 && far->viewpoint == NOC_VIEWPOINT_AERIAL && !far->eye);
    assert_int_equal(info->path_count, 2);
    const noc_recipe_path *flight = &info->paths[0], *still = &info->paths[1];
    assert_true(!strcmp(flight->name, "flight") && flight->loop && flight->key_count == 3);
    assert_true(!strcmp(still->name, "still") && !still->loop && still->key_count == 1);
    const noc_path_key *keys = flight->keys;
    assert_string_equal(keys[0].camera.eye, "1,-2.5,3");
    assert_true(keys[0].camera.fov == 20 && keys[0].seconds < 0 && keys[0].hour < 0);
    assert_true(keys[1].camera.viewpoint == NOC_VIEWPOINT_STREET && keys[1].seconds == 4 && keys[1].hour == 23);
    assert_string_equal(keys[2].camera.target, "4,5,6");
    assert_string_equal(keys[2].camera.crs, "scene");
    assert_true(keys[2].seconds == 9.5 && keys[2].camera.fov == 0);
    assert_true(still->keys[0].camera.viewpoint == NOC_VIEWPOINT_AERIAL && still->keys[0].camera.fov == 35);
    noc_recipe_destroy(r);
}

static void test_rules_and_groups(void **state) {
    (void)state;
    noc_recipe *r;
    char place[200];
    noc_import_params params = noc_import_default_params();
    assert_int_equal(load(whole, &r), NOC_OK);
    noc_recipe_lists(r, &params);
    assert_true(params.luminaire_count == 2 && params.group_count == 2 && params.material_count == 2);
    const noc_luminaire_rule *a = &params.luminaires[0], *b = &params.luminaires[1];
    assert_int_equal(a->condition_count, 2);
    assert_string_equal(a->conditions[0].key, "LAMP");
    assert_string_equal(a->conditions[0].test, "HPS*|SON");
    assert_string_equal(a->conditions[1].test, ">= 70 W");
    assert_string_equal(a->profile, "a/b.ies");
    assert_memory_equal(a->profile_base, folder, strlen(folder));
    assert_string_equal(a->profile_base + strlen(folder), "/");
    snprintf(place, sizeof(place), "%s:18", path);
    assert_string_equal(a->place, place);
    assert_true(a->kelvin == 2050 && isnan(a->lumens) && isnan(a->tilt) && !a->shape && !a->heads && !a->colour);
    assert_true(b->tilt == 15 && b->shape == NOC_LAMP_SPHERE && !b->condition_count && isnan(b->kelvin));
    const noc_group_rule *main = &params.groups[0], *lamps = &params.groups[1];
    assert_string_equal(main->name, "main");
    assert_true(main->condition_count == 1 && main->scale == 0.5 && main->on && isnan(main->kelvin));
    assert_string_equal(lamps->colour, "#ff8000");
    assert_true(!lamps->on && !lamps->condition_count && lamps->scale == 1);
    noc_recipe_destroy(r);
}

/* Every row of the tables is a key, under its name or in a section, but for those of who reads. */
/* lumens is a number, or whose they are; written as it was read. */
static void test_whose_lumens(void **state) {
    (void)state;
    noc_recipe *r;
    noc_import_params params = noc_import_default_params();
    assert_int_equal(
        load("nocturne: 1\ninputs: [a]\nluminaires:\n- {lumens: file}\n- {lumens: lamp}\n- {lumens: 800}\n", &r),
        NOC_OK);
    noc_recipe_lists(r, &params);
    assert_int_equal(params.luminaire_count, 3);
    const noc_luminaire_rule *rules = params.luminaires;
    assert_true(rules[0].flux == NOC_FLUX_FILE && isnan(rules[0].lumens));
    assert_true(rules[1].flux == NOC_FLUX_LAMP && isnan(rules[1].lumens));
    assert_true(rules[2].flux == NOC_FLUX_ANY && rules[2].lumens == 800);
    char *text;
    const noc_recipe_info info = { .name = "n", .luminaires = rules, .luminaire_count = 3 };
    assert_int_equal(noc_recipe_write(&info, NULL, 0, NULL, &text), NOC_OK);
    assert_non_null(strstr(text, "- { lumens: \"file\" }\n  - { lumens: \"lamp\" }\n  - { lumens: \"800\" }\n"));
    free(text);
    noc_recipe_destroy(r);
}

static void test_every_option_is_a_key(void **state) {
    (void)state;
    const noc_option *tables[] = { noc_import_options(), noc_city_options(), noc_builtin_options(),
                                   noc_render_options(), noc_display_options() };
    noc_import_params import = noc_import_default_params();
    noc_builtin_params builtin = noc_builtin_default_params();
    noc_render_params render = noc_render_default_params();
    noc_display_params display = noc_display_default_params();
    const void *defaults[] = { &import, &builtin.city, &builtin, &render, &display };
    size_t keys = 0;
    for (size_t i = 0; i < 5; i++)
        for (const noc_option *o = tables[i]; o->name; o++) {
            char text[400], value[100];
            noc_option_get(o, defaults[i], value, sizeof(value));
            snprintf(text, sizeof(text), "nocturne: 1\ninputs: [a]\n%s: \"%s\"\n", o->name, *value ? value : "x");
            noc_recipe *r;
            noc_status status = load(text, &r);
            bool section = !strcmp(o->name, "lamps"), hosts = !strcmp(o->group, "Reading");
            if (section || hosts)
                assert_int_equal(status, NOC_ERR_FORMAT);
            else if (status || noc_recipe_option(r, 0) != o)
                fail_msg("%s: %s", o->name, last_error);
            keys += !status;
            noc_recipe_destroy(r);
        }
    assert_true(keys > 40);
}

/* A section has its prefix' options, all of its group, and may be switched as a whole. */
static void test_sections(void **state) {
    (void)state;
    static const char *const said[] = { "windows: off\n", "windows: {lit: 0.6}\n", "windows: {hour: 0.6}\n",
                                        "windows: {window-lit: 0.6}\n", "windows: {windows: off}\n" };
    static const char *const rows[] = { "windows", "window-lit", "hour", "window-lit", "windows" };
    for (size_t i = 0; i < 5; i++) {
        char text[100];
        noc_recipe *r;
        snprintf(text, sizeof(text), "nocturne: 1\ninputs: [a]\n%s", said[i]);
        assert_int_equal(load(text, &r), NOC_OK);
        assert_ptr_equal(noc_recipe_option(r, 0), row(noc_import_options(), rows[i]));
        assert_null(noc_recipe_option(r, 1));
        noc_recipe_destroy(r);
    }
}

static void assert_wrong(const char *text, noc_status expected, int line, const char *message) {
    noc_recipe *r = (noc_recipe *)text;
    noc_status status = load(text, &r);
    char place[200];
    snprintf(place, sizeof(place), line ? "%s:%d: " : "%s: ", path, line);
    if (status != expected || r || errors != 1 || strncmp(last_error, place, strlen(place)) ||
        !strstr(last_error, message))
        fail_msg("\"%s\": status %d, %d errors, \"%s\"", text, status, errors, last_error);
}

#define HEAD "nocturne: 1\ninputs: [a]\n"

/* One word is a road class, wherever a surface is given; what is written of it says the same again. */
static void test_road_classes_are_words(void **state) {
    noc_recipe *r = NULL;
    const noc_road_class *w3 = noc_road_classes() + 6, *r1 = noc_road_classes();
    assert_string_equal(w3->name, "W3");
    assert_int_equal(load(HEAD "materials: {road: W3, sidewalk: r1}\nmaterials-by-name: {slab: R1}\n", &r), NOC_OK);
    char *text = NULL;
    for (int time = 0; time < 2; time++) {
        const noc_recipe_info *info = noc_recipe_get_info(r);
        assert_true(info->material_count == 2 && info->named_material_count == 1);
        for (int i = 0; i < 3; i++) {
            const noc_road_class *want = i ? r1 : w3;
            const noc_named_material *named = &info->named_materials[0];
            const noc_material *m = &info->materials[i == 1];
            for (int k = 0; k < 3; k++)
                assert_true((i == 2 ? named->albedo : m->albedo)[k] == want->albedo);
            assert_true((i == 2 ? named->f0 : m->f0) == want->f0);
            assert_true((i == 2 ? named->roughness : m->roughness) == want->roughness);
        }
        if (!time)
            assert_int_equal(noc_recipe_write(info, NULL, 0, NULL, &text), NOC_OK);
        noc_recipe_destroy(r);
        if (!time)
            assert_int_equal(load(text, &r), NOC_OK);
    }
    free(text);
}

static const struct {
    const char *text;
    int line;
    const char *message;
} wrong[] = {
    { "", 0, "a recipe begins with" },
    { "- a\n", 1, "a recipe begins with" },
    { "inputs: [a]\nnocturne: 1\n", 1, "a recipe begins with" },
    { "nocturne: 2\n", 1, "reads recipes of version 1" },
    { "nocturne: 1\n", 0, "names no inputs" },
    { "nocturne: 1\ninputs: []\n", 0, "names no inputs" },
    { "nocturne: 1\ninputs: {a: b}\n", 2, "inputs is a list" },
    { "nocturne: 1\ninputs: [a, [b]]\n", 2, "inputs: entry 2 is no text" },
    { "nocturne: 1\ninputs: [a, '']\n", 2, "inputs: entry 2 is no text" },
    { HEAD "windows: {sky: 3}\n", 3, "no key sky in windows" },
    { HEAD "backend: vulkan\n", 3, "backend is the machine's and not a city's: pass --backend to the command" },
    { HEAD "windows: [1]\n", 3, "windows must be keys" },
    { HEAD "windows: maybe\n", 3, "neither true nor false" },
    { HEAD "lamps: off\n", 3, "lamps must be keys" },
    { HEAD "name: !!binary aGk=\n", 3, "the tag tag:yaml.org,2002:binary is not read" },
    { HEAD "cameras: {a: &a {view: own}, b: {<<: *a}}\n", 3, "merge keys (<<) are not read: write the keys out" },
    { HEAD "lod: 7\n", 3, "lod: \"7\" is outside 0 to 4" },
    { HEAD "lod: two\n", 3, "lod: \"two\" is not" },
    { HEAD "\n# remark\nwidht: 3\n", 5, "no key widht in a recipe; is it width?" },
    { HEAD "lamps:\n  hight: 3\n", 4, "no key hight in lamps; is it height?" },
    { HEAD "lamps: [a]\n", 3, "lamps must be keys and their values" },
    { HEAD "lamps: {height: 3, height: 4}\n", 3, "height is given twice" },
    { HEAD "lamp-height: 3\nlamps: {height: 4}\n", 4, "lamp-height is given twice" },
    { HEAD "isolate: false\n", 3, "--isolate on the command line" },
    { HEAD "lod: [1, 2]\n", 3, "lod is one value" },
    { HEAD "sky: [1, 2]\n", 3, "sky must be keys" },
    { HEAD "sky: bortle:10\n", 3, "is not bortle:1 to bortle:9" },
    { HEAD "sky: {zenith: sqm:9}\n", 3, "is not sqm:14 to sqm:25" },
    { HEAD "sky: {zenit: 1}\n", 3, "no key zenit in sky; is it zenith?" },
    { HEAD "sky: {zenith: 1}\nenvironment-scale: 2\nsky: 2\n", 5, "twice" },
    { HEAD "sky:\n", 3, "sky has no value" },
    { HEAD "name: [a]\n", 3, "name must be a text" },
    { HEAD "preset: fast\n", 3, "preset: \"fast\" is none of still|interactive" },
    { HEAD "materials: {wal: {f0: 0}}\n", 3, "is it wall?" },
    { HEAD "materials: {wall: {albdo: 0}}\n", 3, "no key albdo in a material; is it albedo?" },
    { HEAD "materials: {wall: {albedo: [1, 2]}}\n", 3, "a list of 3 numbers" },
    { HEAD "materials: {wall: {albedo: [1, 0, x]}}\n", 3, "entry 3 is no number" },
    { HEAD "materials: {wall: {albedo: 1.5}}\n", 3, "albedo, f0 and metalness are 0 to 1" },
    { HEAD "materials: {wall: {roughness: 0}}\n", 3, "roughness .05 to 1" },
    { HEAD "materials: {road: R5}\n", 3, "(R1, R2, R3, R4, W1, W2, W3, W4), not \"R5\"" },
    { HEAD "materials-by-name: {asphalt: }\n", 3, "a class of road surfaces" },
    { HEAD "luminaires: {kelvin: 3}\n", 3, "luminaires is a list of rules" },
    { HEAD "luminaires:\n- {kelvin: 3000}\n- {kelwin: 3}\n", 5, "no key kelwin in a luminaire; is it kelvin?" },
    { HEAD "luminaires:\n- {kelvin: 3}\n", 4, "outside 1000 to 25000" },
    { HEAD "luminaires:\n- {kelvin: [3]}\n", 4, "kelvin is one value" },
    { HEAD "luminaires:\n- {kelvin: }\n", 4, "kelvin has no value" },
    { HEAD "luminaires:\n- {lumens: files}\n", 4, "lumens" },
    { HEAD "luminaires:\n- {shape: cube}\n", 4, "none of fitting|point|sphere|disc" },
    { HEAD "luminaires:\n- [a]\n", 4, "a luminaire must be keys and their values" },
    { HEAD "luminaires:\n- {match: [a]}\n", 4, "match must be keys and their values" },
    { HEAD "luminaires:\n- match:\n    a: {b: c}\n", 5, "match a is one value, or a list" },
    { HEAD "luminaires:\n- match:\n    a: []\n", 5, "match a is an empty list" },
    { HEAD "luminaires:\n- match:\n    a: x\n    b: 'y[z'\n", 6, "match b: \"y[z\" has a [ without its ]" },
    { HEAD "luminaires:\n- match: {a: '>= much'}\n", 4, "is no number" },
    { HEAD "luminaires:\n- match: {a: 'x||y'}\n", 4, "a pattern of no characters" },
    { HEAD "luminaires:\n- match: {a: }\n", 4, "a has no value" },
    { HEAD "luminaires:\n- match: {'tag:': x}\n", 4, "has no key" },
    { HEAD "luminaires:\n- match: {street: '> 3'}\n", 4, "is asked for a number" },
    { HEAD "groups: [a]\n", 3, "groups must be keys" },
    { HEAD "groups: {a: {scale: -1}}\n", 3, "scale: \"-1\" is outside" },
    { HEAD "groups: {a: {dim: 1}}\n", 3, "no key dim in a group" },
    { HEAD "groups: {a: {on: maybe}}\n", 3, "neither true nor false" },
    { HEAD "groups: {a=b: {on: off}}\n", 3, "no = and no comma" },
    { HEAD "groups: {a: {}, a: {}}\n", 3, "a is given twice" },
    { HEAD "cameras: {a: {eye: [1, 2], target: [1, 2, 3]}}\n", 3, "is not X, Y, Z" },
    { HEAD "cameras: {a: {eye: [1, 2, 3]}}\n", 3, "eye and target go together" },
    { HEAD "cameras: {a: {eye: [1, 2, 3], target: '1.0,2,3'}}\n", 3, "camera a: eye and target are the same place" },
    { HEAD "cameras: {a: {fov: 500}}\n", 3, "outside 1 to 170" },
    { HEAD "cameras: {a: {camera-crs: x}}\n", 3, "no key camera-crs in a camera" },
    { HEAD "paths: {a: {keys: []}}\n", 3, "1 to 10000 keys, not 0" },
    { HEAD "paths: {a: {loop: on}}\n", 3, "path a has no keys" },
    { HEAD "paths: {a: [{view: own}]}\n", 3, "a path must be keys" },
    { HEAD "paths: {a: {keys: {view: own}}}\n", 3, "keys is a list of cameras" },
    { HEAD "paths: {a: {keys: [own]}}\n", 3, "a key of a path must be keys" },
    { HEAD "paths: {a: {loop: maybe, keys: [{view: own}]}}\n", 3, "neither true nor false" },
    { HEAD "paths: {a: {kyes: [{view: own}]}}\n", 3, "is it keys?" },
    { HEAD "paths:\n  a:\n    keys:\n    - {seconds: 3}\n", 6, "a camera, a view, or an eye" },
    { HEAD "paths:\n  a:\n    keys:\n    - {camera: b}\n", 6, "has no camera b" },
    { HEAD "cameras: {b: {view: own}}\npaths: {a: {keys: [{camera: b, view: own}]}}\n", 4, "a camera, a view, or" },
    { HEAD "paths: {a: {keys: [{eye: [1, 2, 3]}]}}\n", 3, "eye and target go together" },
    { HEAD "paths: {a: {keys: [{eye: [1, 2, 3], target: [1, 2, 3]}]}}\n", 3, "eye and target are the same place" },
    { HEAD "paths: {a: {keys: [{view: own, time: 3}]}}\n", 3, "no key time in a key of a path" },
    { HEAD "paths: {a: {keys: [{view: own, seconds: -1}]}}\n", 3, "seconds: \"-1\" is outside 0 to" },
    { HEAD "paths: {a: {keys: [{view: own, hour: 25}]}}\n", 3, "hour: \"25\" is outside 0 to 24" },
    { HEAD "paths: {a: {keys: [{view: own, seconds: 3},\n {view: own, seconds: 3}]}}\n", 4, "must grow" },
    { HEAD "paths: {a: {keys: [{view: own},\n {view: own, seconds: 0}]}}\n", 4, "must grow" },
    { HEAD "paths: {a: {keys: [{view: own, seconds: 3},\n {view: own}]}}\n", 4, "all keys of a path tell" },
    { HEAD "paths: {a: {keys: [{view: own}, {view: own},\n {view: own, seconds: 1}]}}\n", 4, "all keys of a path" },
    { HEAD "a: [1\n", 4, "is no YAML" },
    { HEAD "crs: *nothing\n", 3, "is no YAML" },
    { HEAD "? [a, b]\n: c\n", 3, "is no text" },
    { HEAD "---\nnocturne: 1\n", 0, "a second document" },
    { HEAD "crs: \"a\\0b\"\n", 3, "crs has no value" },
};

static void test_what_is_wrong_is_told_with_its_line(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof(wrong) / sizeof(*wrong); i++)
        assert_wrong(wrong[i].text, NOC_ERR_FORMAT, wrong[i].line, wrong[i].message);
}

static void test_files_that_cannot_be_read(void **state) {
    (void)state;
    noc_recipe *r;
    noc_log *log = noc_log_create(NULL);
    assert_int_equal(noc_recipe_load("/nowhere/city.yaml", log, &r), NOC_ERR_IO);
    assert_int_equal(noc_recipe_load(folder, log, &r), NOC_ERR_IO);
    assert_null(r);
    assert_false(noc_recipe_is("/nowhere/city.yaml"));
    assert_false(noc_recipe_is(folder));
    assert_int_equal(noc_recipe_load(NULL, log, &r), NOC_ERR_ARGUMENT);
    assert_int_equal(noc_recipe_load(path, log, NULL), NOC_ERR_ARGUMENT);
    assert_int_equal(noc_recipe_get_info(NULL)->input_count, 0);
    assert_null(noc_recipe_option(NULL, 0));
    char *large = calloc(1, 1100000);
    memset(large, '#', 1100000);
    write_recipe(large, 1100000);
    free(large);
    assert_int_equal(noc_recipe_load(path, log, &r), NOC_ERR_FORMAT);
    assert_non_null(strstr(noc_log_last_error(log), "1048576 bytes"));
    write_recipe("\xff\xfe\x01", 3);
    assert_int_equal(noc_recipe_load(path, log, &r), NOC_ERR_FORMAT);
    noc_log_destroy(log);
}

static void test_a_recipe_is_known_by_its_first_key(void **state) {
    (void)state;
    static const char *const ours[] = { "nocturne: 1", "\n# x\n\n---\nnocturne : 1\n", "\xef\xbb\xbfnocturne: 1",
                                        "%YAML 1.1\n---\nnocturne: 1\n" };
    static const char *const others[] = { "", "#", "nocturnes: 1", "a: 1\nnocturne: 1\n", "{\"nocturne\": 1}", "\n\n" };
    for (size_t i = 0; i < 4; i++) {
        write_recipe(ours[i], strlen(ours[i]));
        assert_true(noc_recipe_is(path));
    }
    for (size_t i = 0; i < 6; i++) {
        write_recipe(others[i], strlen(others[i]));
        assert_false(noc_recipe_is(path));
    }
}

/* Anchors that stand for each other ten times each are a billion texts, if one writes them all. */
static void test_a_bomb_is_an_error_at_once(void **state) {
    (void)state;
    noc_recipe *r;
    char text[2000] = "nocturne: 1\ninputs: [x]\na0: &a0 [x]\n";
    for (int i = 1; i < 10; i++)
        snprintf(text + strlen(text), sizeof(text) - strlen(text), "a%d: &a%d [*a%d, *a%d, *a%d, *a%d, *a%d]\n", i, i,
                 i - 1, i - 1, i - 1, i - 1, i - 1);
    assert_int_equal(load(text, &r), NOC_ERR_FORMAT);
    size_t room = 1000000, n = 0;
    char *many = malloc(room);
    n += (size_t)snprintf(many, room, "nocturne: 1\ninputs: [x]\ncameras: {");
    for (int i = 0; i < 60000; i++) /* quick, however many there are: keys are hashed */
        n += (size_t)snprintf(many + n, room - n, "%x: {},", i);
    snprintf(many + n, room - n, "}\n");
    assert_int_equal(load(many, &r), NOC_OK);
    assert_int_equal(noc_recipe_get_info(r)->camera_count, 60000);
    noc_recipe_destroy(r);
    free(many);
    char *deep = malloc(200002);
    memset(deep, '[', 200000);
    memcpy(deep + 200000, "\n", 2);
    memcpy(deep, "nocturne: ", 10);
    assert_int_equal(load(deep, &r), NOC_ERR_FORMAT);
    assert_int_equal(errors, 1);
    free(deep);
}

/* 2,000 tests that groups repeat by an alias: 4 groups may, 400 may not. */
static void test_aliases_are_counted(void **state) {
    (void)state;
    enum { ROOM = 200000, TESTS = 2000 };
    noc_recipe *r;
    char *text = malloc(ROOM);
    for (int groups = 4; groups <= 400; groups += 396) {
        size_t n = (size_t)snprintf(text, ROOM, "nocturne: 1\ninputs: [x]\ngroups:\n  g0: { match: &m { k: x");
        for (int i = 1; i < TESTS; i++)
            n += (size_t)snprintf(text + n, ROOM - n, ", k%d: x", i);
        n += (size_t)snprintf(text + n, ROOM - n, " } }\n");
        for (int i = 1; i < groups; i++)
            n += (size_t)snprintf(text + n, ROOM - n, "  g%d: { match: *m }\n", i);
        assert_int_equal(load(text, &r), groups == 4 ? NOC_OK : NOC_ERR_FORMAT);
        assert_int_equal(strstr(last_error, "its aliases (*) repeat more than 4194304 bytes") != NULL, groups == 400);
        noc_recipe_destroy(r);
    }
    free(text);
}

/* libyaml takes time by the square of their number: 110,000 of them took 28 s. */
static void test_anchors_are_limited(void **state) {
    (void)state;
    enum { ROOM = 40000 };
    noc_recipe *r;
    char *text = malloc(ROOM);
    for (int anchors = 1000; anchors <= 1001; anchors++) {
        size_t n = (size_t)snprintf(text, ROOM, "nocturne: 1\ninputs:\n");
        for (int i = 0; i < anchors; i++)
            n += (size_t)snprintf(text + n, ROOM - n, "  - &a%d x\n", i);
        assert_int_equal(load(text, &r), anchors == 1000 ? NOC_OK : NOC_ERR_FORMAT);
        if (anchors > 1000)
            assert_non_null(strstr(last_error, ":1003: more than 1000 anchors"));
        noc_recipe_destroy(r);
    }
    free(text);
}

static void test_memory_refused(void **state) {
    (void)state;
    noc_log *log = counting_log();
    write_recipe(whole, strlen(whole));
    bool reached;
    FOR_EACH_REFUSAL(reached) {
        noc_recipe *r;
        begin_refusal(n, later);
        noc_status status = noc_recipe_load(path, log, &r);
        reached = end_refusal();
        if (status)
            assert_refused(status, "recipe");
        else
            assert_unharmed(noc_recipe_get_info(r)->path_count == 2, "recipe");
        assert_true(!r == (status != NOC_OK) && (status == NOC_OK || reached));
        noc_recipe_destroy(r);
    }
    noc_log_destroy(log);
}

/* What is written is read back, tests/viewer holds; here what cannot be. */
static void test_writing_refused(void **state) {
    const noc_recipe_camera camera = { "a", noc_camera_default_params() };
    const noc_path_key key = noc_path_key_default();
    const noc_recipe_path way = { "b", true, 1, &key };
    const noc_material wall = noc_class_material(NOC_CLASS_WALL);
    const noc_named_material named = { "c", { -1, -1, -1 }, -1, .3f, -1 };
    const noc_condition condition = { "source", "LED" };
    noc_luminaire_rule rule = noc_luminaire_default_rule();
    noc_group_rule group = noc_group_default_rule();
    const char *const inputs[] = { "builtin:city" }, *const texts[] = { "on" };
    const noc_recipe_value value = { noc_import_options(), texts, 1 };
    noc_recipe_info info = { .name = "n",
                             .inputs = inputs,
                             .input_count = 1,
                             .cameras = &camera,
                             .camera_count = 1,
                             .paths = &way,
                             .path_count = 1,
                             .materials = &wall,
                             .material_count = 1,
                             .named_materials = &named,
                             .named_material_count = 1,
                             .luminaires = &rule,
                             .luminaire_count = 1,
                             .groups = &group,
                             .group_count = 1,
                             .has_preset = true };
    rule.conditions = &condition;
    rule.condition_count = 1;
    rule.profile = "a.ies";
    rule.profile_base = "folder/";
    group.name = "g";
    noc_log *log = counting_log();
    char *text;
    bool reached;
    FOR_EACH_REFUSAL(reached) {
        begin_refusal(n, later);
        noc_status status = noc_recipe_write(&info, &value, 1, log, &text);
        reached = end_refusal();
        if (status)
            assert_refused(status, "a recipe that is written");
        assert_true(!text == (status != NOC_OK));
        if (text)
            assert_non_null(strstr(text, "profile: \"folder/a.ies\""));
        free(text);
    }
    info.name = "\xff";
    assert_int_equal(noc_recipe_write(&info, &value, 1, log, &text), NOC_ERR_FORMAT);
    assert_null(text);
    assert_non_null(strstr(noc_log_last_error(log), "UTF-8"));
    noc_log_destroy(log);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_all_that_it_says),
        cmocka_unit_test(test_rules_and_groups),
        cmocka_unit_test(test_whose_lumens),
        cmocka_unit_test(test_every_option_is_a_key),
        cmocka_unit_test(test_sections),
        cmocka_unit_test(test_road_classes_are_words),
        cmocka_unit_test(test_what_is_wrong_is_told_with_its_line),
        cmocka_unit_test(test_files_that_cannot_be_read),
        cmocka_unit_test(test_a_recipe_is_known_by_its_first_key),
        cmocka_unit_test(test_a_bomb_is_an_error_at_once),
        cmocka_unit_test(test_aliases_are_counted),
        cmocka_unit_test(test_anchors_are_limited),
        cmocka_unit_test(test_memory_refused),
        cmocka_unit_test(test_writing_refused),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
