/* What the files of the world share. */
#ifndef NOC_VIEWER_WORLD_PARTS_H
#define NOC_VIEWER_WORLD_PARTS_H

#include "viewer/option.h"
#include "viewer/world.h"

#include <pthread.h>

/* A group of lights. */
typedef struct group {
    world_group is;  /* as it is set */
    world_group was; /* as inputs and recipe have it */
    int index;       /* in the scene */
    bool said;       /* by words of the command line */
    bool dirty;      /* the scene has it otherwise */
    bool recoloured; /* of that: its colour */
    char own[8];     /* mean of its lights' own colours, "#rrggbb" */
} group;

/* What surfaces of a class are made of. */
typedef struct class_look {
    bool there;          /* a surface of the scene is of the class */
    noc_material is;     /* as it is set, dry */
    noc_material was;    /* as inputs and recipe have it; many colours are told by their class's */
    bool dirty, covered; /* the scene has it otherwise; it is not as the inputs have it */
} class_look;

/* What is set besides rows of the import options, which `import` holds. */
typedef struct world_own {
    bool traffic, drive;
    double pace;
} world_own;

typedef enum dirty { DIRTY_WINDOWS = 1, DIRTY_TIME = 2, DIRTY_TRAFFIC = 4, DIRTY_OTHERS = 8 } dirty;

struct viewer_world {
    const viewer_source *source;
    noc_log *log;
    noc_scene *scene;
    noc_device *device;
    noc_report *report;
    pthread_t thread;
    pthread_mutex_t mutex; /* of all below */
    pthread_cond_t changed;
    bool started, loaded, over, ended;
    char what[128], failed[300];
    double done;
    noc_scene_info info;
    noc_import_params import; /* windows, time, rain as they are set */
    noc_import_params before; /* as the recipe says them, else the program */
    world_own own;
    bool built;      /* among the inputs is a built city */
    bool rain_fixed; /* which is wet for good */
    group *groups;
    size_t group_count;
    class_look classes[NOC_CLASS_COUNT];
    noc_material *materials; /* of the scene, as inputs have them */
    bool *named;             /* of each: a recipe says by its name what it is */
    unsigned dirty;
    bool busy;     /* the thread publishes */
    double looked; /* when somebody did, s */
    uint64_t version, told;
    uint64_t published; /* commits, well or not */
};

/* world_set.c: once the scene is there. */
noc_status world_begin(viewer_world *w);
void world_finish(viewer_world *w);
bool world_drives(const viewer_world *w);

/* world.c: commits after which all that is set is in the scene. Call under the mutex. */
uint64_t world_commits(const viewer_world *w);

/* world_apply.c: stages all that is dirty, under the mutex. */
noc_status world_stage(viewer_world *w);

extern const noc_class world_rained[];
enum { WORLD_RAINED = 4 };

#endif
