/* Roads of maps as surfaces: a ribbon along each centre line, as wide as the carriageway, that lies on the ground. Its
 * joints are mitred, its ends round, so that ribbons which meet leave no wedge. Ribbons overlap where roads cross:
 * wider classes lie some millimetres above others, so that the upper one is seen and never both in turn. */
#include "city/city.h"
#include "scene/scene.h"

#include <math.h>

#define STEP 2.5         /* m between places along a road where the ground is asked for, and across it at most */
#define LIFT 0.02        /* m above the ground: more would cast a shadow beside it */
#define CLASS_LIFT 0.004 /* m from class to class */
#define FLAT 0.01        /* m that a ribbon may be off what lies under places that it passes over */
#define LONGEST 60.0     /* m from one place that is kept to the next */
#define MOST_RAISED 0.5  /* m by which a ribbon is lifted over an edge of the ground */
#define MITRE 2.0        /* times half the width that a joint reaches out at most */
#define CAP 5            /* places on a round end between its corners */
#define LONGEST_ROAD 2e5 /* m */
#define SEEN 0.002       /* m that the ground stands over a ribbon, where that is looked into */
enum { FINE = 9 };
enum { MOST_ACROSS = 16, MOST_TRIANGLES = 8000000, MOST_PLACES = 100000000 };

/* A place along a road: from the left to the right edge. */
typedef struct section {
    double left[2], right[2];
    double along; /* share of the road's length */
    bool corner;  /* one of the line's own points: it is kept */
} section;

typedef struct ribbon {
    const geo_road *road;
    size_t first_vertex, first_index, vertices, indices;
} ribbon;

typedef struct paver {
    noc_scene *scene;
    NOC_ARRAY(double) line; /* 2 a point, without repeated ones */
    NOC_ARRAY(section) sections;
    NOC_ARRAY(double) height;   /* of places: rows of sections, columns across, both at half steps */
    NOC_ARRAY(double) position; /* of all ribbons */
    NOC_ARRAY(uint32_t) index;
    NOC_ARRAY(ribbon) ribbons;
    size_t asked; /* heights of the ground */
    bool no_memory;
} paver;

#define PUSH(p, array, value) ((p)->no_memory = !array_push(&(p)->array, value) || (p)->no_memory)

/* ---- the outline ---- */

static bool take_line(paver *p, const geo_road *road) {
    p->line.len = 0;
    for (size_t i = 0; i < road->point_count; i++) {
        const double *at = road->xyz + 3 * i;
        size_t n = p->line.len;
        if (p->no_memory || !(fabs(at[0]) < 1e7 && fabs(at[1]) < 1e7))
            return false;
        if (n && hypot(at[0] - p->line.data[n - 2], at[1] - p->line.data[n - 1]) < 0.05)
            continue;
        PUSH(p, line, at[0]);
        PUSH(p, line, at[1]);
    }
    return p->line.len >= 4 && !p->no_memory;
}

/* The vector to the left, as long as half the width where the line is straight. */
static void joint(const paver *p, size_t i, double half, double out[2]) {
    size_t n = p->line.len / 2;
    const double *q = p->line.data;
    bool ring = q[0] == q[2 * n - 2] && q[1] == q[2 * n - 1] && n > 3;
    size_t before = i > 0 ? i - 1 : ring ? n - 2 : 0, after = i + 1 < n ? i + 1 : ring ? 1 : n - 1;
    size_t from[2] = { before, i }, to[2] = { i, after };
    double normal[2][2];
    for (int k = 0; k < 2; k++) {
        size_t a = from[k], b = to[k];
        if (a == b) {
            a = k ? before : i;
            b = k ? i : after;
        }
        double dx = q[2 * b] - q[2 * a], dy = q[2 * b + 1] - q[2 * a + 1], length = hypot(dx, dy);
        normal[k][0] = -dy / length;
        normal[k][1] = dx / length;
    }
    double mx = normal[0][0] + normal[1][0], my = normal[0][1] + normal[1][1], m2 = mx * mx + my * my;
    /* the mitre's length is 1 / cos of half the turn, which is half of |m| */
    double scale = half * NOC_MIN(2 / NOC_MAX(m2, 1e-9), MITRE / NOC_MAX(sqrt(m2), 1e-9));
    out[0] = m2 < 1e-6 ? half * normal[0][0] : mx * scale;
    out[1] = m2 < 1e-6 ? half * normal[0][1] : my * scale;
}

