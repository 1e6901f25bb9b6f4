#define _GNU_SOURCE
#include "flatpose/camera.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

enum { WELCOME_LIMIT_MS = 2000, SIDE_MAX_PX = 32767 };
static const int64_t US_PER_MS = 1000;

/* Room for any message, and a byte more, so that a longer one is found out. */
typedef union any_message {
  flatpose_camera_head head;
  flatpose_camera_welcome_message welcome;
  flatpose_camera_capture_message capture;
  flatpose_camera_reason_message reason;
  unsigned char bytes[sizeof(flatpose_camera_reason_message) + 1];
} any_message;

int64_t flatpose_camera_now_us(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000;
}

const char* flatpose_camera_status_text(flatpose_camera_status status) {
  switch (status) {
    case FLATPOSE_CAMERA_OK: return "ok";
    case FLATPOSE_CAMERA_TIMEOUT: return "nothing was asked";
    case FLATPOSE_CAMERA_NO_DAEMON: return "no daemon listens there";
    case FLATPOSE_CAMERA_TURNED_AWAY: return "the daemon turned it away";
    case FLATPOSE_CAMERA_LOST: return "the daemon is gone";
    case FLATPOSE_CAMERA_BAD_ARGUMENT: return "an argument is wrong";
    case FLATPOSE_CAMERA_BAD_DAEMON: return "the daemon speaks another protocol";
  }
  return "unknown status";
}

static void forget(flatpose_camera* camera) {
  memset(camera, 0, sizeof *camera);
  camera->socket = -1;
}

void flatpose_camera_close(flatpose_camera* camera) {
  if (camera->memory != NULL) munmap(camera->memory, camera->memory_bytes);
  if (camera->socket >= 0) close(camera->socket);
  camera->memory = NULL;
  camera->memory_bytes = 0;
  camera->socket = -1;
}

static flatpose_camera_head head_of(uint16_t kind, size_t size_bytes, uint32_t ticket) {
  const flatpose_camera_head head = {FLATPOSE_CAMERA_MAGIC, FLATPOSE_CAMERA_VERSION, kind,
                                     (uint32_t)size_bytes, ticket};
  return head;
}

static flatpose_camera_status say(flatpose_camera* camera, const void* message, size_t bytes) {
  ssize_t sent;
  do {
    sent = send(camera->socket, message, bytes, MSG_NOSIGNAL);
  } while (sent < 0 && errno == EINTR);
  if (sent != (ssize_t)bytes) return FLATPOSE_CAMERA_LOST;
  camera->alive_us = flatpose_camera_now_us();
  return FLATPOSE_CAMERA_OK;
}

static flatpose_camera_status say_alive_when_due(flatpose_camera* camera) {
  const int64_t due_us = camera->alive_us + FLATPOSE_CAMERA_ALIVE_PERIOD_MS * US_PER_MS;
  if (flatpose_camera_now_us() < due_us) return FLATPOSE_CAMERA_OK;
  const flatpose_camera_head alive =
      head_of(FLATPOSE_CAMERA_KIND_ALIVE, sizeof(flatpose_camera_head), 0);
  return say(camera, &alive, sizeof alive);
}

static size_t size_of_kind(uint16_t kind) {
  switch (kind) {
    case FLATPOSE_CAMERA_KIND_WELCOME: return sizeof(flatpose_camera_welcome_message);
    case FLATPOSE_CAMERA_KIND_REFUSED: return sizeof(flatpose_camera_reason_message);
    case FLATPOSE_CAMERA_KIND_CAPTURE: return sizeof(flatpose_camera_capture_message);
    case FLATPOSE_CAMERA_KIND_STOP: return sizeof(flatpose_camera_head);
    default: return 0;
  }
}

static int is_sound(const any_message* message, ssize_t bytes) {
  const flatpose_camera_head* head = &message->head;
  return bytes >= (ssize_t)sizeof *head && head->magic == FLATPOSE_CAMERA_MAGIC &&
         head->version == FLATPOSE_CAMERA_VERSION && head->size_bytes == (size_t)bytes &&
         size_of_kind(head->kind) == (size_t)bytes;
}

