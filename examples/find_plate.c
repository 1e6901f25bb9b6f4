/* Teaches a plate and finds it again, in C: what a controller does, with a scan made by hand where
 * a camera's would stand. Prints the pose, and where a gripper goes; returns 0 when it is right. */
#include <flatpose/flatpose.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define WIDTH 320
#define HEIGHT 240

static float x_mm[WIDTH * HEIGHT], y_mm[WIDTH * HEIGHT], z_mm[WIDTH * HEIGHT];

/* Whether a point of the plate's own plane lies on it: 80 x 50 mm, a corner cut, a hole. */
static int is_plate(double x, double y) {
  const double hole_x = x - 20.0, hole_y = y - 5.0;
  return fabs(x) < 40.0 && fabs(y) < 25.0 && x + y < 50.0 &&
         hole_x * hole_x + hole_y * hole_y > 8.0 * 8.0;
}

static void lay_plate(double plate_x_mm, double plate_y_mm, double turn_rad) {
  const double c = cos(turn_rad), s = sin(turn_rad);
  for (int i = 0; i < WIDTH * HEIGHT; ++i) {
    const double dx = x_mm[i] - plate_x_mm, dy = y_mm[i] - plate_y_mm;
    if (is_plate(c * dx + s * dy, c * dy - s * dx)) z_mm[i] = 12.0F;
  }
}

/* A millimetre a pixel: a floor, and 12 mm above it the plate, moved and turned. */
static flatpose_scan scan_of_plate(double plate_x_mm, double plate_y_mm, double turn_rad) {
  flatpose_scan scan = FLATPOSE_SCAN_INIT;
  for (int i = 0; i < WIDTH * HEIGHT; ++i) {
    x_mm[i] = (float)(i % WIDTH);
    y_mm[i] = (float)(i / WIDTH);
    z_mm[i] = 0.0F;
  }
  lay_plate(plate_x_mm, plate_y_mm, turn_rad);
  scan.x_mm = x_mm;
  scan.y_mm = y_mm;
  scan.z_mm = z_mm;
  scan.width_px = WIDTH;
  scan.height_px = HEIGHT;
  scan.pixel_stride_bytes = sizeof(float);
  scan.row_stride_bytes = WIDTH * (int64_t)sizeof(float);
  return scan;
}

static int64_t now_us(void* context) {
  (void)context;
  struct timespec now;
  timespec_get(&now, TIME_UTC);
  return (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000;
}

static void check(flatpose_status status, const char* what) {
  if (status == FLATPOSE_STATUS_OK) return;
  fprintf(stderr, "%s: %s\n", what, flatpose_status_text(status));
  exit(2);
}

int main(void) {
  flatpose_limits limits = FLATPOSE_LIMITS_INIT;
  limits.scan_width_px = WIDTH;
  limits.scan_height_px = HEIGHT;
  limits.cell_count = 200000;
  limits.can_teach = 1;

  /* A controller has these as static arrays. */
  const size_t finder_bytes = flatpose_required_bytes(&limits);
  const size_t part_bytes = flatpose_part_required_bytes();
  void* finder_memory = malloc(finder_bytes);
  void* part_memory = malloc(part_bytes);
  if (finder_memory == NULL || part_memory == NULL) return 2;
  flatpose_finder* finder = NULL;
  check(flatpose_init(&limits, finder_memory, finder_bytes, &finder), "init");

  flatpose_teach_config lesson = FLATPOSE_TEACH_CONFIG_INIT;
  lesson.name = "plate";
  lesson.has_origin = 1;
  lesson.origin_xy_mm[0] = 160.0;
  lesson.origin_xy_mm[1] = 120.0;
  const flatpose_scan taught = scan_of_plate(160.0, 120.0, 0.0);
  const flatpose_scan* const scans[] = {&taught};
  flatpose_part* part = NULL;
  check(flatpose_teach(finder, scans, 1, &lesson, part_memory, part_bytes, &part), "teach");
  flatpose_part_info info = FLATPOSE_PART_INFO_INIT;
  check(flatpose_part_describe(part, &info), "describe");

  const double turn_rad = 0.7;
  const flatpose_scan scan = scan_of_plate(130.0, 90.0, turn_rad);
  lay_plate(250.0, 170.0, 2.0);
  flatpose_config config = FLATPOSE_CONFIG_INIT;
  config.max_matches = 2;
  /* The second one lies where rejects are put, and is none of ours; nor is what is piled up. */
  const double rejects[] = {200.0, 120.0, 320.0, 240.0};
  flatpose_region exclusion = {FLATPOSE_REGION_BOX, 0.0, 0.0, 0.0, 2, NULL};
  exclusion.vertices_xy_mm = rejects;
  config.exclusions = &exclusion;
  config.exclusion_count = 1;
  config.has_heights = 1;
  config.height_min_mm = 8.0;
  config.height_max_mm = 16.0;
  config.deadline_us = 10000000;
  flatpose_host host = FLATPOSE_HOST_INIT;
  host.now_us = now_us;
  flatpose_result result = FLATPOSE_RESULT_INIT;
  check(flatpose_locate(finder, part, &scan, &config, &host, &result), "locate");
  printf("%s: %s, %d found in %.1f ms, %zu bytes\n", info.name,
         flatpose_outcome_name(result.outcome), (int)result.match_count,
         (double)result.total_us / 1000.0, finder_bytes);
  if (result.match_count != 1) return 1;

  flatpose_match match = FLATPOSE_MATCH_INIT;
  check(flatpose_match_at(finder, 0, &match), "match");
  printf("at (%.2f %.2f %.2f) mm, score %.2f, sigma %.3f mm\n", match.pose.position_mm[0],
         match.pose.position_mm[1], match.pose.position_mm[2], match.score, match.sigma_mm[0]);
  /* The turn from where it was taught. */
  const double* now = match.pose.rotation;
  const double* then = info.taught.rotation;
  const double cosine = now[0] * then[0] + now[3] * then[3];
  const double turned_rad = acos(cosine < 1.0 ? cosine : 1.0);
  /* The hole's middle, where a gripper goes in, from above: its z into the surface. */
  flatpose_pick pick = FLATPOSE_PICK_INIT;
  pick.object_T_pick.rotation[4] = pick.object_T_pick.rotation[8] = -1.0;
  pick.object_T_pick.position_mm[0] = 20.0;
  pick.object_T_pick.position_mm[1] = 5.0;
  check(flatpose_pick_at(finder, 0, &pick, &match), "pick");
  printf("pick at (%.2f %.2f %.2f) mm, sigma %.3f mm\n", match.pose.position_mm[0],
         match.pose.position_mm[1], match.pose.position_mm[2], match.sigma_mm[0]);
  free(finder_memory);
  free(part_memory);
  return fabs(turned_rad - turn_rad) < 0.02 ? 0 : 1;
}
