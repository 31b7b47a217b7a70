/* viewer: the interactive viewer that `nocturne view` serves to browsers. A part of the program, on the public headers
 * alone; cli/view.c calls it. docs/viewer-protocol.md has the wire. */
#ifndef NOC_VIEWER_H
#define NOC_VIEWER_H

#include <nocturne/nocturne.h>

/* An option that the words of the command line have said, and the params struct that its table is of. */
typedef struct viewer_given {
    const noc_option *option;
    const void *params;
} viewer_given;

/* A picture that is to be written. */
typedef struct viewer_picture {
    noc_scene *scene;
    noc_view *view;
    const noc_report *report;
    noc_camera camera;
    noc_render_params render; /* of its last frame */
    noc_display_params display;
    noc_channel_params channel;
    int show, preset;                /* 0: the picture, else 1 + noc_aov; noc_preset */
    uint64_t frames;                 /* in the mean */
    const noc_import_params *import; /* with what was set of the world */
} viewer_picture;

/* What is looked at, as the command line and the recipe say it. All of it belongs to the caller and lasts as long as
 * the viewer. */
typedef struct viewer_source {
    const char *const *said; /* inputs as they were said: a recipe is one of them. For a command that does the same */
    size_t said_count;
    const viewer_given *given; /* options that were said beside them */
    size_t given_count;
    const noc_recipe *recipe; /* NULL: there is none among the inputs */
    /* Reads all inputs into the empty scene and commits it; reported to the scene's log. Called once, by a thread of
     * the viewer's. */
    noc_status (*load)(void *user, noc_scene *scene, const noc_progress *progress, noc_report **report);
    /* Writes a picture to a file whose ending says how, with all that tells how it was made; reported to the log. */
    noc_status (*write)(void *user, const viewer_picture *picture, const char *path, noc_log *log);
    void *user;
    const noc_import_params *import; /* what load reads them with */
    noc_camera_params camera;        /* where the first picture is seen from */
    noc_render_params render;        /* what looks begin with */
    noc_display_params display;
    int show; /* the mode that they begin with: 0 is the picture, else 1 + noc_aov */
    noc_channel_params channel;
    noc_device_params device;
} viewer_source;

typedef struct viewer_params {
    const char *address; /* that is listened at: a number such as 127.0.0.1 or ::1, or a name */
    int port;            /* 0: any that is free */
    int clients;         /* at once, at most */
    const char *token;   /* that the link has; NULL: a random one */
    /* Asked several times a second, and when a signal has come: true ends the viewer. */
    bool (*ended)(void *user);
    /* Told once, when it listens; the link has the token. */
    void (*listening)(void *user, const char *link);
    /* What goes wrong with the address, and with clients, a line each. */
    void (*say)(void *user, noc_log_level level, const char *text);
    void *user;
} viewer_params;

/* Serves until it is ended. NOC_OK then; NOC_ERR_IO after reporting that the address cannot be listened at,
 * NOC_ERR_FORMAT where the inputs could not be loaded, which that has reported,
 * NOC_ERR_UNSUPPORTED after reporting that this build has no viewer. All threads have ended when it returns. */
noc_status viewer_run(const viewer_source *source, const viewer_params *params, noc_log *log);

/* "libwebsockets 4.1.6", or what is missing: for --version. */
const char *viewer_features(void);

#endif
