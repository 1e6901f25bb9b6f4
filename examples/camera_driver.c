/* A camera driver for flatposed in C, as short as one can be:
 *
 *   cc camera_driver.c $(pkg-config --cflags --libs flatpose-camera) -o camera_driver
 *   ./camera_driver /run/flatpose/camera.sock
 *
 * The daemon's config names that socket: [source] driver = "/run/flatpose/camera.sock". Where this
 * one makes a plane up, call your camera's library, and leave the word `simulated` out.
 */
#include <math.h>
#include <stdio.h>
#include <threads.h>
#include <time.h>

#include "flatpose/camera.h"

enum { WIDTH_PX = 320, HEIGHT_PX = 240 };

/* x y z of every pixel, mm, row by row; NaN where the camera has seen nothing. */
static void take_picture(float* xyz_mm) {
  for (int row = 0; row < HEIGHT_PX; ++row) {
    for (int column = 0; column < WIDTH_PX; ++column, xyz_mm += 3) {
      xyz_mm[0] = 0.5F * (float)column;
      xyz_mm[1] = 0.5F * (float)row;
      xyz_mm[2] = column == 0 ? NAN : 300.0F;
    }
  }
}

/* Until the daemon is gone. */
static void serve(flatpose_camera* camera) {
  flatpose_camera_request request;
  while (flatpose_camera_wait(camera, -1, &request) == FLATPOSE_CAMERA_OK) {
    if (camera->width_px_max < WIDTH_PX || camera->height_px_max < HEIGHT_PX) {
      flatpose_camera_failed(camera, &request, "the daemon takes smaller scans only");
      continue;
    }
    flatpose_camera_scan scan = flatpose_camera_interleaved(WIDTH_PX, HEIGHT_PX);
    scan.start_us = flatpose_camera_now_us(); /* what was acquired before does not count */
    take_picture((float*)(void*)camera->memory);
    scan.end_us = flatpose_camera_now_us();
    scan.up = FLATPOSE_CAMERA_UP_MINUS_Z; /* it looks along +z */
    flatpose_camera_done(camera, &request, &scan);
    printf("command %u served\n", (unsigned)request.number);
    fflush(stdout);
  }
}

int main(int argument_count, char** arguments) {
  const char* const path = argument_count > 1 ? arguments[1] : "/run/flatpose/camera.sock";
  const struct timespec pause = {0, 500 * 1000 * 1000};
  for (;;) {
    flatpose_camera camera;
    const flatpose_camera_status status =
        flatpose_camera_connect(&camera, path, "camera_driver.c", FLATPOSE_CAMERA_IS_SIMULATED);
    if (status == FLATPOSE_CAMERA_OK) {
      serve(&camera);
    } else {
      fprintf(stderr, "%s: %s %s\n", path, flatpose_camera_status_text(status), camera.reason);
    }
    flatpose_camera_close(&camera);
    thrd_sleep(&pause, NULL); /* the daemon may come back */
  }
}