static void add_sections(paver *p, double half) {
    size_t n = p->line.len / 2;
    double total = 0, done = 0;
    for (size_t i = 0; i + 1 < n; i++)
        total +=
            hypot(p->line.data[2 * i + 2] - p->line.data[2 * i], p->line.data[2 * i + 3] - p->line.data[2 * i + 1]);
    p->sections.len = 0;
    for (size_t i = 0; i + 1 < n; i++) {
        const double *a = p->line.data + 2 * i, *b = a + 2;
        double length = hypot(b[0] - a[0], b[1] - a[1]), from[2], to[2];
        joint(p, i, half, from);
        joint(p, i + 1, half, to);
        int parts = 2 * (int)NOC_CLAMP(ceil(length / STEP), 1, 8192); /* half steps: every other place is a corner */
        for (int k = 0; k <= parts; k++) {
            if (k == 0 && i > 0)
                continue;
            double t = (double)k / parts;
            section s = { .along = (done + t * length) / total, .corner = k == 0 || k == parts };
            for (int d = 0; d < 2; d++) {
                double middle = a[d] + (b[d] - a[d]) * t, off = from[d] + (to[d] - from[d]) * t;
                s.left[d] = middle + off;
                s.right[d] = middle - off;
            }
            PUSH(p, sections, s);
        }
        done += length;
    }
}

/* ---- heights ---- */

static double ground_at(const paver *p, double x, double y) {
    double z;
    return noc_scene_ground(p->scene, x, y, &z) ? z : NAN;
}

/* Heights along a road's deck, at shares of its length that rise. */
typedef struct deck_walk {
    const geo_road *road;
    double total, done; /* m; up to point `at` */
    size_t at;
} deck_walk;

static double deck_height(deck_walk *w, double along) {
    const geo_road *road = w->road;
    double want = along * w->total;
    for (; w->at + 1 < road->point_count; w->at++) {
        const double *a = road->xyz + 3 * w->at;
        double length = hypot(a[3] - a[0], a[4] - a[1]), t = length > 0 ? (want - w->done) / length : 1;
        if (t <= 1 || w->at + 2 == road->point_count)
            return road->deck[w->at] + (road->deck[w->at + 1] - road->deck[w->at]) * NOC_CLAMP(t, 0, 1);
        w->done += length;
    }
    return NAN;
}

/* Bridges follow their decks, straight from end to end where that is not known, and are nowhere under the ground. */
static void span(paver *p, const geo_road *road, size_t columns) {
    size_t rows = p->sections.len, middle = columns / 2;
    deck_walk walk = { .road = road, .total = geo_road_length(road) };
    double a = p->height.data[middle], b = p->height.data[(rows - 1) * columns + middle];
    a = isfinite(a) ? a : b;
    b = isfinite(b) ? b : a;
    for (size_t i = 0; i < rows; i++) {
        double deck = road->deck ? deck_height(&walk, p->sections.data[i].along) : NAN;
        double z = isfinite(deck) ? deck : a + (b - a) * p->sections.data[i].along;
        for (size_t c = 0; c < columns; c++) {
            double *h = &p->height.data[i * columns + c];
            *h = isfinite(*h) ? fmax(*h, z) : z;
        }
    }
}

/* Of a cell between two rows and two columns: its corners, and how far the ground stands over its two triangles. */
typedef struct cell {
    const section *from, *to;
    double t0, t1;    /* across, 0 to 1 */
    double corner[4]; /* left and right of the first row, then of the second */
} cell;

static double flat_at(const cell *q, double s, double t) {
    const double *z = q->corner;
    return t >= s ? z[0] + t * (z[1] - z[0]) + s * (z[3] - z[1]) : z[0] + s * (z[2] - z[0]) + t * (z[3] - z[2]);
}

