/* NULL where a pointer should be: a status, not a crash. Each call is made by a process of its own. */
#include "../test.h"
#include "../own_view.h"

#include <nocturne/nocturne.h>

#include <ctype.h>
#include <glob.h>
#include <math.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

static noc_scene *scene;
static noc_view *view;
static noc_image *image;
static noc_channel *channel;
static noc_camera camera;

#define PROBES(P)                                                                                                      \
    P(noc_image_destroy(NULL), true)                                                                                   \
    P(0, isfinite(noc_image_auto_ev100(NULL)))                                                                         \
    P(0, noc_image_to_srgb8(NULL, NULL, (uint8_t[3]){ 0 }) == NOC_ERR_ARGUMENT)                                        \
    P(0, noc_image_to_srgb8(image, NULL, NULL) == NOC_ERR_ARGUMENT)                                                    \
    P(0, noc_image_write(NULL, "a.png", NULL, NULL, NULL) == NOC_ERR_ARGUMENT)                                         \
    P(0, noc_image_write(image, NULL, NULL, NULL, NULL) == NOC_ERR_ARGUMENT)                                           \
    P(0, noc_image_write_srgb8(NULL, 1, 1, "a.png", NULL, NULL) == NOC_ERR_ARGUMENT)                                   \
    P(0, noc_image_write_srgb8((uint8_t[3]){ 0 }, 1, 1, NULL, NULL, NULL) == NOC_ERR_ARGUMENT)                         \
    P(noc_image_encoder_destroy(noc_image_encoder_create(NULL)), true)                                                 \
    P(noc_image_encoder_destroy(NULL), true)                                                                           \
    P(0, noc_image_encode_srgb8(NULL, NOC_IMAGE_PNG, 0, (uint8_t[3]){ 0 }, 1, 1, &(const uint8_t *){ 0 },              \
                                &(size_t){ 0 }) == NOC_ERR_ARGUMENT)                                                   \
    P(0, noc_image_check_path(NULL, NULL) == NOC_ERR_ARGUMENT)                                                         \
    P(0, noc_image_read(NULL, NULL, NULL) == NULL)                                                                     \
    P(0, noc_image_read_text(NULL, "key", &(char *){ 0 }, NULL) == NOC_ERR_ARGUMENT)                                   \
    P(0, noc_image_read_text("a.png", NULL, &(char *){ 0 }, NULL) == NOC_ERR_ARGUMENT)                                 \
    P(0, noc_image_read_text("a.png", "key", NULL, NULL) == NOC_ERR_ARGUMENT)                                          \
    P(0, noc_image_compare(NULL, image, NULL, &(noc_comparison){ 0 }, NULL) == NOC_ERR_ARGUMENT)                       \
    P(0, noc_image_compare(image, NULL, NULL, &(noc_comparison){ 0 }, NULL) == NOC_ERR_ARGUMENT)                       \
    P(0, noc_image_compare(image, image, NULL, NULL, NULL) == NOC_ERR_ARGUMENT)                                        \
    P(0,                                                                                                               \
      noc_image_difference(NULL, image, NULL, &(uint8_t *){ 0 }, &(int){ 0 }, &(int){ 0 }, NULL) == NOC_ERR_ARGUMENT)  \
    P(0, noc_image_difference(image, image, NULL, NULL, &(int){ 0 }, &(int){ 0 }, NULL) == NOC_ERR_ARGUMENT)           \
    P(0, noc_image_difference(image, image, NULL, &(uint8_t *){ 0 }, NULL, NULL, NULL) == NOC_ERR_ARGUMENT)            \
    P(0, noc_image_difference_bar(NULL, image, NULL, &(noc_bar){ 0 }, NULL) == NOC_ERR_ARGUMENT)                       \
    P(0, noc_image_difference_bar(image, image, NULL, NULL, NULL) == NOC_ERR_ARGUMENT)                                 \
    P(noc_difference_colour(0, NULL), true)                                                                            \
    P(0, !noc_isolines_parse(NULL, &(noc_isolines){ 0 }))                                                              \
    P(0, !noc_isolines_parse("5,", NULL))                                                                              \
    P(0, noc_isolines_text(NULL, NULL, 0) == -1)                                                                       \
    P(noc_channel_destroy(NULL), true)                                                                                 \
    P(0, noc_channel_to_srgb8(NULL, NULL, &(uint8_t *){ 0 }, &(int){ 0 }, &(int){ 0 }, NULL) == NOC_ERR_ARGUMENT)      \
    P(0, noc_channel_to_srgb8(channel, NULL, NULL, NULL, NULL, NULL) == NOC_ERR_ARGUMENT)                              \
    P(0, noc_channel_bar(NULL, NULL, &(noc_bar){ 0 }, NULL) == NOC_ERR_ARGUMENT)                                       \
    P(0, noc_channel_bar(channel, NULL, NULL, NULL) == NOC_ERR_ARGUMENT)                                               \
    P(noc_bar_colour(0, NULL), true)                                                                                   \
    P(noc_label_colour(NULL, 0, NULL), true)                                                                           \
    P(0, noc_channel_write(NULL, "a.png", NULL, NULL, NULL) == NOC_ERR_ARGUMENT)                                       \
    P(0, noc_channel_write(channel, NULL, NULL, NULL, NULL) == NOC_ERR_ARGUMENT)                                       \
    P(noc_log_destroy(NULL), noc_log_last_error(NULL)[0] == 0)                                                         \
    P(noc_log_copy_error(NULL, NULL, 0), true)                                                                         \
    P(noc_scene_destroy(NULL), true)                                                                                   \
    P(0, noc_scene_add_material(NULL, &(noc_material){ .roughness = 1 }) == -1)                                        \
    P(0, noc_scene_add_material(scene, NULL) == -1)                                                                    \
    P(0, noc_scene_add_mesh(NULL, &(noc_mesh){ 0 }) == -1)                                                             \
    P(0, noc_scene_add_mesh(scene, NULL) == -1)                                                                        \
    P(0, noc_scene_add_mesh(scene, &(noc_mesh){ .vertex_count = 3, .triangle_count = 1 }) == -1)                       \
    P(0, noc_scene_add_light(NULL, &(noc_light){ 0 }) == -1)                                                           \
    P(0, noc_scene_add_light(scene, NULL) == -1)                                                                       \
    P(0, noc_scene_commit(NULL) == NOC_ERR_ARGUMENT)                                                                   \
    P(0, noc_scene_move_light(NULL, 0, &(noc_light){ 0 }) == NOC_ERR_ARGUMENT)                                         \
    P(0, noc_scene_move_light(scene, 0, NULL) == NOC_ERR_ARGUMENT)                                                     \
    P(0, noc_scene_add_model(NULL, "car") == -1)                                                                       \
    P(0, noc_scene_add_profile(NULL, NULL) == -1)                                                                      \
    P(0, noc_scene_add_profile(scene, NULL) == -1)                                                                     \
    P(0, noc_scene_set_environment(NULL, NULL) == NOC_ERR_ARGUMENT)                                                    \
    P(0, noc_scene_set_environment(scene, &(noc_image){ .width = 2, .height = 1 }) == NOC_ERR_ARGUMENT)                \
    P(0, noc_scene_add_texture(NULL, NULL) == -1)                                                                      \
    P(0, noc_scene_add_texture(scene, NULL) == -1)                                                                     \
    P(0, (noc_profile_orient(NULL, NULL, NULL, NULL), true))                                                           \
    P(0, noc_scene_add_group(NULL, "street") == -1)                                                                    \
    P(0, noc_scene_add_instance(NULL, &(noc_instance){ 0 }) == -1)                                                     \
    P(0, noc_scene_add_instance(scene, NULL) == -1)                                                                    \
    P(0, noc_scene_set_transform(NULL, 0, (double[12]){ 0 }) == NOC_ERR_ARGUMENT)                                      \
    P(0, noc_scene_set_transform(scene, 0, NULL) == NOC_ERR_ARGUMENT)                                                  \
    P(0, noc_scene_remove_instance(NULL, 0) == NOC_ERR_ARGUMENT)                                                       \
    P(0, noc_scene_instance_light(NULL, 0, 0) == -1)                                                                   \
    P(0, noc_scene_set_time(NULL, 0) == NOC_ERR_ARGUMENT)                                                              \
    P(0, noc_recipe_write(NULL, NULL, 0, NULL, &(char *){ 0 }) == NOC_ERR_ARGUMENT)                                    \
    P(0, noc_recipe_write(&(noc_recipe_info){ 0 }, NULL, 0, NULL, NULL) == NOC_ERR_ARGUMENT)                           \
    P(0, noc_text_utf8(NULL) == 1)                                                                                     \
    P(0, noc_text_yaml(NULL, 0, NULL) == 2)                                                                            \
    P(0, noc_scene_show_cars(NULL, true) == NOC_ERR_ARGUMENT)                                                          \
    P(0, noc_group_state_check(NULL, NULL) == NOC_ERR_ARGUMENT)                                                        \
    P(0, noc_scene_set_windows(NULL, &(noc_window_params){ .hour = 21 }) == NOC_ERR_ARGUMENT)                          \
    P(0, noc_scene_set_windows(scene, NULL) == NOC_ERR_ARGUMENT)                                                       \
    P(0, noc_scene_set_material(NULL, 0, &(noc_material){ .roughness = 1 }) == NOC_ERR_ARGUMENT)                       \
    P(0, noc_scene_set_material(scene, 0, NULL) == NOC_ERR_ARGUMENT)                                                   \
    P(0, noc_scene_set_class_material(NULL, NOC_CLASS_WALL, &(noc_material){ .roughness = 1 }) == NOC_ERR_ARGUMENT)    \
    P(0, noc_scene_set_class_material(scene, NOC_CLASS_WALL, NULL) == NOC_ERR_ARGUMENT)                                \
    P(0, noc_scene_set_emission(NULL, 0, (float[3]){ 0 }) == NOC_ERR_ARGUMENT)                                         \
    P(0, noc_scene_set_emission(scene, 0, NULL) == NOC_ERR_ARGUMENT)                                                   \
    P(0, noc_scene_set_group(NULL, 1, (float[3]){ 0 }) == NOC_ERR_ARGUMENT)                                            \
    P(0, noc_scene_set_group(scene, 1, NULL) == NOC_ERR_ARGUMENT)                                                      \
    P(0, noc_scene_colour_group(NULL, 1, NULL) == NOC_ERR_ARGUMENT)                                                    \
    P(noc_material_metal(NULL, 1), true)                                                                               \
    P(0, noc_scene_name_material(NULL, 0, "a") == NOC_ERR_ARGUMENT)                                                    \
    P(0, noc_scene_find_material(NULL, "a", 0) == -1 && noc_scene_find_material(scene, NULL, 0) == -1)                 \
    P(0, noc_scene_get_material(NULL, 0, NULL, NULL) == NOC_ERR_ARGUMENT)                                              \
    P(0, noc_scene_find_group(NULL, "lamps") == 0 && noc_scene_find_group(scene, NULL) == 0)                           \
    P(0, noc_scene_groups(NULL, NULL, 1) == 0 && noc_scene_groups(scene, NULL, 1) > 0)                                 \
    P(0, noc_scene_say_group(NULL, 1, "off") == NOC_ERR_ARGUMENT)                                                      \
    P(0, noc_scene_say_group(scene, 1, NULL) == NOC_ERR_ARGUMENT)                                                      \
    P(0, noc_condition_check(NULL, NULL) == NOC_ERR_ARGUMENT)                                                          \
    P(0, noc_condition_check(&(noc_condition){ 0 }, NULL) == NOC_ERR_ARGUMENT)                                         \
    P(noc_kelvin_rgb(3000, NULL), true)                                                                                \
    P(0, isnan(noc_rgb_kelvin(NULL)))                                                                                  \
    P(0, noc_scene_remove_light(NULL, 0) == NOC_ERR_ARGUMENT)                                                          \
    P(0, noc_scene_remove_mesh(NULL, 0) == NOC_ERR_ARGUMENT)                                                           \
    P(0, noc_scene_save(NULL, "a.noct", NULL) == NOC_ERR_ARGUMENT)                                                     \
    P(0, noc_scene_save(scene, NULL, NULL) == NOC_ERR_ARGUMENT)                                                        \
    P(0, noc_built_is(NULL) == false)                                                                                  \
    P(0, noc_built_get_info(NULL, NULL, &(noc_built_info){ 0 }) == NOC_ERR_ARGUMENT)                                   \
    P(0, noc_built_get_info("a.noct", NULL, NULL) == NOC_ERR_ARGUMENT)                                                 \
    P(0, noc_built_get_tile(NULL, NULL, &(noc_tile_info){ 0 }) == NOC_ERR_ARGUMENT)                                    \
    P(0, noc_built_get_tile("a.noct", NULL, NULL) == NOC_ERR_ARGUMENT)                                                 \
    P(0, noc_tiles_write(NULL, NULL, NULL, 0, NULL) == NOC_ERR_ARGUMENT)                                               \
    P(0, noc_tiles_write("a", NULL, NULL, 1, NULL) == NOC_ERR_ARGUMENT)                                                \
    P(0, noc_tiles_is(NULL) == false)                                                                                  \
    P(0, noc_tiles_find(NULL, NULL, NULL, &(char **){ 0 }, &(size_t){ 0 }) == NOC_ERR_ARGUMENT)                        \
    P(0, noc_tiles_find("a", NULL, NULL, NULL, &(size_t){ 0 }) == NOC_ERR_ARGUMENT)                                    \
    P(0, noc_tiles_find("a", NULL, NULL, &(char **){ 0 }, NULL) == NOC_ERR_ARGUMENT)                                   \
    P(0, noc_built_get_recipe(NULL, NULL, &(char *){ 0 }) == NOC_ERR_ARGUMENT)                                         \
    P(0, noc_built_get_recipe("a.noct", NULL, NULL) == NOC_ERR_ARGUMENT)                                               \
    P(0, noc_scene_get_light(NULL, 0, &(noc_light_info){ 0 }) == NOC_ERR_ARGUMENT)                                     \
    P(0, noc_scene_get_light(scene, 0, NULL) == NOC_ERR_ARGUMENT)                                                      \
    P(0, noc_scene_object_name(NULL, 0) == NULL)                                                                       \
    P(0, noc_scene_set_crs(NULL, "EPSG:25832", (double[3]){ 0 }) == NOC_ERR_ARGUMENT)                                  \
    P(0, noc_scene_set_crs(scene, NULL, NULL) == NOC_ERR_ARGUMENT)                                                     \
    P(noc_scene_get_info(NULL, &(noc_scene_info){ 0 }), true)                                                          \
    P(noc_scene_get_info(scene, NULL), true)                                                                           \
    P((noc_scene_content(NULL, (char[NOC_CONTENT_KEY]){ 0 })), true)                                                   \
    P(0, noc_scene_find_source(NULL, "a", NULL) == NULL)                                                               \
    P(0, noc_scene_find_source(scene, NULL, NULL) == NULL)                                                             \
    P(noc_scene_content(scene, NULL), true)                                                                            \
    P(0, !noc_scene_ground(NULL, 0, 0, &(double){ 0 }))                                                                \
    P(0, !noc_scene_ground(scene, 0, 0, NULL))                                                                         \
    P(0, noc_scene_set_camera(NULL, &camera) == NOC_ERR_ARGUMENT)                                                      \
    P(0, noc_scene_set_camera(scene, NULL) == NOC_ERR_ARGUMENT)                                                        \
    P(0, noc_scene_camera(NULL, NOC_VIEWPOINT_AERIAL, 1, &camera) == NOC_ERR_ARGUMENT)                                 \
    P(0, noc_scene_camera(scene, NOC_VIEWPOINT_AERIAL, 1, NULL) == NOC_ERR_ARGUMENT)                                   \
    P(0, !noc_camera_project(NULL, 4, 4, (double[3]){ 0 }, (double[2]){ 0 }, NULL))                                    \
    P(0, !noc_camera_project(&camera, 4, 4, NULL, NULL, NULL))                                                         \
    P(0, noc_camera_ray(NULL, 4, 4, (double[2]){ 0 }, &(noc_ray){ 0 }) == NOC_ERR_ARGUMENT)                            \
    P(0, noc_camera_ray(&camera, 4, 4, NULL, NULL) == NOC_ERR_ARGUMENT)                                                \
    P(0, noc_camera_unproject(NULL, 4, 4, (double[2]){ 0 }, 1, (double[3]){ 0 }) == NOC_ERR_ARGUMENT)                  \
    P(0, noc_camera_unproject(&camera, 4, 4, NULL, 1, NULL) == NOC_ERR_ARGUMENT)                                       \
    P(0, noc_scene_add_city(NULL, NULL) == NOC_ERR_ARGUMENT)                                                           \
    P(0, noc_scene_add_builtin(NULL, "city", NULL) == NOC_ERR_ARGUMENT)                                                \
    P(0, noc_scene_add_builtin(scene, NULL, NULL) == NOC_ERR_ARGUMENT)                                                 \
    P(0, noc_report_file_count(NULL) == 0 && !noc_report_get_file(NULL, 0))                                            \
    P(noc_report_get_totals(NULL, NULL), true)                                                                         \
    P(0, !noc_report_get_lamp(NULL, 0))                                                                                \
    P(0, !noc_report_get_rule(NULL, 0) && !noc_report_get_group(NULL, 0))                                              \
    P(0, noc_report_follow(NULL, scene) == NOC_ERR_ARGUMENT)                                                           \
    P(noc_report_destroy(NULL), true)                                                                                  \
    P(0, noc_scene_load(NULL, (const char *[]){ "a" }, 1, NULL, NULL) == NOC_ERR_ARGUMENT)                             \
    P(0, noc_scene_load(noc_scene_create(NULL), NULL, 1, NULL, NULL) == NOC_ERR_ARGUMENT)                              \
    P(0, noc_scene_load(noc_scene_create(NULL), (const char *[]){ NULL }, 1, NULL, NULL) == NOC_ERR_ARGUMENT)          \
    P(0, noc_inspect(NULL, NULL, NULL, NULL) == NOC_ERR_ARGUMENT)                                                      \
    P(0, noc_scene_to_local(NULL, NULL, (double[3]){ 0 }) == NOC_ERR_ARGUMENT)                                         \
    P(0, noc_scene_to_local(scene, NULL, NULL) == NOC_ERR_ARGUMENT)                                                    \
    P(0, noc_scene_from_local_all(NULL, NULL, (double[3]){ 0 }, 1) == NOC_ERR_ARGUMENT)                                \
    P(0, noc_scene_from_local_all(scene, NULL, NULL, 1) == NOC_ERR_ARGUMENT)                                           \
    P(0, noc_scene_from_local(NULL, NULL, (double[3]){ 0 }) == NOC_ERR_ARGUMENT)                                       \
    P(0, noc_scene_from_local(scene, NULL, NULL) == NOC_ERR_ARGUMENT)                                                  \
    P(0, noc_scene_place_camera(NULL, NULL, 1, &camera, NULL) == NOC_ERR_ARGUMENT)                                     \
    P(0, noc_scene_place_camera(scene, NULL, 1, NULL, NULL) == NOC_ERR_ARGUMENT)                                       \
    P(0, noc_option_needs_input(NULL, NULL, 1) == NULL)                                                                \
    P(0, noc_option_needs_input(noc_city_options(), NULL, 1) != NULL)                                                  \
    P(0, noc_image_is_black(NULL))                                                                                     \
    P(0, noc_profile_load(NULL, NULL, &(noc_profile *){ 0 }) == NOC_ERR_ARGUMENT)                                      \
    P(0, noc_profile_load(NULL, "a.ies", NULL) == NOC_ERR_ARGUMENT)                                                    \
    P(0, noc_profile_read(NULL, NULL, 1, "a", &(noc_profile *){ 0 }) == NOC_ERR_ARGUMENT)                              \
    P(0, noc_profile_read(NULL, "a", 1, NULL, &(noc_profile *){ 0 }) == NOC_ERR_ARGUMENT)                              \
    P(0, noc_profile_read(NULL, "a", 1, "a", NULL) == NOC_ERR_ARGUMENT)                                                \
    P(0, noc_profile_create(NULL, NULL, &(noc_profile *){ 0 }) == NOC_ERR_ARGUMENT)                                    \
    P(0, noc_profile_create(NULL, &(noc_profile_params){ .planes = 1 }, &(noc_profile *){ 0 }) == NOC_ERR_ARGUMENT)    \
    P(0, noc_profile_builtin(NULL, NULL, &(noc_profile *){ 0 }) == NOC_ERR_ARGUMENT)                                   \
    P(0, noc_profile_builtin(NULL, "wall", NULL) == NOC_ERR_ARGUMENT)                                                  \
    P(0, noc_profile_builtin_name(-1) == NULL)                                                                         \
    P(0, (noc_profile_destroy(NULL), true))                                                                            \
    P(0, (noc_profile_get_info(NULL, NULL), true))                                                                     \
    P(0, noc_profile_intensity(NULL, 0, 0) == 0)                                                                       \
    P(0, noc_profile_flux(NULL, 0, 90, 0) == 0)                                                                        \
    P(0, !noc_profile_probe(NULL, 9))                                                                                  \
    P(0, noc_text_count(NULL, 1)[0] == 0)                                                                              \
    P(0, noc_text_many(NULL, 1, "a")[0] == 0)                                                                          \
    P(0, noc_text_many((char[64]){ 0 }, 1, NULL)[0] == '1')                                                            \
    P(0, noc_text_bytes(NULL, 1)[0] == 0)                                                                              \
    P(0, noc_text_seconds(NULL, 1)[0] == 0)                                                                            \
    P(0, noc_text_clean(NULL, 1, "a")[0] == 0)                                                                         \
    P(0, noc_text_clean((char[4]){ 1 }, 4, NULL)[0] == 0)                                                              \
    P(0, noc_text_fold(NULL, true) == NULL)                                                                            \
    P(0, noc_text_nearest(NULL, NULL, 1) == NULL)                                                                      \
    P(0, noc_text_save(NULL, "a", 1, NULL) == NOC_ERR_ARGUMENT)                                                        \
    P(0, noc_text_save("/nonexistent/a", NULL, 1, NULL) == NOC_ERR_ARGUMENT)                                           \
    P(0, !noc_text_numbers(NULL, ',', 1, &(double){ 0 }))                                                              \
    P(0, !noc_text_numbers("1", ',', 1, NULL))                                                                         \
    P(0, noc_lab_reference(NULL, scene, &camera, NULL, NULL, &(noc_image *){ 0 }, NULL, NULL) == NOC_ERR_ARGUMENT)     \
    P(0,                                                                                                               \
      noc_lab_measure(NULL, scene, &camera, NULL, image, NULL, &(noc_lab_frame){ 0 }, NULL, NULL) == NOC_ERR_ARGUMENT) \
    P(0, noc_lab_spec_read(NULL, &(noc_lab_spec *){ 0 }, NULL) == NOC_ERR_ARGUMENT)                                    \
    P(0, noc_lab_spec_read("a.json", NULL, NULL) == NOC_ERR_ARGUMENT)                                                  \
    P(0, noc_lab_spec_parse(NULL, "a.json", &(noc_lab_spec *){ 0 }, NULL) == NOC_ERR_ARGUMENT)                         \
    P(0, noc_lab_spec_parse("{}", NULL, &(noc_lab_spec *){ 0 }, NULL) == NOC_ERR_ARGUMENT)                             \
    P(0, noc_lab_spec_parse("{}", "a.json", NULL, NULL) == NOC_ERR_ARGUMENT)                                           \
    P(noc_lab_spec_destroy(NULL), true)                                                                                \
    P(noc_lab_spec_get_info(NULL, &(noc_lab_spec_info){ 0 }), true)                                                    \
    P(noc_lab_spec_get_info(NULL, NULL), true)                                                                         \
    P(0, noc_lab_spec_get_camera(NULL, 0, &(noc_lab_camera_info){ 0 }) == NOC_ERR_ARGUMENT)                            \
    P(0, noc_lab_spec_get_config(NULL, 0, &(noc_lab_config_info){ 0 }) == NOC_ERR_ARGUMENT)                            \
    P(0, noc_lab_create(NULL, NULL, &(noc_lab *){ 0 }, NULL) == NOC_ERR_ARGUMENT)                                      \
    P(0, noc_lab_create(NULL, NULL, NULL, NULL) == NOC_ERR_ARGUMENT)                                                   \
    P(0, noc_lab_join(NULL, NULL, &(bool){ 0 }, NULL) == NOC_ERR_ARGUMENT)                                             \
    P(0, noc_lab_join(NULL, NULL, NULL, NULL) == NOC_ERR_ARGUMENT)                                                     \
    P(noc_lab_destroy(NULL), true)                                                                                     \
    P(0, noc_lab_run(NULL) == NOC_ERR_ARGUMENT)                                                                        \
    P(0, noc_lab_write_report(NULL) == NOC_ERR_ARGUMENT)                                                               \
    P(noc_lab_get_state(NULL, &(noc_lab_state){ 0 }), true)                                                            \
    P(noc_lab_get_state(NULL, NULL), true)                                                                             \
    P(0, !noc_lab_get_row(NULL, 0, &(noc_lab_row){ 0 }))                                                               \
    P(0, noc_option_set(NULL, &camera, "1", NULL) == NOC_ERR_ARGUMENT)                                                 \
    P(0, noc_option_set(noc_render_options(), NULL, "1", NULL) == NOC_ERR_ARGUMENT)                                    \
    P(0, noc_option_get(NULL, &camera, (char[8]){ 0 }, 8) == 0)                                                        \
    P(0, noc_option_get(noc_render_options(), NULL, (char[8]){ 0 }, 8) == 0)                                           \
    P(0, noc_option_check(NULL, &camera, "", NULL) == NOC_ERR_ARGUMENT)                                                \
    P(0, noc_option_check(noc_render_options(), NULL, "", NULL) == NOC_ERR_ARGUMENT)                                   \
    P(0, noc_option_size(NULL) == 0)                                                                                   \
    P(0, !noc_option_idle(NULL, NULL, NULL, (char[8]){ 0 }, 8))                                                        \
    P(0, !noc_recipe_is(NULL))                                                                                         \
    P(0, noc_recipe_load(NULL, NULL, &(noc_recipe *){ 0 }) == NOC_ERR_ARGUMENT)                                        \
    P(0, noc_recipe_load("a.yaml", NULL, NULL) == NOC_ERR_ARGUMENT)                                                    \
    P(noc_recipe_destroy(NULL), true)                                                                                  \
    P(0, noc_recipe_get_info(NULL)->input_count == 0)                                                                  \
    P(noc_recipe_lists(NULL, NULL), true)                                                                              \
    P(0, noc_recipe_option(NULL, 0) == NULL)                                                                           \
    P(0, noc_recipe_set(NULL, noc_render_options(), &camera, NULL) == NOC_ERR_ARGUMENT)                                \
    P(0, noc_camera_path_create(NULL, 1, false, 0, NULL, &(noc_camera_path *){ 0 }) == NOC_ERR_ARGUMENT)               \
    P(0, noc_camera_path_create(&(noc_camera_key){ 0 }, 1, false, 0, NULL, NULL) == NOC_ERR_ARGUMENT)                  \
    P(0, noc_camera_path_orbit(NULL, 0, NULL, &(noc_camera_path *){ 0 }) == NOC_ERR_ARGUMENT)                          \
    P(0, noc_camera_path_orbit(&camera, 0, NULL, NULL) == NOC_ERR_ARGUMENT)                                            \
    P(0, noc_camera_path_pan(NULL, 0, NULL, &(noc_camera_path *){ 0 }) == NOC_ERR_ARGUMENT)                            \
    P(0, noc_camera_path_pan(&camera, 0, NULL, NULL) == NOC_ERR_ARGUMENT)                                              \
    P(0, noc_scene_orbit(NULL, &camera, 0, &(noc_camera_path *){ 0 }) == NOC_ERR_ARGUMENT)                             \
    P(0, noc_scene_orbit(scene, NULL, 0, &(noc_camera_path *){ 0 }) == NOC_ERR_ARGUMENT)                               \
    P(0, noc_scene_orbit(scene, &camera, 0, NULL) == NOC_ERR_ARGUMENT)                                                 \
    P(noc_camera_path_destroy(NULL), true)                                                                             \
    P(0, noc_camera_path_seconds(NULL) == 0)                                                                           \
    P(0, !noc_camera_path_loops(NULL))                                                                                 \
    P(0, noc_camera_path_at(NULL, 0, &camera) == NOC_ERR_ARGUMENT)                                                     \
    P(0, noc_camera_path_hour(NULL, 0) < 0)                                                                            \
    P(0,                                                                                                               \
      noc_scene_place_path(NULL, &(noc_path_key){ 0 }, 1, false, 0, 1, &(noc_camera_path *){ 0 }) == NOC_ERR_ARGUMENT) \
    P(0, noc_scene_place_path(scene, NULL, 1, false, 0, 1, &(noc_camera_path *){ 0 }) == NOC_ERR_ARGUMENT)             \
    P(0, noc_scene_place_path(scene, &(noc_path_key){ 0 }, 1, false, 0, 1, NULL) == NOC_ERR_ARGUMENT)                  \
    P(0, noc_material_wet(NULL).f0 > 0)                                                                                \
    P(noc_render_use_preset(NULL, NOC_PRESET_STILL), true)                                                             \
    P(noc_device_destroy(noc_device_create(NULL, NULL)), true)                                                         \
    P(noc_device_destroy(NULL), true)                                                                                  \
    P(0, noc_devices(NULL, 1) >= 2)                                                                                    \
    P(0, noc_device_find(NULL, NULL, NULL) == NOC_ERR_ARGUMENT)                                                        \
    P(0, noc_device_get_info(NULL) == NULL)                                                                            \
    P(0, noc_view_create(NULL, scene) == NULL)                                                                         \
    P(0, noc_view_create(noc_view_device(view), NULL) == NULL)                                                         \
    P(0, noc_view_device(NULL) == NULL)                                                                                \
    P(noc_view_destroy(NULL), true)                                                                                    \
    P(0, noc_render_check(NULL, NULL) == NOC_ERR_ARGUMENT)                                                             \
    P(0, noc_view_render(NULL, &camera, NULL, NULL) == NOC_ERR_ARGUMENT)                                               \
    P(0, noc_view_render(view, NULL, NULL, NULL) == NOC_ERR_ARGUMENT)                                                  \
    P(noc_view_restart(NULL), true)                                                                                    \
    P(noc_view_reset(NULL), true)                                                                                      \
    P(0, noc_view_image(NULL) == NULL)                                                                                 \
    P(0, noc_view_aov(NULL, NOC_AOV_LIGHT) == NULL)                                                                    \
    P(noc_view_get_stats(NULL, &(noc_frame_stats){ 0 }), true)                                                         \
    P(noc_view_get_stats(view, NULL), true)                                                                            \
    P(noc_view_light_stats(NULL, &(noc_light_stats){ 0 }), true)                                                       \
    P(noc_view_light_stats(view, NULL), true)                                                                          \
    P(0, noc_view_cast(NULL, &(noc_ray){ 0 }, 1, &(noc_hit){ 0 }) == NOC_ERR_ARGUMENT)                                 \
    P(0, noc_view_cast(view, NULL, 1, NULL) == NOC_ERR_ARGUMENT)                                                       \
    P(0, noc_view_cast_down(NULL, &(double[2]){ 0 }, 1, 0, &(noc_hit){ 0 }) == NOC_ERR_ARGUMENT)                       \
    P(0, noc_view_cast_down(view, NULL, 1, 0, NULL) == NOC_ERR_ARGUMENT)                                               \
    P(0, noc_measure_least(NULL, NULL, 0, NULL, NULL, NULL, NULL, NULL) == NOC_ERR_ARGUMENT)                           \
    P(0, noc_measure_points(NULL, NULL, 0, NULL, NULL, NULL, NULL) == NOC_ERR_ARGUMENT)                                \
    P(0, noc_measure_points(view, NULL, 1, NULL, NULL, NULL, NULL) == NOC_ERR_ARGUMENT)                                \
    P(0, noc_measure_raster(NULL, NULL, NULL, NULL, NULL) == NULL)                                                     \
    P(0, noc_raster_write(NULL, "a.tif", NULL, NULL) == NOC_ERR_ARGUMENT)                                              \
    P(0, noc_lux_figures_of(NULL, NULL, 1, &(noc_lux_figures){ 0 }, NULL) == NOC_ERR_ARGUMENT)                         \
    P(0, noc_lux_figures_of(NULL, NULL, 0, NULL, NULL) == NOC_ERR_ARGUMENT)                                            \
    P(0, noc_scene_to_local_all(NULL, NULL, NULL, 0) == NOC_ERR_ARGUMENT)                                              \
    P(0, noc_scene_crs_wkt(NULL, NULL) == NULL)                                                                        \
    P(0, !noc_region_get_patch(NULL, 0, NULL))                                                                         \
    P(noc_raster_destroy(NULL), true)                                                                                  \
    P(0, noc_navigator_create(NULL, NULL, NULL) == NULL)                                                               \
    P(0, noc_navigator_create(scene, NULL, NULL) == NULL)                                                              \
    P(noc_navigator_destroy(NULL), true)                                                                               \
    P(0, noc_navigator_input(NULL, &(noc_navigate_input){ 0 }, NULL) == NOC_ERR_ARGUMENT)                              \
    P(noc_navigator_camera(NULL, &(noc_camera){ 0 }), !noc_navigator_moves(NULL))                                      \
    P(0, noc_navigator_set_mode(NULL, NOC_NAVIGATE_FLY) == NOC_ERR_ARGUMENT)                                           \
    P(0, noc_navigator_set_speed(NULL, 1) == NOC_ERR_ARGUMENT)                                                         \
    P(0, noc_navigator_mode(NULL) == NOC_NAVIGATE_ORBIT && noc_navigator_speed(NULL) == 0)                             \
    P(0, noc_navigator_set_camera(NULL, &camera) == NOC_ERR_ARGUMENT)                                                  \
    P(0, noc_navigator_go(NULL, &camera) == NOC_ERR_ARGUMENT)                                                          \
    P(0, !noc_navigator_look(NULL, (double[3]){ 0 }, 1))                                                               \
    P(0, noc_report_find_lamp(NULL, 0) == NULL)                                                                        \
    P(0, noc_view_buried(NULL, scene, (double[3]){ 0 }, (char[8]){ 0 }, 8) == NOC_ERR_ARGUMENT)                        \
    P(0, noc_influence_csv(NULL, NULL, NULL, 0, &(noc_influence_sum){ 0 }, NULL, 0, NULL) == NULL)                     \
    P(0, noc_influence_csv(scene, NULL, NULL, 0, NULL, NULL, 0, NULL) == NULL)                                         \
    P(0, !noc_navigator_jump(NULL, (double[2]){ 0 }, 1))                                                               \
    P(0, noc_camera_align(NULL, 4, 8, 8, NULL, &camera, NULL, NULL) == NOC_ERR_ARGUMENT)                               \
    P(0, noc_scene_photo_camera(NULL, "a.csv", NULL, &camera, NULL) == NOC_ERR_ARGUMENT)                               \
    P(0, noc_scene_photo_camera(scene, NULL, NULL, NULL, NULL) == NOC_ERR_ARGUMENT)                                    \
    P(0, noc_scene_map(NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL) == NOC_ERR_ARGUMENT)                            \
    P(0, noc_scene_map(scene, NULL, NULL, NULL, NULL, NULL, NULL, NULL) == NOC_ERR_ARGUMENT)                           \
    P(0, noc_scene_get_car(NULL, 0, &(noc_car_info){ 0 }) == NOC_ERR_ARGUMENT)                                         \
    P(0, noc_scene_get_car(scene, 0, NULL) == NOC_ERR_ARGUMENT)                                                        \
    P(0, noc_scene_track_count(NULL) == 0 && noc_scene_get_track(NULL, 0, NULL, 0) == 0)                               \
    P(0, noc_view_write_influence(NULL, NULL, "a.obj") == NOC_ERR_ARGUMENT)                                            \
    P(0, noc_view_write_influence(view, NULL, NULL) == NOC_ERR_ARGUMENT)                                               \
    P(0, noc_text_srgb8(NULL, 1, 1, 0, 0, NULL, 1, NULL) == 0)                                                         \
    P(0, noc_text_srgb8((uint8_t[3]){ 0 }, 1, 1, 0, 0, "a", 1, NULL) == 0)                                             \
    P(noc_log_destroy(noc_log_create(NULL)), true)                                                                     \
    P(0, noc_image_create(0, 0, NULL) == NULL)                                                                         \
    P(0, noc_channel_create(0, 0, 1, NULL) == NULL)                                                                    \
    P(0, noc_view_trace_floor(NULL, &camera, NULL, NULL, &(noc_trace_floor){ 0 }) == NOC_ERR_ARGUMENT)                 \
    P(noc_lab_timer_destroy(noc_lab_timer_create(NULL)), true)                                                         \
    P(noc_lab_timer_destroy(NULL), true)                                                                               \
    P(0, noc_lab_timer_add(NULL, &(noc_lab_case){ 0 }, NULL) == NOC_ERR_ARGUMENT)                                      \
    P(0, noc_lab_timer_round(NULL, NULL) == NOC_ERR_ARGUMENT)                                                          \
    P(0, noc_lab_timer_get(NULL, 0, &(noc_lab_times){ 0 }) == NOC_ERR_ARGUMENT)                                        \
    P(0, noc_emitter_kind_name((noc_emitter_kind)99) != NULL)                                                          \
    P(noc_region_destroy(noc_region_create(NULL)), true)                                                               \
    P(noc_region_destroy(NULL), true)                                                                                  \
    P(0, noc_region_add(NULL, NULL, 0) == NOC_ERR_ARGUMENT)                                                            \
    P(noc_region_leave_out(NULL, 1), true)                                                                             \
    P(noc_region_get_info(NULL, &(noc_region_info){ 0 }), true)                                                        \
    P(noc_region_get_info(NULL, NULL), true)                                                                           \
    P(0, noc_region_outline(NULL, NULL, 4) == 0)                                                                       \
    P(0, noc_region_find(NULL, NULL, NULL, NULL, NULL) == NULL)                                                        \
    P(0, noc_region_find(view, scene, NULL, NULL, NULL) == NULL)                                                       \
    P(0, noc_ranking_create(NULL, NULL, NULL) == NULL)                                                                 \
    P(0, noc_sky_read(NULL, NULL) != NULL)                                                                             \
    P(0, noc_exposure_read(NULL, NULL) != NULL)                                                                        \
    P(0, noc_ranking_create(view, NULL, NULL) == NULL)                                                                 \
    P(0, noc_scene_get_emitter(NULL, 0, &(noc_emitter){ 0 }) == NOC_ERR_ARGUMENT)                                      \
    P(0, noc_scene_get_emitter(scene, 0, NULL) == NOC_ERR_ARGUMENT)                                                    \
    P(0, noc_view_reach(NULL, 0, NULL, &(noc_reach){ 0 }, NULL, 0, NULL) == NOC_ERR_ARGUMENT)                          \
    P(0, noc_view_reach(view, 0, NULL, NULL, NULL, 0, NULL) == NOC_ERR_ARGUMENT)                                       \
    P(0, noc_region_add_object(NULL, scene, "a", 0) == NOC_ERR_ARGUMENT)                                               \
    P(0, noc_scene_object_slots(NULL) == 0)                                                                            \
    P(0, noc_scene_streets(NULL) == 0)                                                                                 \
    P(0, !noc_scene_get_street(NULL, 0, &(noc_street){ 0 }))                                                           \
    P(0, !noc_scene_get_street(scene, 0, NULL))                                                                        \
    P(0, noc_rings_read(NULL, &(noc_rings){ 0 }, NULL) == NOC_ERR_ARGUMENT)                                            \
    P(0, noc_rings_read("a.json", NULL, NULL) == NOC_ERR_ARGUMENT)                                                     \
    P(0, noc_rings_parse(NULL, &(noc_rings){ 0 }, NULL) == NOC_ERR_ARGUMENT)                                           \
    P(noc_rings_free(NULL), true)                                                                                      \
    P(0, noc_smoother_create(NULL) == NULL)                                                                            \
    P(noc_smoother_destroy(NULL), true)                                                                                \
    P(0, noc_smoother_step(NULL, NULL, NULL) == NULL)                                                                  \
    P(noc_smoother_reset(NULL), true)                                                                                  \
    P(0, noc_still_aovs(NULL) != 0)                                                                                    \
    P(0, noc_view_smoothed(NULL) == NULL)                                                                              \
    P(noc_ranking_destroy(NULL), true)                                                                                 \
    P(0, noc_ranking_refine(NULL, NULL, NULL) == NOC_ERR_ARGUMENT)                                                     \
    P(0, noc_ranking_get(NULL, NULL, 0, NULL, NULL) == NOC_ERR_ARGUMENT)                                               \
    P(0, noc_ranking_get_classes(NULL, NULL, 0, NULL) == NOC_ERR_ARGUMENT)                                             \
    P(noc_hit_patch(NULL, 1, NULL, NULL), true)                                                                        \
    P(0, noc_view_trace_floor(view, NULL, NULL, NULL, NULL) == NOC_ERR_ARGUMENT)

