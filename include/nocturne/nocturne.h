/* nocturne/nocturne.h: all of the public API. A renderer of cities at night: see README.md and docs/architecture.md. */
#ifndef NOCTURNE_NOCTURNE_H
#define NOCTURNE_NOCTURNE_H

#include <nocturne/built.h>
#include <nocturne/image.h>
#include <nocturne/import.h>
#include <nocturne/influence.h>
#include <nocturne/lab.h>
#include <nocturne/log.h>
#include <nocturne/luminaire.h>
#include <nocturne/map.h>
#include <nocturne/measure.h>
#include <nocturne/navigate.h>
#include <nocturne/option.h>
#include <nocturne/path.h>
#include <nocturne/photometry.h>
#include <nocturne/recipe.h>
#include <nocturne/render.h>
#include <nocturne/scene.h>
#include <nocturne/smooth.h>
#include <nocturne/text.h>
#include <nocturne/tiles.h>

#ifdef __cplusplus
extern "C" {
#endif

NOC_API const char *noc_version(void);  /* "0.1.0" */
NOC_API const char *noc_features(void); /* parts of this build: "embree 3.13.5, gdal 3.6.2, assimp 5.2.4" */

#ifdef __cplusplus
}
#endif
#endif
