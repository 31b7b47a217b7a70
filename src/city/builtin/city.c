/* The built-in night city: noc_scene_add_city, and the streets of the cityscape. See town.h for how it is made. */
#include "city/city.h"
#include "city/builtin/town.h"

#include <math.h>
#include <nocturne/option.h>

#define BELT 20.0 /* of trees around the city, m; also room for the warp */

static int add_material(town *t, noc_class cls, float r, float g, float b, float f0, float roughness) {
    noc_material m = { .albedo = { r, g, b }, .f0 = f0, .roughness = roughness, .cls = cls };
    int index = noc_scene_add_material(t->scene, &m);
    t->failed = t->failed || index < 0;
    return index;
}

/* Reflectances of dry materials; renders and paints between 0.25 and 0.65, as on real fronts. */
static void add_materials(town *t) {
    static const struct {
        town_mat mat;
        noc_class cls;
        float r, g, b, f0, roughness;
    } table[] = {
        { TM_WALL, NOC_CLASS_WALL, .60f, .53f, .42f, 0, 1 },
        { TM_WALL + 1, NOC_CLASS_WALL, .60f, .52f, .38f, 0, 1 },
        { TM_WALL + 2, NOC_CLASS_WALL, .62f, .58f, .52f, 0, 1 },
        { TM_WALL + 3, NOC_CLASS_WALL, .56f, .45f, .36f, 0, 1 },
        { TM_WALL + 4, NOC_CLASS_WALL, .33f, .17f, .12f, 0, 1 },
        { TM_WALL + 5, NOC_CLASS_WALL, .46f, .48f, .46f, 0, 1 },
        { TM_WALL + 6, NOC_CLASS_WALL, .58f, .50f, .34f, 0, 1 },
        { TM_WALL + 7, NOC_CLASS_WALL, .46f, .52f, .45f, 0, 1 },
        { TM_WALL + 8, NOC_CLASS_WALL, .64f, .60f, .55f, 0, 1 },
        { TM_WALL + 9, NOC_CLASS_WALL, .50f, .54f, .60f, 0, 1 },
        { TM_TILES, NOC_CLASS_ROOF, .30f, .13f, .08f, .02f, .7f },
        { TM_TILES_DARK, NOC_CLASS_ROOF, .19f, .11f, .09f, .02f, .7f },
        { TM_SLATE, NOC_CLASS_ROOF, .11f, .12f, .14f, .04f, .45f },
        { TM_COPPER, NOC_CLASS_ROOF, .20f, .35f, .28f, .05f, .5f },
        { TM_FLAT_ROOF, NOC_CLASS_ROOF, .20f, .20f, .20f, 0, 1 },
        { TM_STONE, NOC_CLASS_WALL, .56f, .53f, .48f, 0, 1 },
        { TM_CONCRETE, NOC_CLASS_WALL, .50f, .47f, .41f, 0, 1 },
        { TM_METAL, NOC_CLASS_WALL, .16f, .17f, .19f, .08f, .35f },
        { TM_GLASS, NOC_CLASS_WINDOW, .04f, .05f, .06f, .06f, .12f },
        { TM_FRAME, NOC_CLASS_INSTALLATION, .58f, .57f, .54f, 0, 1 },
        { TM_DOOR, NOC_CLASS_DOOR, .20f, .12f, .07f, .04f, .5f },
        { TM_SHOP, NOC_CLASS_OTHER, .62f, .60f, .56f, 0, 1 },
        { TM_SHOP_DARK, NOC_CLASS_DOOR, .04f, .05f, .06f, .06f, .12f },
        { TM_SHOP_FLOOR, NOC_CLASS_OTHER, .34f, .28f, .21f, .04f, .4f },
        { TM_AWNING, NOC_CLASS_INSTALLATION, .50f, .10f, .08f, 0, 1 },
        { TM_AWNING + 1, NOC_CLASS_INSTALLATION, .10f, .26f, .34f, 0, 1 },
        { TM_AWNING + 2, NOC_CLASS_INSTALLATION, .62f, .55f, .38f, 0, 1 },
        { TM_ROAD, NOC_CLASS_ROAD, .073f, .073f, .077f, .04f, .8f },
        { TM_MARKING, NOC_CLASS_ROAD, .55f, .55f, .52f, .03f, .6f },
        { TM_SIDEWALK, NOC_CLASS_SIDEWALK, .25f, .24f, .22f, .02f, .7f },
        { TM_KERBSTONE, NOC_CLASS_SIDEWALK, .38f, .37f, .35f, 0, 1 },
        { TM_PAVING, NOC_CLASS_SIDEWALK, .30f, .27f, .23f, .03f, .55f },
        { TM_GRAVEL, NOC_CLASS_SIDEWALK, .40f, .35f, .27f, 0, 1 },
        { TM_LAWN, NOC_CLASS_GREEN, .08f, .14f, .045f, 0, 1 },
        { TM_WATER, NOC_CLASS_WATER, .015f, .022f, .026f, .03f, .16f },
        { TM_QUAY, NOC_CLASS_BRIDGE, .34f, .32f, .28f, 0, 1 },
        { TM_BRIDGE, NOC_CLASS_BRIDGE, .38f, .35f, .30f, 0, 1 },
        { TM_TRUNK, NOC_CLASS_TREE, .14f, .10f, .07f, 0, 1 },
        { TM_LEAF, NOC_CLASS_TREE, .075f, .13f, .035f, 0, 1 },
        { TM_LEAF + 1, NOC_CLASS_TREE, .10f, .15f, .04f, 0, 1 },
        { TM_LEAF + 2, NOC_CLASS_TREE, .06f, .11f, .045f, 0, 1 },
        { TM_LEAF + 3, NOC_CLASS_TREE, .13f, .13f, .04f, 0, 1 },
        { TM_POLE, NOC_CLASS_LAMP, .10f, .11f, .11f, .04f, .4f },
        { TM_WOOD, NOC_CLASS_FURNITURE, .30f, .19f, .10f, .03f, .6f },
        { TM_CAR, NOC_CLASS_VEHICLE, .45f, .45f, .46f, .05f, .2f },
        { TM_CAR + 1, NOC_CLASS_VEHICLE, .03f, .03f, .035f, .06f, .15f },
        { TM_CAR + 2, NOC_CLASS_VEHICLE, .30f, .03f, .03f, .05f, .2f },
        { TM_CAR + 3, NOC_CLASS_VEHICLE, .05f, .09f, .24f, .05f, .2f },
        { TM_CAR + 4, NOC_CLASS_VEHICLE, .62f, .62f, .60f, .05f, .2f },
        { TM_CAR + 5, NOC_CLASS_VEHICLE, .16f, .17f, .18f, .06f, .2f },
        { TM_CAR_GLASS, NOC_CLASS_VEHICLE, .02f, .02f, .025f, .06f, .1f },
        { TM_TYRE, NOC_CLASS_VEHICLE, .03f, .03f, .03f, 0, 1 },
    };
    _Static_assert(NOC_COUNT(table) == TM_COUNT, "every surface has a material");
    for (size_t i = 0; i < NOC_COUNT(table); i++)
        t->material[table[i].mat] =
            add_material(t, table[i].cls, table[i].r, table[i].g, table[i].b, table[i].f0, table[i].roughness);
    static const double kelvin[] = {
        [LIGHT_SODIUM] = 2080,  [LIGHT_CANDLE] = 2350, [LIGHT_WARM] = 2750,  [LIGHT_WHITE] = 3400,
        [LIGHT_NEUTRAL] = 4100, [LIGHT_COOL] = 5500,   [LIGHT_SCREEN] = 8500
    };
    for (size_t i = 0; i < NOC_COUNT(kelvin); i++)
        noc_kelvin_rgb(kelvin[i], t->white[i]);
}