/* At n x n places. */
static double stands_over(paver *p, const cell *q, int n) {
    double over = 0;
    for (int i = 0; i < n * n; i++) {
        double s = (double)(i / n) / (n - 1), t = (double)(i % n) / (n - 1), u = q->t0 + (q->t1 - q->t0) * t, at[2];
        for (int d = 0; d < 2; d++) {
            double left = q->from->left[d] + (q->to->left[d] - q->from->left[d]) * s;
            double right = q->from->right[d] + (q->to->right[d] - q->from->right[d]) * s;
            at[d] = left + (right - left) * u;
        }
        double off = ground_at(p, at[0], at[1]) - flat_at(q, s, t);
        over = isfinite(off) ? fmax(over, off) : over;
    }
    p->asked += (size_t)(n * n);
    return over;
}

/* Corners are lifted where the ground between them stands over the ribbon. Three places to and fro find that it does,
 * and many by how much. */
static void raise_over_edges(paver *p, size_t columns) {
    size_t rows = p->sections.len;
    double *h = p->height.data;
    for (size_t i = 0; i + 2 < rows; i += 2)
        for (size_t c = 0; c + 2 < columns; c += 2) {
            double *corner[4] = { &h[i * columns + c], &h[i * columns + c + 2], &h[(i + 2) * columns + c],
                                  &h[(i + 2) * columns + c + 2] };
            cell q = { .from = &p->sections.data[i],
                       .to = &p->sections.data[i + 2],
                       .t0 = (double)c / (double)(columns - 1),
                       .t1 = (double)(c + 2) / (double)(columns - 1) };
            for (int k = 0; k < 4; k++)
                q.corner[k] = *corner[k];
            double over = 0;
            for (size_t k = 0; k < 9; k++) {
                double off =
                    h[(i + k / 3) * columns + c + k % 3] - flat_at(&q, (double)(k / 3) / 2, (double)(k % 3) / 2);
                over = isfinite(off) ? fmax(over, off) : over;
            }
            over = over > SEEN ? stands_over(p, &q, FINE) : 0;
            for (int k = 0; k < 4; k++)
                *corner[k] += NOC_MIN(over, MOST_RAISED);
        }
}

static void ask_heights(paver *p, const geo_road *road, size_t columns) {
    p->height.len = 0;
    p->asked += p->sections.len * columns;
    for (size_t i = 0; i < p->sections.len; i++)
        for (size_t c = 0; c < columns; c++) {
            const section *s = &p->sections.data[i];
            double t = (double)c / (double)(columns - 1);
            PUSH(p, height,
                 ground_at(p, s->left[0] + (s->right[0] - s->left[0]) * t,
                           s->left[1] + (s->right[1] - s->left[1]) * t));
        }
    if (p->no_memory)
        return;
    if (road->bridge)
        span(p, road, columns);
    raise_over_edges(p, columns);
}

/* ---- triangles ---- */

static bool whole(const paver *p, size_t row, size_t columns) {
    for (size_t c = 0; c < columns; c += 2)
        if (!isfinite(p->height.data[row * columns + c]))
            return false;
    return true;
}

/* May the ribbon go straight from one row to a later one? */
static bool straight(const paver *p, size_t from, size_t to, size_t columns) {
    const section *a = &p->sections.data[from], *b = &p->sections.data[to];
    for (size_t i = from + 2; i < to; i += 2) {
        const section *s = &p->sections.data[i];
        if (s->corner)
            return false;
        double t = (s->along - a->along) / (b->along - a->along);
        for (size_t c = 0; c < columns; c += 2) {
            double z = p->height.data[from * columns + c] * (1 - t) + p->height.data[to * columns + c] * t;
            if (!(fabs(z - p->height.data[i * columns + c]) < FLAT))
                return false;
        }
    }
    return true;
}

static void push_point(paver *p, double x, double y, double z) {
    PUSH(p, position, x);
    PUSH(p, position, y);
    PUSH(p, position, z);
}

static void push_triangle(paver *p, size_t a, size_t b, size_t c) {
    PUSH(p, index, (uint32_t)a);
    PUSH(p, index, (uint32_t)b);
    PUSH(p, index, (uint32_t)c);
}

/* Returns the number of the row's first vertex in its ribbon. */
static size_t push_row(paver *p, const ribbon *r, size_t row, size_t columns, double lift) {
    const section *s = &p->sections.data[row];
    size_t first = p->position.len / 3 - r->first_vertex;
    for (size_t c = 0; c < columns; c += 2) {
        double t = (double)c / (double)(columns - 1);
        push_point(p, s->left[0] + (s->right[0] - s->left[0]) * t, s->left[1] + (s->right[1] - s->left[1]) * t,
                   p->height.data[row * columns + c] + lift);
    }
    return first;
}

