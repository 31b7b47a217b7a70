// The defaults as a C++ program uses them; tests/layers.sh compiles and runs it.
#include <nocturne/nocturne.h>

static bool is_lists(const noc_render_params *p) { return p->candidates == NOC_CANDIDATES_LISTS && p->width == 1280; }

int main() {
    noc_render_params render = noc_render_default_params();
    render.height = 8;
    const noc_compare_params *compare = &noc_compare_default_params();
    noc_import_params import = noc_import_default_params();
    noc_city_params city = noc_city_default_params();
    bool good = is_lists(&noc_render_default_params()) && noc_render_default_params().height == 720 &&
                render.accumulate && render.draws > 0 && compare->ceiling == 10 && compare->display.auto_exposure &&
                import.lod == 3 && !import.crs && city.seed == 1 &&
                (&noc_display_default_params())->compensation == 0 && (&noc_device_default_params())->threads == 0 &&
                (&noc_log_default_params())->level == NOC_LOG_WARN && noc_lab_measure_default_params().frames == 20 &&
                noc_lab_measure_default_params().compare.ceiling == 10 &&
                noc_lab_reference_default_params().frames == 16 && !noc_lab_default_params().folder &&
                noc_camera_default_params().viewpoint == NOC_VIEWPOINT_OWN;
    return good ? 0 : 1;
}