/* Divides one axis into blocks of uneven width and the streets between them. */
static void axis_make(town *t, int axis, bool river) {
    double total = 2 * t->half, width[TOWN_BLOCKS_MOST], sum = 0, streets = 18,
           river_width = 2 * (TOWN_QUAY_STREET + TOWN_PROMENADE) + 34;
    int n = NOC_CLAMP((int)((total - (river ? river_width : 0)) / 74), 1, TOWN_BLOCKS_MOST);
    town_rng rng = { town_hash(t->params.seed, 40u + (uint32_t)axis) };
    town_gap gap[TOWN_BLOCKS_MOST + 1] = { 0 };
    for (int i = 0; i < n; i++) {
        width[i] = town_range(&rng, 0.76, 1.24);
        sum += width[i];
    }
    for (int i = 1; i < n; i++) {
        gap[i].river = river && i == (n + 1) / 2;
        gap[i].kind = gap[i].river ? WAY_QUAY : (axis == 0 ? i % 2 == 1 : i % 3 == 1) ? WAY_AVENUE : WAY_SIDE;
        gap[i].hi = gap[i].river ? river_width : gap[i].kind == WAY_AVENUE ? 15 : 8.5; /* width for now */
        streets += gap[i].hi;
    }
    double x = -t->half;
    for (int i = 0; i <= n; i++) {
        bool rim = i == 0 || i == n;
        double w = rim ? 9 : gap[i].hi; /* a ring road */
        t->axis[axis].gaps.data[t->axis[axis].gaps.len++] =
            (town_gap){ .lo = x, .hi = x + w, .kind = rim ? WAY_QUAY : gap[i].kind, .river = gap[i].river };
        x += w + (i < n ? width[i] / sum * (total - streets) : 0);
    }
}

