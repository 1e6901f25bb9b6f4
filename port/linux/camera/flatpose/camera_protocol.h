/* What a camera driver and flatposed say to each other, for C11 and C++. Most drivers need no more
 * than camera.h beside it, which speaks this for them.
 *
 * The driver is a process of its own. It connects to the daemon's Unix socket ([source] driver) of
 * type SOCK_SEQPACKET; a packet is one message, in the machine's own byte order:
 *
 *   driver                            daemon
 *   hello (name, flags)        -->
 *                              <--    welcome (limits; a memfd as SCM_RIGHTS)   or refused, closed
 *   alive, every 500 ms        -->
 *                              <--    capture (ticket, the master's number, times)
 *   [points into the memory]
 *   done (ticket, layout)      -->    checks, copies
 *   or failed (ticket, why)    -->
 *                              <--    stop (ticket): nobody wants that scan any more
 *
 * Time     Microseconds of CLOCK_MONOTONIC. Only a scan whose acquisition *began* at accepted_us or
 *          later counts: a camera that runs freely lets older ones go. The daemon looks.
 * Memory   Belongs to the connection. The driver writes points between capture and done, nothing
 *          else touches them; after done the daemon copies them before it asks again. float32, mm,
 *          NaN where there is no point. Its size is fixed, sealed against resizing.
 * Answers  One for each capture. An answer to a ticket that is over is nobody's; a newer capture
 *          takes an older one's place.
 * Alive    Who is silent for longer than the limit counts as hung, and gives way to a newcomer.
 * Refusal  A message of another version, size or kind than stated here ends the connection.
 */
#ifndef FLATPOSE_CAMERA_PROTOCOL_H_
#define FLATPOSE_CAMERA_PROTOCOL_H_

#include <stdint.h>

#define FLATPOSE_CAMERA_MAGIC 0x43505446u /* "FTPC" */
#define FLATPOSE_CAMERA_VERSION 1u

#define FLATPOSE_CAMERA_ALIVE_PERIOD_MS 500
#define FLATPOSE_CAMERA_ALIVE_LIMIT_MS 2000
#define FLATPOSE_CAMERA_HELLO_LIMIT_MS 1000         /* from connect to hello */
#define FLATPOSE_CAMERA_MESSAGES_PER_SECOND_MAX 200 /* beside answers; more is taken for a defect \
                                                     */

#define FLATPOSE_CAMERA_NAME_BYTES 64
#define FLATPOSE_CAMERA_REASON_BYTES 160

enum flatpose_camera_kind {
  FLATPOSE_CAMERA_KIND_HELLO = 1,
  FLATPOSE_CAMERA_KIND_WELCOME = 2,
  FLATPOSE_CAMERA_KIND_REFUSED = 3,
  FLATPOSE_CAMERA_KIND_ALIVE = 4,
  FLATPOSE_CAMERA_KIND_CAPTURE = 5,
  FLATPOSE_CAMERA_KIND_STOP = 6,
  FLATPOSE_CAMERA_KIND_DONE = 7,
  FLATPOSE_CAMERA_KIND_FAILED = 8
};

#define FLATPOSE_CAMERA_IS_SIMULATED 1u /* flags: what it gives lies before no sensor */

/* The side of the scan that the sensor looks from. */
enum { FLATPOSE_CAMERA_UP_PLUS_Z = 1, FLATPOSE_CAMERA_UP_MINUS_Z = 2 };

typedef struct flatpose_camera_head {
  uint32_t magic;
  uint16_t version;
  uint16_t kind;
  uint32_t size_bytes; /* of the whole message */
  uint32_t ticket;     /* of a command; 0 where none is meant */
} flatpose_camera_head;

typedef struct flatpose_camera_hello_message {
  flatpose_camera_head head;
  uint32_t flags;
  uint32_t reserved;                     /* 0 */
  char name[FLATPOSE_CAMERA_NAME_BYTES]; /* for logs; ends with 0 */
} flatpose_camera_hello_message;

typedef struct flatpose_camera_welcome_message {
  flatpose_camera_head head;
  uint64_t memory_bytes;
  int32_t width_px_max;
  int32_t height_px_max;
} flatpose_camera_welcome_message;

/* Refused and failed. */
typedef struct flatpose_camera_reason_message {
  flatpose_camera_head head;
  char reason[FLATPOSE_CAMERA_REASON_BYTES]; /* one line; ends with 0 */
} flatpose_camera_reason_message;

typedef struct flatpose_camera_capture_message {
  flatpose_camera_head head;
  uint16_t number; /* command_number, as the master wrote it */
  uint16_t job;
  uint32_t reserved;
  int64_t accepted_us;
  int64_t answer_by_us; /* after this the scan is of no use */
} flatpose_camera_capture_message;

/* x of the pixel (column, row) stands at x_offset + column * pixel_stride + row * row_stride from
 * the start of the memory; all are multiples of 4. Planes, interleaved points and padded ones fit.
 */
typedef struct flatpose_camera_done_message {
  flatpose_camera_head head;
  int32_t width_px;
  int32_t height_px;
  uint32_t flags;
  uint32_t up;
  uint64_t x_offset_bytes;
  uint64_t y_offset_bytes;
  uint64_t z_offset_bytes;
  uint64_t pixel_stride_bytes;
  uint64_t row_stride_bytes;
  int64_t start_us; /* of the acquisition */
  int64_t end_us;
} flatpose_camera_done_message;

#if defined(__cplusplus)
#define FLATPOSE_CAMERA_HOLDS(claim) static_assert(claim, #claim)
#else
#define FLATPOSE_CAMERA_HOLDS(claim) _Static_assert(claim, #claim)
#endif
FLATPOSE_CAMERA_HOLDS(sizeof(flatpose_camera_head) == 16);
FLATPOSE_CAMERA_HOLDS(sizeof(flatpose_camera_hello_message) == 88);
FLATPOSE_CAMERA_HOLDS(sizeof(flatpose_camera_welcome_message) == 32);
FLATPOSE_CAMERA_HOLDS(sizeof(flatpose_camera_reason_message) == 176);
FLATPOSE_CAMERA_HOLDS(sizeof(flatpose_camera_capture_message) == 40);
FLATPOSE_CAMERA_HOLDS(sizeof(flatpose_camera_done_message) == 88);

#endif