#define NAME(call, check) #call " / " #check,
static const char *const names[] = { PROBES(NAME) };

static bool probe(int index) {
    int at = 0;
#define RUN(call, check)                                                                                               \
    if (at++ == index) {                                                                                               \
        (void)(call);                                                                                                  \
        return check;                                                                                                  \
    }
    PROBES(RUN)
    return false;
}

static void null_is_no_crash(void **state) {
    int failed = 0;
    scene = noc_scene_create(NULL);
    image = noc_image_create(2, 2, NULL);
    channel = noc_channel_create(2, 2, 1, NULL);
    camera = noc_camera_default();
    camera.target[0] = 1;
    noc_scene *other = noc_scene_create(NULL);
    noc_scene_commit(other);
    for (int i = 0; i < (int)(sizeof(names) / sizeof(*names)); i++) {
        pid_t child = fork();
        if (!child) {
            signal(SIGSEGV, SIG_DFL); /* cmocka's handler would go on with the next test */
            signal(SIGABRT, SIG_DFL);
            view = own_view(other, 1, NULL);
            _exit(probe(i) ? 0 : 1);
        }
        int status;
        assert_true(waitpid(child, &status, 0) == child);
        bool ok = WIFEXITED(status) && WEXITSTATUS(status) == 0;
        if (!ok)
            print_message("%s: %s\n", names[i], WIFSIGNALED(status) ? strsignal(WTERMSIG(status)) : "wrong answer");
        failed += !ok;
    }
    assert_int_equal(failed, 0);
    noc_channel_destroy(channel);
    noc_image_destroy(image);
    noc_scene_destroy(other);
    noc_scene_destroy(scene);
}