typedef enum role { ROLE_HOUSES, ROLE_PARK, ROLE_SQUARE, ROLE_TOWERS } role;

/* What a cell of the plan is for. Every five by four blocks have a park, a square and a pair of towers of their own. */
static role role_of(const town *t, int i, int j) {
    int nx = (int)t->axis[0].gaps.len - 1, ny = (int)t->axis[1].gaps.len - 1;
    if (nx < 3 || ny < 3)
        return nx * ny > 1 && i == 0 && j == 0 ? ROLE_SQUARE : ROLE_HOUSES;
    int a = i % 5, b = j % 4;
    if (a == 2 && b == 1)
        return ROLE_SQUARE;
    if (a == 1 && b == 2)
        return ROLE_PARK;
    if ((a == 3 && b == 3) || (a == 3 && b == 2))
        return ROLE_TOWERS;
    return ROLE_HOUSES;
}

static town_poly cell_poly(const town *t, int i, int j) {
    const town_gap *w = &t->axis[0].gaps.data[i], *e = w + 1, *s = &t->axis[1].gaps.data[j], *n = s + 1;
    return (town_poly){ 4,
                        { { w->hi, s->hi }, { e->lo, s->hi }, { e->lo, n->lo }, { w->hi, n->lo } },
                        { s->kind, e->kind, n->kind, w->kind } };
}

/* The raised pavement of a block and its kerb. */
static void pavement(town *t, const town_poly *block, int id) {
    vec2 middle = town_warp(t, town_poly_centre(block));
    for (int i = 0; i < block->n; i++) {
        town_wall e = town_wall_make(block->p[i], block->p[(i + 1) % block->n]);
        int pieces = NOC_MAX((int)(e.length / 8), 1);
        for (int k = 0; k < pieces; k++) {
            double p[3], q[3];
            town_wall_point(&e, e.length * k / pieces, 0, 0, p);
            town_wall_point(&e, e.length * (k + 1) / pieces, 0, 0, q);
            vec2 c[3] = { middle, town_warp(t, (vec2){ p[0], p[1] }), town_warp(t, (vec2){ q[0], q[1] }) };
            town_wall kerb = town_wall_make(c[1], c[2]);
            town_flat(t, TM_SIDEWALK, c, 3, TOWN_KERB);
            town_wall_rect(t, TM_KERBSTONE, &kerb, 0, kerb.length, -0.02, TOWN_KERB, 0);
        }
    }
    town_flush(t, "block %d/pavement", id);
}

/* Corners cut short by the slanting avenue leave edges too short for a house: those become a point. */
static void merge_short_edges(town_poly *poly, double least) {
    for (int i = 0; i < poly->n && poly->n > 3;) {
        int j = (i + 1) % poly->n;
        if (town_wall_make(poly->p[i], poly->p[j]).length >= least) {
            i++;
            continue;
        }
        poly->p[i] = (vec2){ 0.5 * (poly->p[i].x + poly->p[j].x), 0.5 * (poly->p[i].y + poly->p[j].y) };
        poly->way[i] = poly->way[j];
        for (int k = j; k + 1 < poly->n; k++) {
            poly->p[k] = poly->p[k + 1];
            poly->way[k] = poly->way[k + 1];
        }
        poly->n--;
        i = 0;
    }
}

