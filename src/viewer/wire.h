/* wire: messages from text to structs, and back. The only reader of what strangers send; docs/viewer-protocol.md has
 * the messages. */
#ifndef NOC_VIEWER_WIRE_H
#define NOC_VIEWER_WIRE_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    WIRE_TEXT = 32768, /* bytes of a message, at most */
    WIRE_DEPTH = 6,    /* of its objects and arrays */
    WIRE_SIDE = 8192,  /* px */
    WIRE_PANES = 6,
    WIRE_POINTS = 256, /* of a polygon */
    WIRE_PAIRS = 32,   /* of a photograph */
    WIRE_CAMERAS = 64, /* of a recipe */
    WIRE_HEAD = 32     /* bytes, of a binary message */
};

typedef enum wire_kind {
    WIRE_HELLO,
    WIRE_INPUT,
    WIRE_NAVIGATE,
    WIRE_CAMERA,
    WIRE_JUMP,
    WIRE_SET,
    WIRE_WORLD,
    WIRE_LAYOUT,
    WIRE_ACK,
    WIRE_WATCH,
    WIRE_ASK,
    WIRE_CANCEL,
    WIRE_SAVE
} wire_kind;

/* Keys that are down: bits. */
typedef enum wire_key {
    WIRE_FORWARD = 1,
    WIRE_BACK = 2,
    WIRE_LEFT = 4,
    WIRE_RIGHT = 8,
    WIRE_UP = 16,
    WIRE_DOWN = 32,
    WIRE_FAST = 64,
    WIRE_SLOW = 128
} wire_key;

typedef enum wire_mode { WIRE_ORBIT, WIRE_FLY, WIRE_WALK } wire_mode;
typedef enum wire_layout { WIRE_SINGLE, WIRE_DIVIDER, WIRE_METHODS, WIRE_DIFFERENCE } wire_layout;
typedef enum wire_question {
    WIRE_PIXEL,
    WIRE_REGION,
    WIRE_LAMP,
    WIRE_LIGHTS,
    WIRE_ALIGN,
    WIRE_FIND,
    WIRE_NAME
} wire_question;
typedef enum wire_save { WIRE_PNG, WIRE_EXR, WIRE_RECIPE, WIRE_CSV } wire_save;
extern const char *const wire_modes[], *const wire_layouts[]; /* their names, NULL-ended */

typedef struct wire_input {
    uint32_t n;
    double seconds; /* since the last one, 0..1 */
    unsigned keys;  /* wire_key */
    double turn[2], pan[2], zoom;
    bool has_at;
    double at[2];
} wire_input;

typedef struct wire_camera {
    const char *name; /* NULL: eye, target, fov are said */
    double eye[3], target[3], fov;
} wire_camera;

typedef struct wire_ask {
    wire_question what;
    uint32_t id;
    int pane;
    double x, y;   /* pixel */
    bool has_rect; /* region: the rectangle, else the polygon where there are points, else the object or the street */
    double rect[4];
    int points, pairs;
    double point[WIRE_POINTS][2];
    const char *object, *street; /* region and name; NULL: another one is said */
    const char *text;            /* find */
    bool has_light, has_at;      /* name: of the light, of what is seen there from above, else of object or street */
    double at[2];
    uint32_t light;                                            /* lamp, name */
    bool moving;                                               /* lights: cars alone */
    double photo[WIRE_PAIRS][2], place[WIRE_PAIRS][3], aspect; /* align */
} wire_ask;

/* One message; texts in it belong to root. */
typedef struct wire_message {
    wire_kind kind;
    json_t *root;
    union {
        struct {
            int width, height;
        } hello;
        wire_input input;
        struct {
            wire_mode mode;
            double speed; /* m/s; 0: as it is */
        } navigate;
        struct {
            uint32_t n;
            bool still; /* at once, without a flight */
            wire_camera to;
        } camera;
        struct {
            uint32_t n;
            bool still;
            int pane;
            double x, y;
            bool has_place; /* there, in place of what is seen at x, y; to be looked at from so far */
            double place[3], distance;
        } jump;
        struct {
            uint32_t n;
            int pane; /* -1: all */
            const char *name, *value;
        } set; /* and world, which has no pane */
        struct {
            uint32_t n;
            wire_layout name;
        } layout;
        struct {
            int pane;
            uint32_t n;
        } ack;
        bool watch; /* false: the page is hidden */
        wire_ask ask;
        uint32_t cancel;
        struct {
            uint32_t id, of;
            wire_save what;
            int pane, cameras;
            wire_camera camera[WIRE_CAMERAS];
        } save;
    };
} wire_message;

/* Reads a message. false: it is none, and why says why in English (of the program's own words alone); there is nothing
 * to free then. */
bool wire_read(const char *text, size_t size, wire_message *message, char *why, size_t why_size);
void wire_free(wire_message *message);

/* Head of a binary message. */
typedef enum wire_binary { WIRE_IS_PICTURE = 1, WIRE_IS_FILE = 2, WIRE_IS_LIGHTS = 3 } wire_binary;
typedef enum wire_flag { WIRE_MOVES = 1, WIRE_SMOOTHED = 2, WIRE_LEGEND = 4 } wire_flag;
typedef struct wire_head {
    wire_binary kind;
    int pane;
    bool png;
    unsigned flags; /* wire_flag */
    uint32_t number, input;
    int width, height;
    uint32_t frames;
    float error, seconds;
    uint32_t name_size;
} wire_head;
void wire_write_head(const wire_head *head, unsigned char out[WIRE_HEAD]);
/* Little-endian, for the sections of lights. */
void wire_put_u32(unsigned char *out, uint32_t value);
void wire_put_f32(unsigned char *out, float value);

/* {"t": kind}, to be filled; NULL: no memory. */
json_t *wire_begin(const char *kind);
/* The message as text, which is the caller's to free(); NULL: no memory. Takes the message, which may be NULL. */
char *wire_end(json_t *message);
/* A note of {"level", "text"}, as wire_end gives it. text need not be UTF-8. */
char *wire_note(const char *level, const char *text);
/* A JSON string of any bytes: what is no UTF-8 becomes "?". NULL: no memory. */
json_t *wire_text(const char *text);

#endif