static bool is_listed(const char *name) {
    for (size_t i = 0; i < sizeof(names) / sizeof(*names); i++)
        if (strstr(names[i], name))
            return true;
    return false;
}

/* Every function of the header that takes a pointer is listed; returns how many do. */
static int look_into(const char *header) {
    static char text[1 << 18];
    FILE *f = fopen(header, "r");
    assert_non_null(f);
    size_t n = fread(text, 1, sizeof(text) - 1, f);
    assert_true(n < sizeof(text) - 1);
    text[n] = 0;
    fclose(f);
    int found = 0;
    for (char *p = text; (p = strstr(p, "\nNOC_API "));) {
        char *open = strchr(p, '('), *end = strchr(p, ';'), *name = open;
        assert_true(open && end && open < end);
        while (name[-1] == '_' || isalnum((unsigned char)name[-1]))
            name--;
        if (memchr(open, '*', (size_t)(end - open))) {
            open[1] = 0;
            if (!is_listed(name))
                fail_msg("%s: %s) is not among the calls with NULL", header, name);
            found++;
        }
        p = end;
    }
    return found;
}

static void the_list_is_whole(void **state) {
    const char *source = getenv("NOC_SOURCE");
    glob_t headers;
    char pattern[4096];
    if (!source)
        skip();
    snprintf(pattern, sizeof(pattern), "%s/include/nocturne/*.h", source);
    assert_int_equal(glob(pattern, 0, NULL, &headers), 0);
    int found = 0;
    for (size_t i = 0; i < headers.gl_pathc; i++)
        found += look_into(headers.gl_pathv[i]);
    globfree(&headers);
    assert_true(found > 50);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(null_is_no_crash), cmocka_unit_test(the_list_is_whole) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