/* Two slabs of different height on a lawn. */
static void towers(town *t, const town_poly *line, int id) {
    double d[4] = { 3.5, 3.5, 3.5, 3.5 };
    town_poly green = town_poly_inset(line, d);
    town_courtyard(t, &green, id);
    town_tower(t, line, id, id & 1);
    for (int i = 0; i < green.n; i++)
        for (int k = 1; k < 6; k++) {
            vec2 a = green.p[i], b = green.p[(i + 1) % green.n];
            double f = (k + 0.35 * ((i + k) % 3)) / 6.4;
            town_tree(t, town_warp(t, (vec2){ a.x + (b.x - a.x) * f, a.y + (b.y - a.y) * f }), TOWN_KERB, 8.5, 70,
                      town_hash(t->params.seed, (uint32_t)(id * 512 + i * 16 + k)));
        }
    town_flush(t, "block %d/trees", id);
}

static void block_build(town *t, const town_poly *block, role r, int id) {
    static const double sidewalk[4] = { [WAY_NONE] = 1, [WAY_SIDE] = 3.2, [WAY_AVENUE] = 5.0, [WAY_QUAY] = 3.8 };
    if (block->n < 3 || town_poly_area(block) < 40)
        return;
    pavement(t, block, id);
    town_poly line = town_poly_inset(block, sidewalk);
    double area = line.n ? town_poly_area(&line) : 0, depth = 12.6;
    if (r == ROLE_PARK)
        town_park(t, block, id);
    else if (r == ROLE_SQUARE)
        town_square(t, block, id);
    else if (r == ROLE_TOWERS && area > 1400) {
        towers(t, &line, id);
    } else {
        merge_short_edges(&line, 11);
        while (depth > 7 && !town_perimeter_fits(&line, depth))
            depth -= 1.5;
        if (line.n && town_perimeter_fits(&line, depth)) {
            double d[4] = { depth, depth, depth, depth };
            town_poly yard = town_poly_inset(&line, d);
            town_perimeter(t, &line, depth, id);
            town_courtyard(t, &yard, id);
        } else if (area > 110) {
            town_solid(t, &line, id);
        } else {
            town_plaza(t, block, id);
        }
    }
    town_kerbside(t, block, id);
}

/* The slanting avenue runs through the houses south of the river. */
static bool cut_by_diagonal(const town *t, int i, int j) {
    for (int k = 0; k <= j; k++)
        if (t->axis[1].gaps.data[k].river)
            return false;
    return role_of(t, i, j) == ROLE_HOUSES && t->axis[1].gaps.len >= 4;
}

static void cell_build(town *t, int i, int j, int *id) {
    town_poly whole = cell_poly(t, i, j), right, left;
    role r = role_of(t, i, j);
    vec2 a, d;
    double w;
    town_diagonal(t, &a, &d, &w);
    if (!cut_by_diagonal(t, i, j)) {
        block_build(t, &whole, r, (*id)++);
        return;
    }
    left = right = whole;
    town_poly_clip(&left, (vec2){ a.x - w * d.y, a.y + w * d.x }, d, WAY_AVENUE);
    town_poly_clip(&right, (vec2){ a.x + w * d.y, a.y - w * d.x }, (vec2){ -d.x, -d.y }, WAY_AVENUE);
    block_build(t, &left, r, (*id)++);
    block_build(t, &right, r, (*id)++);
}

/* Dashes along the slanting avenue, between the streets it crosses and outside the places it does not enter. */
static void diagonal_markings(town *t) {
    vec2 a, d;
    double w;
    town_diagonal(t, &a, &d, &w);
    for (double s = -3 * t->half; s < 3 * t->half; s += 7) {
        vec2 p = { a.x + s * d.x, a.y + s * d.y }, c[4];
        for (int j = 0; j + 1 < (int)t->axis[1].gaps.len; j++)
            for (int i = 0; i + 1 < (int)t->axis[0].gaps.len; i++) {
                town_poly cell = cell_poly(t, i, j);
                bool inside =
                    p.x > cell.p[0].x + 3 && p.x < cell.p[2].x - 3 && p.y > cell.p[0].y + 3 && p.y < cell.p[2].y - 3;
                if (!inside || !cut_by_diagonal(t, i, j))
                    continue;
                town_rect(p, d, 1.5, 0.07, c);
                for (int k = 0; k < 4; k++)
                    c[k] = town_warp(t, c[k]);
                town_flat(t, TM_MARKING, c, 4, 0.004);
            }
    }
    town_flush(t, "road markings");
}