/* The next message; `memory_fd`, when asked for, is what came with it or -1. */
static flatpose_camera_status hear(flatpose_camera* camera, int flags, any_message* message,
                                   int* memory_fd) {
  union {
    struct cmsghdr head;
    char bytes[CMSG_SPACE(sizeof(int))];
  } control;
  struct iovec part = {message, sizeof *message};
  struct msghdr packet;
  memset(&packet, 0, sizeof packet);
  packet.msg_iov = &part;
  packet.msg_iovlen = 1;
  if (memory_fd != NULL) {
    packet.msg_control = &control;
    packet.msg_controllen = sizeof control;
    *memory_fd = -1;
  }
  ssize_t got;
  do {
    got = recvmsg(camera->socket, &packet, flags | MSG_CMSG_CLOEXEC);
  } while (got < 0 && errno == EINTR);
  if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return FLATPOSE_CAMERA_TIMEOUT;
  if (got <= 0) return FLATPOSE_CAMERA_LOST;
  if (memory_fd != NULL) {
    const struct cmsghdr* const with = CMSG_FIRSTHDR(&packet);
    if (with != NULL && with->cmsg_level == SOL_SOCKET && with->cmsg_type == SCM_RIGHTS &&
        with->cmsg_len == CMSG_LEN(sizeof(int)))
      memcpy(memory_fd, CMSG_DATA(with), sizeof(int));
  }
  return is_sound(message, got) ? FLATPOSE_CAMERA_OK : FLATPOSE_CAMERA_BAD_DAEMON;
}

/* Whether there is something to hear within the time. */
static flatpose_camera_status wait_for(const flatpose_camera* camera, int timeout_ms) {
  struct pollfd waited = {camera->socket, POLLIN, 0};
  const int count = poll(&waited, 1, timeout_ms);
  if (count < 0 && errno != EINTR) return FLATPOSE_CAMERA_LOST;
  return count > 0 ? FLATPOSE_CAMERA_OK : FLATPOSE_CAMERA_TIMEOUT;
}

/* --- connecting */

static flatpose_camera_status take_memory(flatpose_camera* camera, int memory_fd,
                                          uint64_t memory_bytes) {
  const int wanted = F_SEAL_SHRINK | F_SEAL_GROW;
  struct stat state;
  const int is_ours = memory_fd >= 0 && fstat(memory_fd, &state) == 0 && memory_bytes > 0 &&
                      (uint64_t)state.st_size == memory_bytes &&
                      (fcntl(memory_fd, F_GET_SEALS) & wanted) == wanted;
  if (!is_ours) return FLATPOSE_CAMERA_BAD_DAEMON;
  void* const at =
      mmap(NULL, memory_bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, memory_fd, 0);
  if (at == MAP_FAILED) return FLATPOSE_CAMERA_BAD_DAEMON;
  camera->memory = at;
  camera->memory_bytes = memory_bytes;
  return FLATPOSE_CAMERA_OK;
}

static flatpose_camera_status take_welcome(flatpose_camera* camera) {
  any_message message;
  int memory_fd = -1;
  flatpose_camera_status status = wait_for(camera, WELCOME_LIMIT_MS);
  if (status == FLATPOSE_CAMERA_OK) status = hear(camera, 0, &message, &memory_fd);
  if (status == FLATPOSE_CAMERA_TIMEOUT) status = FLATPOSE_CAMERA_NO_DAEMON;
  if (status == FLATPOSE_CAMERA_OK && message.head.kind == FLATPOSE_CAMERA_KIND_REFUSED) {
    memcpy(camera->reason, message.reason.reason, sizeof camera->reason);
    camera->reason[sizeof camera->reason - 1] = 0;
    status = FLATPOSE_CAMERA_TURNED_AWAY;
  } else if (status == FLATPOSE_CAMERA_OK && message.head.kind != FLATPOSE_CAMERA_KIND_WELCOME) {
    status = FLATPOSE_CAMERA_BAD_DAEMON;
  } else if (status == FLATPOSE_CAMERA_OK) {
    camera->width_px_max = message.welcome.width_px_max;
    camera->height_px_max = message.welcome.height_px_max;
    status = take_memory(camera, memory_fd, message.welcome.memory_bytes);
  }
  if (memory_fd >= 0) close(memory_fd);
  return status;
}