static void push_strip(paver *p, size_t from, size_t to, size_t across) {
    for (size_t c = 0; c < across; c++) { /* counter-clockwise from above: left is on the left of the way on */
        push_triangle(p, from + c, from + c + 1, to + c + 1);
        push_triangle(p, from + c, to + c + 1, to + c);
    }
}

/* How far the ground stands over the triangles of a cap: at n x n places of each, out from the middle and from side to
 * side. */
static double cap_over(paver *p, double (*at)[2], const double *z, int n) {
    double over = 0;
    for (int i = 0; i < (CAP + 1) * n * n; i++) {
        int k = i / (n * n);
        double s = (double)(i / n % n) / (n - 1), t = (double)(i % n) / (n - 1), q[2];
        for (int d = 0; d < 2; d++)
            q[d] = at[CAP + 2][d] + (at[k][d] + (at[k + 1][d] - at[k][d]) * t - at[CAP + 2][d]) * s;
        double off = ground_at(p, q[0], q[1]) - (z[CAP + 2] + (z[k] + (z[k + 1] - z[k]) * t - z[CAP + 2]) * s);
        over = isfinite(off) ? fmax(over, off) : over;
    }
    p->asked += (size_t)((CAP + 1) * n * n);
    return over;
}

/* Half a disc beyond an end, a little lower than its ribbon. way: 1 at the last row, -1 at the first. */
static void push_cap(paver *p, const ribbon *r, size_t row, double way, double lift) {
    const section *s = &p->sections.data[row];
    double middle[2] = { (s->left[0] + s->right[0]) / 2, (s->left[1] + s->right[1]) / 2 };
    double off[2] = { s->left[0] - middle[0], s->left[1] - middle[1] };
    double z[CAP + 3], at[CAP + 3][2]; /* the last ones are the middle's */
    memcpy(at[CAP + 2], middle, sizeof(middle));
    z[CAP + 2] = ground_at(p, middle[0], middle[1]);
    for (int k = 0; k < CAP + 2; k++) {
        double turn = M_PI * k / (CAP + 1) * -way;
        at[k][0] = middle[0] + off[0] * cos(turn) - off[1] * sin(turn);
        at[k][1] = middle[1] + off[0] * sin(turn) + off[1] * cos(turn);
        z[k] = ground_at(p, at[k][0], at[k][1]);
        if (!isfinite(z[k]) || !isfinite(z[CAP + 2]))
            return;
    }
    double over = cap_over(p, at, z, 3);
    over = over > SEEN ? NOC_MIN(cap_over(p, at, z, FINE), MOST_RAISED) : 0;
    lift += over - CLASS_LIFT / 2;
    size_t first = p->position.len / 3 - r->first_vertex;
    push_point(p, middle[0], middle[1], z[CAP + 2] + lift);
    for (int k = 0; k < CAP + 2; k++)
        push_point(p, at[k][0], at[k][1], z[k] + lift);
    for (size_t k = 0; k < CAP + 1; k++)
        push_triangle(p, first, first + (way > 0 ? k + 2 : k + 1), first + (way > 0 ? k + 1 : k + 2));
}

static double lift_of(geo_road_class cls) {
    static const int rank[GEO_ROAD_CLASSES] = {
        [GEO_ROAD_MOTORWAY] = 9,  [GEO_ROAD_TRUNK] = 8,    [GEO_ROAD_PRIMARY] = 7,
        [GEO_ROAD_SECONDARY] = 6, [GEO_ROAD_TERTIARY] = 5, [GEO_ROAD_MINOR] = 4,
        [GEO_ROAD_LIVING] = 3,    [GEO_ROAD_SERVICE] = 2,  [GEO_ROAD_PEDESTRIAN] = 1,
    };
    return LIFT + CLASS_LIFT * rank[cls];
}