/* Lawn and trees from the rim of the plan to the edge of the square that the city covers. */
static void belt(town *t) {
    double h = t->half, edge = 0.5 * t->params.size;
    int n = NOC_MAX((int)(2 * h / 12), 4);
    town_rng rng = { town_hash(t->params.seed, 60) };
    for (int side = 0; side < 4; side++)
        for (int i = 0; i < n; i++) {
            vec2 q[4], out[2];
            for (int k = 0; k < 2; k++) {
                double f = 2.0 * (i + k) / n - 1;
                vec2 in = side == 0   ? (vec2){ f * h, -h }
                          : side == 1 ? (vec2){ h, f * h }
                          : side == 2 ? (vec2){ -f * h, h }
                                      : (vec2){ -h, -f * h };
                q[k ? 2 : 3] = town_warp(t, in);
                out[k] = (vec2){ in.x / h * edge, in.y / h * edge };
            }
            q[0] = out[0];
            q[1] = out[1];
            town_flat(t, TM_LAWN, q, 4, 0.05);
            if (i % 2) { /* across the ring road, so that its fronts are lit */
                town_wall rim = town_wall_make(q[3], q[2]);
                town_globe_lamp(t, (vec2){ q[3].x + 1.2 * rim.out.x, q[3].y + 1.2 * rim.out.y }, 0.05, LIGHT_NEUTRAL);
            }
            for (int k = 0; k < 2; k++) {
                double f = town_range(&rng, 0.35, 0.9), g = town_next(&rng);
                vec2 a = { q[3].x + f * (q[0].x - q[3].x), q[3].y + f * (q[0].y - q[3].y) };
                vec2 b = { q[2].x + f * (q[1].x - q[2].x), q[2].y + f * (q[1].y - q[2].y) };
                town_tree(t, (vec2){ a.x + g * (b.x - a.x), a.y + g * (b.y - a.y) }, 0.05, 9, 70,
                          town_hash(rng.state, 4));
            }
        }
    town_flush(t, "belt");
}

void town_plan(town *t, const noc_city_params *params) {
    t->params = *params;
    t->half = 0.5 * params->size - BELT;
    axis_make(t, 0, false);
    axis_make(t, 1, t->half > 120);
}

noc_status town_build(noc_scene *scene, const noc_city_params *params, const town_style *style) {
    if (noc_option_check(noc_city_options(), params, "city", scene->log))
        return NOC_ERR_ARGUMENT;
    if (scene->committed)
        return noc_error(scene->log, NOC_ERR_ARGUMENT, "city: the scene is committed");
    town *t = noc_calloc(1, sizeof(*t));
    if (!t)
        return noc_scene_out_of_memory(scene);
    t->scene = scene;
    t->switched = style->windows;
    t->often = style->often;
    town_plan(t, params);
    add_materials(t);
    t->lamps = noc_scene_group_named(scene, "lamps");
    t->windows = noc_scene_group_named(scene, "windows");
    t->cars = noc_scene_group_named(scene, "cars");
    town_roads(t);
    town_river(t);
    int id = 0;
    for (int j = 0; j + 1 < (int)t->axis[1].gaps.len && !t->failed; j++)
        for (int i = 0; i + 1 < (int)t->axis[0].gaps.len && !t->failed; i++)
            cell_build(t, i, j, &id);
    diagonal_markings(t);
    belt(t);
    if (style->dress)
        style->dress(t);
    double edge = 0.5 * params->size;
    const double rim[12] = { -edge, -edge, 0.05, edge, -edge, 0.05, edge, edge, 0.05, -edge, edge, 0.05 };
    city_add_surroundings(scene, rim, 4, t->material[TM_LAWN]);
    bool failed = t->failed;
    for (int m = 0; m < TM_COUNT; m++) {
        array_free(&t->batch[m].xyz);
        array_free(&t->batch[m].indices);
    }
    array_free(&t->panes);
    free(t);
    noc_scene_light_windows(scene, &noc_window_default_params());
    /* what failed was reported where it did */
    return scene->no_memory ? NOC_ERR_MEMORY : failed ? NOC_ERR_ARGUMENT : NOC_OK;
}

noc_status noc_scene_add_city(noc_scene *scene, const noc_city_params *params) {
    if (!scene)
        return NOC_ERR_ARGUMENT;
    noc_city_params defaults = noc_city_default_params();
    return town_build(scene, params ? params : &defaults, &(town_style){ .windows = true, .often = 1 });
}
