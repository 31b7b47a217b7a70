/* core/records.h: what lies in memory between passes and frames, the same for C and shaders. Every record is made of
 * 4-byte scalars without gaps, which is GLSL's `scalar` layout: sizes and offsets are asserted at the end. */
#ifndef CORE_RECORDS_H
#define CORE_RECORDS_H

#if defined(CORE_GLSL)
#define uint32_t uint
#else
#include <stddef.h>
#include <stdint.h>
#endif

/* Kinds of light: noc_light_kind. */
#define LIGHT_SPHERE 0u
#define LIGHT_DISC 1u
#define LIGHT_TRIANGLE 2u
#define LIGHT_PARALLELOGRAM 3u
#define LIGHT_POINT 4u
#define LIGHT_SPOT 5u
/* Flags of a light; the other bits are the scene's. From bit LIGHT_GROUP on its group. */
#define LIGHT_TWO_SIDED 1u
#define LIGHT_INFERRED 2u
#define LIGHT_MOVES 4u
#define LIGHT_GROUP 16
/* Bits of a light's flags: the number of its profile, 0 for none. */
#define LIGHT_PROFILE 6
#define LIGHT_PROFILE_BITS 0xffc0u
/* The steps of a profile's table: rows from bit 16 on, and from bit PROFILE_POLE on the pole that rows are angles from:
 * the axis (photometric type C), down (A) or left (B). */
#define PROFILE_ROWS 0x3fffu
#define PROFILE_POLE 30
#define PROFILE_DOWN 1u
#define PROFILE_LEFT 2u
#define NO_LIGHT 0xffffffffu
#define NO_INSTANCE 0xffffffffu /* in place of one: the world */
/* Textures: core/texture.h. */
#define TEXTURE_HEAD 32u /* words, enough for the levels of a longer side of 2^15 - 1 texels */
#define TEXEL_THERE 0x40000000u
#define TEXEL_HOLE 0x80000000u
/* What is beyond the edges of an image: noc_wrap. */
#define WRAP_REPEAT 0u
#define WRAP_MIRROR 1u
#define WRAP_CLAMP 2u

/* A light: core/light.h says what each kind keeps where. One cache line. */
struct light_record {
    float p[3];    /* centre or corner */
    uint32_t kind; /* LIGHT_SPHERE, ... */
    float a[3];    /* edge u; disc: first radius vector; spot: its axis, times the scale of its falloff; sphere and
                    * point with a profile: C 0, unit */
    float radius;  /* triangle, parallelogram: the longest way between two corners; 0 for points and spots */
    /* edge v; disc: second radius vector; the light faces a x b. Spot: offset of its falloff, inner and
     * outer angle in radians. Sphere and point with a profile: C 270, unit */
    float b[3];
    uint32_t flags;
    float e[3]; /* cd/m2; point, spot: cd; with a profile: lm */
    float area; /* m2; 0 for points and spots; with a profile: its greatest intensity, cd a lumen */
};

/* Half a cache line. */
struct material_record {
    float albedo[3];
    float f0;
    float emission[3];
    float alpha; /* roughness^2 */
};

/* A grid of cells on a wall, whose windows have no triangles: core/facade.h. Cell first + j * columns + i of the
 * scene's is that of column i and row j. */
struct facade_record {
    float origin[3]; /* corner of column 0, row 0 */
    uint32_t first;
    float along[3]; /* a place p is in column dot(p - origin, along), */
    uint32_t columns;
    float up[3]; /* and in row dot(p - origin, up) */
    uint32_t rows;
    uint32_t material; /* of the windows */
    uint32_t mesh;     /* the wall's, whose name they have */
};

/* Rows of a 3x4 transform: a rotation times a scale, and a translation. */
struct placement_rows {
    float m[12];
};
#if !defined(CORE_GLSL)
typedef struct placement_rows placement_rows;
#endif

/* From where an instance is to where it was in the frame before: core/placement.h. */
struct placing_back {
    float from[3];
    uint32_t known; /* 0: it was not there */
    placement_rows rows;
};

#if !defined(CORE_GLSL)
typedef struct light_record light_record;
typedef struct material_record material_record;
typedef struct facade_record facade_record;
typedef struct placing_back placing_back;

#define RECORD_SIZE(type, words) _Static_assert(sizeof(struct type) == 4 * (words), #type " has no gaps")
#define RECORD_FIELD(type, field, word)                                                                                \
    _Static_assert(offsetof(struct type, field) == 4 * (word), #type "." #field " lies where shaders read it")

RECORD_SIZE(light_record, 16);
RECORD_FIELD(light_record, p, 0);
RECORD_FIELD(light_record, kind, 3);
RECORD_FIELD(light_record, a, 4);
RECORD_FIELD(light_record, radius, 7);
RECORD_FIELD(light_record, b, 8);
RECORD_FIELD(light_record, flags, 11);
RECORD_FIELD(light_record, e, 12);
RECORD_FIELD(light_record, area, 15);

RECORD_SIZE(placing_back, 16);
RECORD_FIELD(placing_back, known, 3);
RECORD_FIELD(placing_back, rows, 4);

RECORD_SIZE(material_record, 8);
RECORD_FIELD(material_record, albedo, 0);
RECORD_FIELD(material_record, f0, 3);
RECORD_FIELD(material_record, emission, 4);
RECORD_FIELD(material_record, alpha, 7);

RECORD_SIZE(facade_record, 14);
RECORD_FIELD(facade_record, first, 3);
RECORD_FIELD(facade_record, along, 4);
RECORD_FIELD(facade_record, up, 8);
RECORD_FIELD(facade_record, material, 12);
#endif

#endif
