/* join: scenes into one, or a part of a scene into another. What is the same in both is there once: groups and profiles
 * of lights, textures, materials, models. */
#ifndef NOC_SCENE_JOIN_H
#define NOC_SCENE_JOIN_H

#include "scene/scene.h"

typedef enum noc_mesh_choice { NOC_MESH_LEAVE, NOC_MESH_TAKE, NOC_MESH_CUT } noc_mesh_choice;

/* Which part of a scene is taken. Lights that come and go with a mesh or an instance go with it; a mesh that shows a
 * lamp, and a body, with that. */
typedef struct noc_choice {
    const uint8_t *meshes; /* noc_mesh_choice of each mesh; those of models are not looked at */
    const bool *lights;    /* of each light that is a lamp; all lights of a body alike */
    const bool *instances;
    const bool *streets;
    /* Of a mesh that is cut, which shows no lights: its number of triangles, their corners in *xyz (9 numbers each) and
     * *uv (6 each; not read where the mesh has none), valid up to the next call. false: no memory. */
    bool (*cut)(void *ctx, const noc_scene *from, size_t mesh, size_t *count, const float **xyz, const float **uv);
    void *ctx;
} noc_choice;

typedef struct noc_joiner noc_joiner;

/* Into an empty scene that is not committed. NULL: no memory, reported. */
noc_joiner *noc_joiner_create(noc_scene *to) NOC_MUST_USE;
/* Appends a committed scene without edits, whose origin lies `shift` [m] from that of `to`; its backdrop is left out,
 * and so are its CRS and what the scene as a whole is told. choice NULL: all of it. name: of messages, and so is
 * `first`, which is the first that was added. taken: for each window of `from` whether it is in `to`, in their order.
 * NOC_ERR_ARGUMENT after reporting: a group is dimmed otherwise; NOC_ERR_UNSUPPORTED: there are too many of something;
 * NOC_ERR_MEMORY. `to` is of no use after an error, but can be destroyed. */
noc_status noc_joiner_add(noc_joiner *j, const noc_scene *from, const double shift[3], const noc_choice *choice,
                          const char *name, const char *first, bool *taken);
/* Makes what follows from the rest: the scene is committed then. */
noc_status noc_joiner_finish(noc_joiner *j);
void noc_joiner_destroy(noc_joiner *j); /* NULL is allowed; the scene stays */

/* ---- join_shared.c: what scenes have in common; for join.c alone ---- */

#define NOC_JOIN_NONE UINT32_MAX

struct noc_joiner {
    noc_scene *to;
    noc_map materials, textures, models; /* what tells one -> its number in `to` */
    /* of the scene that is added */
    const noc_scene *from;
    const noc_choice *choice;
    const char *name, *first;
    double shift[3];
    noc_status status;                                      /* the first thing that went wrong, reported */
    uint32_t *group, *profile, *texture, *material, *model; /* numbers in `to`; NOC_JOIN_NONE: not asked for yet */
    uint32_t *light, *mesh, *instance, *route;              /* the same; NOC_JOIN_NONE: not taken */
    uint32_t *facade;                                       /* number + 1 in `to`; NOC_JOIN_NONE: not asked for yet */
    uint32_t *model_mesh, *next_mesh; /* meshes of a model: the first + 1, and of each mesh the next one + 1 */
    size_t cells_left, texels_left, stops_left; /* that none of its tables, textures and routes has taken yet */
    const char *name_before, *kept_before;      /* the last name that was kept */
};

noc_status noc_join_groups(noc_joiner *j);
/* Numbers in `to` of one of `from`, from 0 for materials and from 1 for the others, 0 staying 0; NOC_JOIN_NONE after
 * reporting. */
uint32_t noc_join_material(noc_joiner *j, uint32_t material);
uint32_t noc_join_profile(noc_joiner *j, uint32_t profile);
uint32_t noc_join_model(noc_joiner *j, uint32_t model);
/* Takes `count` of what is left, which a file whose parts lie over one another has too little of. false after
 * reporting. */
bool noc_join_spend(noc_joiner *j, size_t *left, size_t count);
/* Report what went wrong: false. */
bool noc_join_no_memory(noc_joiner *j);
bool noc_join_too_many(noc_joiner *j, const char *what);
/* A light's record with its group and profile as `to` has them, where it is. false after reporting. */
bool noc_join_light(noc_joiner *j, noc_light_record *r);
bool noc_join_name(noc_joiner *j, const char *name, const char **kept);
/* join.c: appends a mesh; model: its number in `to`. false after reporting. */
bool noc_join_mesh(noc_joiner *j, size_t mesh, uint32_t model);

#endif
