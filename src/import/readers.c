/* The table of formats, in the order in which they are asked: the most telling beginnings first. */
#include "import/load/load.h"

const noc_reader *const noc_readers[] = {
    &noc_reader_citygml, &noc_reader_cityjson, &noc_reader_ply,    &noc_reader_mesh,   &noc_reader_gltf,
    &noc_reader_terrain, &noc_reader_overpass, &noc_reader_tracks, &noc_reader_vector, NULL
};

const noc_reader *find_reader(const noc_reader *const *readers, const char *head, size_t size) {
    for (; *readers; readers++)
        if ((*readers)->probe(head, size))
            return *readers;
    return NULL;
}