/* A ribbon where the road lies on ground; false where it does nowhere. */
static bool pave(paver *p, const geo_road *road) {
    double width = geo_road_width(road), lift = lift_of(road->cls);
    if (!take_line(p, road))
        return false;
    add_sections(p, width / 2);
    size_t across = (size_t)NOC_CLAMP(ceil(width / STEP), 1, MOST_ACROSS), columns = 2 * across + 1;
    ask_heights(p, road, columns);
    ribbon r = { .road = road, .first_vertex = p->position.len / 3, .first_index = p->index.len };
    size_t last = 0, row = 0, rows = p->sections.len;
    bool open = false;
    for (size_t i = 0; i < rows && !p->no_memory; i += 2) {
        if (!whole(p, i, columns)) {
            open = false;
            continue;
        }
        if (!open) {
            row = push_row(p, &r, i, columns, lift);
            last = i;
            open = true;
            continue;
        }
        bool ends = i + 2 >= rows || !whole(p, i + 2, columns);
        bool far = (p->sections.data[i].along - p->sections.data[last].along) * geo_road_length(road) > LONGEST;
        if (!ends && !far && !p->sections.data[i].corner && straight(p, last, i + 2, columns))
            continue;
        size_t next = push_row(p, &r, i, columns, lift);
        push_strip(p, row, next, across);
        row = next;
        last = i;
    }
    if (!road->bridge && rows && !p->no_memory) {
        push_cap(p, &r, 0, -1, lift);
        push_cap(p, &r, rows - 1, 1, lift);
    }
    r.vertices = p->position.len / 3 - r.first_vertex;
    r.indices = p->index.len - r.first_index;
    if (r.indices)
        PUSH(p, ribbons, r);
    return r.indices > 0;
}

static bool on_foot(geo_road_class cls) { return cls == GEO_ROAD_PEDESTRIAN || cls == GEO_ROAD_PATH; }

/* After all heights were asked for, so that no road lies on another. */
static noc_status add_meshes(paver *p) {
    int of[2] = { -1, -1 };
    for (size_t i = 0; i < p->ribbons.len; i++) {
        const ribbon *r = &p->ribbons.data[i];
        int *material = &of[on_foot(r->road->cls)];
        if (*material < 0) {
            noc_material m = noc_class_material(on_foot(r->road->cls) ? NOC_CLASS_SIDEWALK : NOC_CLASS_ROAD);
            *material = noc_scene_add_material(p->scene, &m);
        }
        noc_mesh mesh = { .vertex_count = r->vertices,
                          .positions = p->position.data + 3 * r->first_vertex,
                          .triangle_count = r->indices / 3,
                          .indices = p->index.data + r->first_index,
                          .material = *material,
                          .name = r->road->id };
        if (*material < 0 || noc_scene_add_mesh(p->scene, &mesh) < 0)
            return p->scene->no_memory ? NOC_ERR_MEMORY : NOC_ERR_ARGUMENT;
    }
    return NOC_OK;
}

noc_status city_pave_roads(noc_scene *scene, const geo_road *roads, size_t count, const noc_progress *progress,
                           city_paved *paved) {
    paver p = { .scene = scene };
    noc_status status = NOC_OK;
    *paved = (city_paved){ 0 };
    for (size_t i = 0; i < count && !status && !p.no_memory; i++) {
        const geo_road *road = &roads[i];
        if (i % 256 == 0 && progress && progress->update &&
            !progress->update(progress->user, "roads", (double)i / (double)count))
            status = NOC_ERR_CANCELLED;
        else if (road->cls == GEO_ROAD_RAIL || road->cls == GEO_ROAD_TRACK)
            paved->unpaved++;
        else if (road->tunnel)
            paved->tunnels++;
        else if (p.index.len / 3 > MOST_TRIANGLES || p.asked > MOST_PLACES || !(geo_road_length(road) < LONGEST_ROAD))
            paved->too_many++;
        else if (pave(&p, road))
            paved->roads++;
        else
            paved->off_ground++;
    }
    if (!status && p.no_memory)
        status = noc_scene_out_of_memory(scene);
    if (!status)
        status = add_meshes(&p);
    paved->triangles = p.index.len / 3;
    array_free(&p.line);
    array_free(&p.sections);
    array_free(&p.height);
    array_free(&p.position);
    array_free(&p.index);
    array_free(&p.ribbons);
    return status;
}
