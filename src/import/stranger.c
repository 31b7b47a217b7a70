/* Formats that people bring and that are not read: told by their content, so that the error can name them and the way
 * round. */
#include "import/load/load.h"

static const char *next_line(const char *line) {
    line = strchr(line, '\n');
    return line ? line + 1 : NULL;
}

/* EULUMDAT has no name in it. Of its lines, all of one value, the 2nd is a kind from 1 to 3, the 3rd a symmetry from 0
 * to 4, the 4th and 6th count planes and angles, the 5th and 7th are the degrees between them. */
static bool is_eulumdat(const char *head) {
    static const struct {
        double lo, hi;
    } lines[] = { { 1, 3 }, { 0, 4 }, { 1, 721 }, { 0, 360 }, { 1, 721 }, { 0, 180 } };
    const char *line = next_line(head);
    for (size_t i = 0; i < NOC_COUNT(lines); i++, line = next_line(line)) {
        double value;
        const char *end = line ? noc_scan_double(line, line + strcspn(line, ",\r\n"), &value) : NULL;
        if (!end || end[strspn(end, " \t\r,0123456789")] != '\n' || !(value >= lines[i].lo && value <= lines[i].hi))
            return false;
    }
    return true;
}

#define PHOTOMETRY(name)                                                                                               \
    "this is a luminaire's photometry (" name "), which is not read: lamps are tables and maps of points"

const char *stranger_told(const char *head) {
    static const char office[] =
        "this is a table of an office program (such as XLSX or ODS), which is not read: save it as CSV";
    static const struct {
        const char *start, *part, *told;
    } known[] = {
        { "nocturne:", "", "this is a recipe, which stands on the command line, in no other recipe and in no list" },
        { "IESNA", "", PHOTOMETRY("IES") },
        { "", "\nTILT=", PHOTOMETRY("IES") },
        { "<", "<kml", "this is KML, which is not read: convert it to GeoJSON, with ogr2ogr for example" },
        { "<", "<OpenDRIVE",
          "this is OpenDRIVE (roads for driving simulators), which is not read: "
          "city models are CityGML, CityJSON, OBJ, PLY or glTF, lamps are tables and maps of points" },
        { "<", "schemas.openxmlformats.org", office },
        { "<", "oasis:names:tc:opendocument", office },
    };
    const char *text = head + (strncmp(head, "\xef\xbb\xbf", 3) ? 0 : 3);
    text += strspn(text, " \t\r\n");
    for (size_t i = 0; i < NOC_COUNT(known); i++)
        if (!strncmp(text, known[i].start, strlen(known[i].start)) && strstr(text, known[i].part))
            return known[i].told;
    return is_eulumdat(head) ? PHOTOMETRY("EULUMDAT") : NULL;
}