flatpose_camera_status flatpose_camera_connect(flatpose_camera* camera, const char* path,
                                               const char* name, uint32_t flags) {
  struct sockaddr_un address;
  flatpose_camera_hello_message hello;
  forget(camera);
  memset(&address, 0, sizeof address);
  memset(&hello, 0, sizeof hello);
  if (path == NULL || strlen(path) >= sizeof address.sun_path || name == NULL ||
      strlen(name) >= sizeof hello.name)
    return FLATPOSE_CAMERA_BAD_ARGUMENT;
  address.sun_family = AF_UNIX;
  memcpy(address.sun_path, path, strlen(path));
  hello.head = head_of(FLATPOSE_CAMERA_KIND_HELLO, sizeof hello, 0);
  hello.flags = flags;
  memcpy(hello.name, name, strlen(name));

  camera->socket = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
  if (camera->socket < 0 ||
      connect(camera->socket, (const struct sockaddr*)&address, sizeof address) != 0)
    return FLATPOSE_CAMERA_NO_DAEMON;
  const flatpose_camera_status status = say(camera, &hello, sizeof hello);
  /* What turned it away may already be there to read, although it was closed before the hello. */
  const flatpose_camera_status welcome = take_welcome(camera);
  return welcome == FLATPOSE_CAMERA_OK ? status : welcome;
}

/* --- serving */

flatpose_camera_status flatpose_camera_wait(flatpose_camera* camera, int timeout_ms,
                                            flatpose_camera_request* request) {
  const int64_t end_us = flatpose_camera_now_us() + timeout_ms * US_PER_MS;
  for (;;) {
    any_message message;
    flatpose_camera_status status = say_alive_when_due(camera);
    if (status != FLATPOSE_CAMERA_OK) return status;
    const int64_t left_us = end_us - flatpose_camera_now_us();
    int wait_ms = FLATPOSE_CAMERA_ALIVE_PERIOD_MS;
    if (timeout_ms >= 0 && left_us < wait_ms * US_PER_MS)
      wait_ms = left_us <= 0 ? 0 : (int)(left_us / US_PER_MS) + 1;
    status = wait_for(camera, wait_ms);
    if (status == FLATPOSE_CAMERA_TIMEOUT) {
      if (timeout_ms >= 0 && flatpose_camera_now_us() >= end_us) return status;
      continue;
    }
    if (status == FLATPOSE_CAMERA_OK) status = hear(camera, MSG_DONTWAIT, &message, NULL);
    if (status == FLATPOSE_CAMERA_TIMEOUT) continue;
    if (status != FLATPOSE_CAMERA_OK) return status;
    if (message.head.kind != FLATPOSE_CAMERA_KIND_CAPTURE) continue; /* a stop of what is done */
    request->ticket = message.head.ticket;
    request->number = message.capture.number;
    request->job = message.capture.job;
    request->accepted_us = message.capture.accepted_us;
    request->answer_by_us = message.capture.answer_by_us;
    if (flatpose_camera_is_wanted(camera, request)) return FLATPOSE_CAMERA_OK;
  }
}

int flatpose_camera_is_wanted(flatpose_camera* camera, const flatpose_camera_request* request) {
  any_message message;
  if (flatpose_camera_now_us() > request->answer_by_us) return 0;
  for (;;) {
    const flatpose_camera_status status = hear(camera, MSG_DONTWAIT | MSG_PEEK, &message, NULL);
    if (status == FLATPOSE_CAMERA_TIMEOUT) return say_alive_when_due(camera) == FLATPOSE_CAMERA_OK;
    if (status != FLATPOSE_CAMERA_OK || message.head.kind != FLATPOSE_CAMERA_KIND_STOP) return 0;
    if (hear(camera, MSG_DONTWAIT, &message, NULL) != FLATPOSE_CAMERA_OK) return 0;
    if (message.head.ticket == request->ticket) return 0;
  }
}

