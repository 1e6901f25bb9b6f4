/* For who writes a camera driver for flatposed, in C11 or C++:
 *
 *   flatpose_camera camera;
 *   flatpose_camera_connect(&camera, "/run/flatpose/camera.sock", "my camera", 0);
 *   while (flatpose_camera_wait(&camera, -1, &request) == FLATPOSE_CAMERA_OK) {
 *     flatpose_camera_scan scan = flatpose_camera_interleaved(width_px, height_px);
 *     scan.start_us = flatpose_camera_now_us();    the acquisition begins now, not before
 *     ... x y z x y z ... into camera.memory
 *     scan.end_us = flatpose_camera_now_us();
 *     flatpose_camera_done(&camera, &request, &scan);        or flatpose_camera_failed()
 *   }
 *   flatpose_camera_close(&camera);                the daemon is gone: connect again
 *
 * Needs nothing but the C library. Allocates nothing but the mapping of the daemon's memory; starts
 * no thread. One thread at a time per camera. While it waits it tells the daemon that it lives; a
 * driver that works on a request for longer asks flatpose_camera_is_wanted() now and then, which
 * does so too.
 */
#ifndef FLATPOSE_CAMERA_H_
#define FLATPOSE_CAMERA_H_

#include <stddef.h>
#include <stdint.h>

#include "flatpose/camera_protocol.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum flatpose_camera_status {
  FLATPOSE_CAMERA_OK = 0,
  FLATPOSE_CAMERA_TIMEOUT = 1,      /* nothing was asked in this time */
  FLATPOSE_CAMERA_NO_DAEMON = 2,    /* nobody listens there, or may not be spoken to: errno */
  FLATPOSE_CAMERA_TURNED_AWAY = 3,  /* by the daemon: camera.reason */
  FLATPOSE_CAMERA_LOST = 4,         /* the daemon ended, or closed the connection */
  FLATPOSE_CAMERA_BAD_ARGUMENT = 5, /* the scan does not fit, a text is too long, ... */
  FLATPOSE_CAMERA_BAD_DAEMON = 6    /* it speaks otherwise than camera_protocol.h */
} flatpose_camera_status;

/* To be read; written by the calls alone. */
typedef struct flatpose_camera {
  int socket;            /* -1: not connected. Readable when there is something to wait for */
  unsigned char* memory; /* where points go */
  size_t memory_bytes;
  int32_t width_px_max; /* the largest scan that the daemon takes */
  int32_t height_px_max;
  int64_t alive_us; /* when it was last told that this driver lives */
  char reason[FLATPOSE_CAMERA_REASON_BYTES];
} flatpose_camera;

typedef struct flatpose_camera_request {
  uint32_t ticket;
  uint16_t number; /* as the PLC wrote it */
  uint16_t job;
  int64_t accepted_us; /* the acquisition must begin after this */
  int64_t answer_by_us;
} flatpose_camera_request;

/* A scan in the memory; offsets count from its start and are multiples of 4. */
typedef struct flatpose_camera_scan {
  int32_t width_px;
  int32_t height_px;
  uint32_t flags; /* FLATPOSE_CAMERA_IS_SIMULATED */
  uint32_t up;    /* FLATPOSE_CAMERA_UP_... */
  size_t x_offset_bytes;
  size_t y_offset_bytes;
  size_t z_offset_bytes;
  size_t pixel_stride_bytes;
  size_t row_stride_bytes;
  int64_t start_us;
  int64_t end_us;
} flatpose_camera_scan;

/* Connects and takes the memory. `name` is for the daemon's log; `flags`: what all scans are.
 * Waits no longer than 2 s. Whatever it returns, flatpose_camera_close() may follow. */
flatpose_camera_status flatpose_camera_connect(flatpose_camera* camera, const char* path,
                                               const char* name, uint32_t flags);

/* Waits for a request, at most `timeout_ms` (-1: as long as it takes). */
flatpose_camera_status flatpose_camera_wait(flatpose_camera* camera, int timeout_ms,
                                            flatpose_camera_request* request);

/* Whether the request still waits for an answer; 0 also when the daemon is gone. Never waits. */
int flatpose_camera_is_wanted(flatpose_camera* camera, const flatpose_camera_request* request);

/* The answer. From then on the points belong to the daemon until the next request. */
flatpose_camera_status flatpose_camera_done(flatpose_camera* camera,
                                            const flatpose_camera_request* request,
                                            const flatpose_camera_scan* scan);
/* The other answer: why there is no scan, in one line. */
flatpose_camera_status flatpose_camera_failed(flatpose_camera* camera,
                                              const flatpose_camera_request* request,
                                              const char* reason);

void flatpose_camera_close(flatpose_camera* camera);

/* x y z x y z ... from the start of the memory; up is -z: the camera looks along +z. */
flatpose_camera_scan flatpose_camera_interleaved(int32_t width_px, int32_t height_px);
/* All x, then all y, then all z. */
flatpose_camera_scan flatpose_camera_planes(int32_t width_px, int32_t height_px);

/* The clock that requests and scans are timed by. */
int64_t flatpose_camera_now_us(void);
/* In words, for logs; never null. */
const char* flatpose_camera_status_text(flatpose_camera_status status);

#ifdef __cplusplus
}
#endif

#endif