/* Whether the last value of a coordinate still lies in the memory. */
static int fits(const flatpose_camera* camera, const flatpose_camera_scan* scan, size_t offset) {
  const size_t bytes = camera->memory_bytes;
  if (offset % 4 != 0 || offset > bytes) return 0;
  const size_t last = offset + (size_t)(scan->height_px - 1) * scan->row_stride_bytes +
                      (size_t)(scan->width_px - 1) * scan->pixel_stride_bytes;
  return last <= bytes - sizeof(float);
}

flatpose_camera_status flatpose_camera_done(flatpose_camera* camera,
                                            const flatpose_camera_request* request,
                                            const flatpose_camera_scan* scan) {
  const int is_within =
      scan->width_px >= 2 && scan->height_px >= 2 && scan->width_px <= SIDE_MAX_PX &&
      scan->height_px <= SIDE_MAX_PX && scan->width_px <= camera->width_px_max &&
      scan->height_px <= camera->height_px_max && scan->pixel_stride_bytes % 4 == 0 &&
      scan->row_stride_bytes % 4 == 0 && scan->pixel_stride_bytes <= camera->memory_bytes &&
      scan->row_stride_bytes <= camera->memory_bytes;
  if (!is_within || !fits(camera, scan, scan->x_offset_bytes) ||
      !fits(camera, scan, scan->y_offset_bytes) || !fits(camera, scan, scan->z_offset_bytes))
    return FLATPOSE_CAMERA_BAD_ARGUMENT;
  flatpose_camera_done_message done;
  memset(&done, 0, sizeof done);
  done.head = head_of(FLATPOSE_CAMERA_KIND_DONE, sizeof done, request->ticket);
  done.width_px = scan->width_px;
  done.height_px = scan->height_px;
  done.flags = scan->flags;
  done.up = scan->up;
  done.x_offset_bytes = scan->x_offset_bytes;
  done.y_offset_bytes = scan->y_offset_bytes;
  done.z_offset_bytes = scan->z_offset_bytes;
  done.pixel_stride_bytes = scan->pixel_stride_bytes;
  done.row_stride_bytes = scan->row_stride_bytes;
  done.start_us = scan->start_us;
  done.end_us = scan->end_us;
  return say(camera, &done, sizeof done);
}

flatpose_camera_status flatpose_camera_failed(flatpose_camera* camera,
                                              const flatpose_camera_request* request,
                                              const char* reason) {
  flatpose_camera_reason_message failed;
  memset(&failed, 0, sizeof failed);
  failed.head = head_of(FLATPOSE_CAMERA_KIND_FAILED, sizeof failed, request->ticket);
  strncpy(failed.reason, reason != NULL ? reason : "", sizeof failed.reason - 1);
  return say(camera, &failed, sizeof failed);
}

/* --- layouts */

flatpose_camera_scan flatpose_camera_interleaved(int32_t width_px, int32_t height_px) {
  flatpose_camera_scan scan;
  memset(&scan, 0, sizeof scan);
  scan.width_px = width_px;
  scan.height_px = height_px;
  scan.up = FLATPOSE_CAMERA_UP_MINUS_Z;
  scan.y_offset_bytes = sizeof(float);
  scan.z_offset_bytes = 2 * sizeof(float);
  scan.pixel_stride_bytes = 3 * sizeof(float);
  scan.row_stride_bytes = (size_t)width_px * scan.pixel_stride_bytes;
  return scan;
}

flatpose_camera_scan flatpose_camera_planes(int32_t width_px, int32_t height_px) {
  flatpose_camera_scan scan = flatpose_camera_interleaved(width_px, height_px);
  const size_t plane_bytes = (size_t)width_px * (size_t)height_px * sizeof(float);
  scan.y_offset_bytes = plane_bytes;
  scan.z_offset_bytes = 2 * plane_bytes;
  scan.pixel_stride_bytes = sizeof(float);
  scan.row_stride_bytes = (size_t)width_px * sizeof(float);
  return scan;
}
