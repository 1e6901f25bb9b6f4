/* flatpose for C11: finds where an essentially flat part lies in the range image of a 3D camera.
 *
 *   flatpose_limits limits = FLATPOSE_LIMITS_INIT;             what the memory must suffice for
 *   bytes = flatpose_required_bytes(&limits);                  memory is yours, and stays yours
 *   flatpose_init(&limits, memory, bytes, &finder);
 *   flatpose_part_load(file, file_bytes, part_memory, part_bytes, &part);
 *   flatpose_locate(finder, part, &scan, &config, &host, &result);
 *   flatpose_match_at(finder, 0, &match);                      the part's pose, or
 *   flatpose_pick_at(finder, 0, &pick, &match);                where a tool goes
 *
 * Memory   Nothing is allocated, ever. Handles live in memory that the caller gives and must not
 *          move; there is nothing to close.
 * Time     The library reads no clock and starts no thread. It asks `host` for both, and between
 *          two looks at the clock it does a bounded amount of work.
 * Threads  One call at a time per finder; a part may be shared once it is loaded. Callbacks come
 *          from the calling thread and from those that your parallel_for uses.
 * Units    mm and degrees. Rotations are row-major 3 x 3 matrices.
 * Frames   `scan` as the sensor gave it. With scan.work_T_scan everything in and out is in `work`.
 *          z of `object` points out of the part's surface.
 * Growth   Every struct that is passed by itself begins with its size. Begin with the _INIT of its
 * kind, always: what a later version adds then has its default.
 */
#ifndef FLATPOSE_FLATPOSE_H_
#define FLATPOSE_FLATPOSE_H_

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What a call reports. What a search may end with is an outcome, not an error. */
typedef enum flatpose_status {
  FLATPOSE_STATUS_OK = 0,
  FLATPOSE_STATUS_INVALID_ARGUMENT = 1, /* a null pointer, or a field outside its range */
  FLATPOSE_STATUS_SHAPE_MISMATCH = 2,
  FLATPOSE_STATUS_OUT_OF_MEMORY = 3, /* fewer bytes than the call's required_bytes */
  FLATPOSE_STATUS_TOO_LARGE = 4,     /* a scan or field beyond the limits */
  FLATPOSE_STATUS_NOT_FINITE = 5,    /* an infinite or giant coordinate */
  FLATPOSE_STATUS_TOO_FEW_POINTS = 6,
  FLATPOSE_STATUS_NO_PART = 7,       /* teach: nothing stands out */
  FLATPOSE_STATUS_SEVERAL_PARTS = 8, /* teach: say which by a region */
  FLATPOSE_STATUS_NO_CONTOUR = 9,
  FLATPOSE_STATUS_BAD_MAGIC = 10,
  FLATPOSE_STATUS_BAD_VERSION = 11, /* a file, or a struct, of a newer library */
  FLATPOSE_STATUS_BAD_CHECKSUM = 12,
  FLATPOSE_STATUS_TRUNCATED = 13,
  FLATPOSE_STATUS_STOPPED = 14 /* inside only: calls report an outcome */
} flatpose_status;

/* How a search ended. Positive: usable, with a warning. Negative: no pose. */
typedef enum flatpose_outcome {
  FLATPOSE_OUTCOME_OK = 0,
  FLATPOSE_OUTCOME_AMBIGUOUS = 1,
  FLATPOSE_OUTCOME_DEADLINE = 2, /* what there is is verified, but there may be more */
  FLATPOSE_OUTCOME_NO_MATCH = -1,
  FLATPOSE_OUTCOME_EMPTY_SCENE = -2,
  FLATPOSE_OUTCOME_SCAN_POOR = -3,
  FLATPOSE_OUTCOME_CANCELLED = -4
} flatpose_outcome;

/* In words, for logs; never null. */
const char* flatpose_status_text(flatpose_status status);
/* The name that the tool and the bus use: "ok", "no_match", ... */
const char* flatpose_outcome_name(int32_t outcome);
/* MAJOR * 10000 + MINOR * 100 + PATCH of the library that is linked. */
uint32_t flatpose_version(void);

/* Which form of the vectorised loops runs; all give the same bits. The processor must have it. */
enum { FLATPOSE_PATH_PORTABLE = 0, FLATPOSE_PATH_AVX2 = 1, FLATPOSE_PATH_AVX512 = 2 };

typedef struct flatpose_limits {
  size_t struct_size;
  int32_t scan_width_px;
  int32_t scan_height_px;
  int32_t cell_count; /* of the finest height map: field area over cell area */
  int32_t vector_path;
  int32_t can_teach; /* 0: flatpose_teach() is refused, and less memory is needed */
} flatpose_limits;
#define FLATPOSE_LIMITS_INIT \
  { sizeof(flatpose_limits), 1536, 1280, 4000000, FLATPOSE_PATH_PORTABLE, 0 }

typedef struct flatpose_finder flatpose_finder;
typedef struct flatpose_part flatpose_part;

/* 0 when a limit is out of range. */
size_t flatpose_required_bytes(const flatpose_limits* limits);
/* Memory: taken until the finder is no longer used. Any alignment. */
flatpose_status flatpose_init(const flatpose_limits* limits, void* memory, size_t memory_bytes,
                              flatpose_finder** finder);

/* ---- parts ---------------------------------------------------------------------------------- */

typedef struct flatpose_pose {
  double rotation[9];
  double position_mm[3];
} flatpose_pose;

/* What teach found weak: bits of flatpose_part_info.weakness. */
enum {
  FLATPOSE_WEAK_SYMMETRY_LIKELY = 1,
  FLATPOSE_WEAK_DIRECTION_LOOSE = 2,
  FLATPOSE_WEAK_STEP_NEAR_NOISE = 4,
  FLATPOSE_WEAK_BELOW_SURROUNDINGS = 8,
  FLATPOSE_WEAK_SMALL = 16,
  FLATPOSE_WEAK_MARGIN_THIN = 32,
  FLATPOSE_WEAK_SYMMETRY_DOUBTFUL = 64
};

#define FLATPOSE_NAME_BYTES 64
typedef struct flatpose_part_info {
  size_t struct_size;
  char name[FLATPOSE_NAME_BYTES];
  int32_t symmetry_order; /* 1 none, N, 0 full */
  double score_threshold;
  double self_score;
  double rival_score;
  double pitch_mm;
  double noise_mm;
  double area_mm2;
  double radius_mm;
  flatpose_pose taught; /* scan_T_object, or work_T_object when taught with work_T_scan */
  uint32_t weakness;
} flatpose_part_info;
#define FLATPOSE_PART_INFO_INIT \
  { sizeof(flatpose_part_info), {0}, 0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, {{0}, {0}}, 0 }

/* Bytes of memory for one part, and of a file that holds any part. */
size_t flatpose_part_required_bytes(void);
size_t flatpose_part_file_bytes_max(void);
/* Reads a part from the bytes of its file, believing nothing.  Cost: tens of milliseconds. */
flatpose_status flatpose_part_load(const void* file, size_t file_bytes, void* memory,
                                   size_t memory_bytes, flatpose_part** part);
/* Writes the part's file. */
flatpose_status flatpose_part_save(const flatpose_part* part, void* file,
                                   size_t file_capacity_bytes, size_t* file_bytes);
flatpose_status flatpose_part_describe(const flatpose_part* part, flatpose_part_info* info);

/* ---- scans ---------------------------------------------------------------------------------- */

/* An organized range image where it stands: x, y, z in mm at every pixel, NaN where missing. */
typedef struct flatpose_scan {
  size_t struct_size;
  const float* x_mm;
  const float* y_mm;
  const float* z_mm;
  int32_t width_px;
  int32_t height_px;
  int64_t pixel_stride_bytes; /* from a value to the next in its row; a multiple of 4 */
  int64_t row_stride_bytes;
  int32_t up; /* +1 or -1: which way of z the sensor is; without work_T_scan */
  const flatpose_pose* work_T_scan; /* an aligned work plane, z up; null: none */
} flatpose_scan;
#define FLATPOSE_SCAN_INIT \
  { sizeof(flatpose_scan), NULL, NULL, NULL, 0, 0, 0, 0, 1, NULL }

enum {
  FLATPOSE_REGION_ALL = 0,
  FLATPOSE_REGION_CIRCLE = 1,
  FLATPOSE_REGION_BOX = 2, /* two opposite corners */
  FLATPOSE_REGION_POLYGON = 3
};
/* Passed inside others, and in arrays: it never grows. */
typedef struct flatpose_region {
  int32_t kind;
  double x_mm; /* of a circle */
  double y_mm;
  double radius_mm;
  int32_t vertex_count;
  const double* vertices_xy_mm; /* x0, y0, x1, y1, ... */
} flatpose_region;
#define FLATPOSE_VERTEX_COUNT_MAX 64

/* ---- host ----------------------------------------------------------------------------------- */

/* Chunk `chunk_index` of something that may run side by side. */
typedef void (*flatpose_task)(void* task_context, int32_t chunk_index);

/* What the library asks of whoever runs it. Any callback may be null, and so may the host: then no
 * time passes, all is done on the calling thread, nothing is cancelled. */
typedef struct flatpose_host {
  size_t struct_size;
  void* context; /* given back to every callback */
  /* Microseconds since any fixed moment; never runs back. */
  int64_t (*now_us)(void* context);
  /* Runs task(task_context, i) for every i in [0, chunk_count), in any order, on any threads, and
   * returns when all are done. Results do not depend on how. */
  void (*parallel_for)(void* context, int32_t chunk_count, flatpose_task task, void* task_context);
  /* Nonzero: stop. Asked often; must not block. */
  int32_t (*is_cancelled)(void* context);
} flatpose_host;
#define FLATPOSE_HOST_INIT \
  { sizeof(flatpose_host), NULL, NULL, NULL, NULL }

/* ---- locate --------------------------------------------------------------------------------- */

#define FLATPOSE_MATCH_COUNT_MAX 64
#define FLATPOSE_EXCLUSION_COUNT_MAX 16
enum { FLATPOSE_ORDER_SCORE = 0, FLATPOSE_ORDER_HEIGHT = 1, FLATPOSE_ORDER_VISIBLE = 2 };

typedef struct flatpose_config {
  size_t struct_size;
  int32_t max_matches; /* 1 to FLATPOSE_MATCH_COUNT_MAX */
  int32_t order;
  double min_score;       /* 0 to 1; negative: the part's own threshold */
  double min_visible;     /* share of the surface, 0 to 1 */
  double max_tilt_deg;    /* against the work plane, 0 to 68; negative: 45.8 */
  double cell_mm;         /* of the finest height map; 0: the part's own */
  int64_t deadline_us;    /* after the call; 0: none. Without host->now_us it never strikes */
  flatpose_region region; /* where the part's origin may lie */
  /* Where it may not lie, and the range of its z. What lies there is not searched any further and
   * takes no place among the matches. Coordinates of the frame of the poses. */
  int32_t exclusion_count;           /* 0 to FLATPOSE_EXCLUSION_COUNT_MAX */
  const flatpose_region* exclusions; /* none of them ALL */
  int32_t has_heights;               /* default: any */
  double height_min_mm;              /* at most height_max_mm; may be infinite */
  double height_max_mm;
} flatpose_config;
#define FLATPOSE_CONFIG_INIT                                                   \
  {                                                                            \
    sizeof(flatpose_config), 1, FLATPOSE_ORDER_SCORE, -1.0, 0.5, -1.0, 0.0, 0, \
        {FLATPOSE_REGION_ALL, 0.0, 0.0, 0.0, 0, NULL}, 0, NULL, 0, 0.0, 0.0    \
  }

typedef struct flatpose_result {
  size_t struct_size;
  int32_t outcome;
  int32_t match_count; /* see flatpose_match_at() */
  int32_t is_exact;    /* nonzero: all of hypothesis_count and all candidates were gone through */
  double bound_gap;    /* by how much of a score what was not gone through could be better */
  int64_t hypothesis_count;
  int64_t evaluated_count;
  int64_t rectify_us;
  int64_t features_us;
  int64_t search_us;
  int64_t refine_us;
  int64_t verify_us;
  int64_t total_us;
  uint64_t peak_bytes;
  uint64_t digest; /* of all that was found; the same on every machine and any number of threads */
  double rival_score;         /* the best of another pose in the place of a match; 0: none */
  double best_rejected_score; /* of what became no match: how near a miss, or a rival, came */
} flatpose_result;
#define FLATPOSE_RESULT_INIT \
  { sizeof(flatpose_result), 0, 0, 0, 0.0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.0, 0.0 }

typedef struct flatpose_match {
  size_t struct_size;
  double score;         /* confirmed share of what could be seen, contradictions counted in full */
  double visible;       /* share of the part that the scan could show */
  flatpose_pose pose;   /* scan_T_object, or work_T_object when the scan had work_T_scan */
  double sigma_mm[3];   /* standard deviation along the frame's axes, without teach's own error */
  double sigma_deg[3];  /* about the object's own axes */
  int32_t turn_is_free; /* full symmetry: sigma_deg[2] means nothing */
  double edge_rms_mm;
  double surface_rms_mm;
} flatpose_match;
#define FLATPOSE_MATCH_INIT \
  { sizeof(flatpose_match), 0.0, 0.0, {{0}, {0}}, {0}, {0}, 0, 0.0, 0.0 }

/* Finds the part in a scan. `config` and `host` may be null: defaults.
 * Fails: INVALID_ARGUMENT, BAD_VERSION, TOO_LARGE, NOT_FINITE; there is no match then. */
flatpose_status flatpose_locate(flatpose_finder* finder, const flatpose_part* part,
                                const flatpose_scan* scan, const flatpose_config* config,
                                const flatpose_host* host, flatpose_result* result);
/* A match of the finder's last search, in the order that was asked for. */
flatpose_status flatpose_match_at(const flatpose_finder* finder, int32_t index,
                                  flatpose_match* match);

/* Where a tool goes at a part, and which equivalent of a symmetric part is told. */
typedef struct flatpose_pick {
  size_t struct_size;
  flatpose_pose object_T_pick; /* default: the object's own origin and axes */
  int32_t has_preferred_angle; /* default: the equivalent that the search gives */
  double preferred_angle_deg;  /* -360 to 360, from the frame's x to its y */
} flatpose_pick;
#define FLATPOSE_PICK_INIT \
  { sizeof(flatpose_pick), {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}}, 0, 0.0 }

/* As flatpose_match_at(), of the pick: its pose, and sigma at its place (farther from the middle of
 * the part it is larger) and about its axes. A turn that is free was chosen, not found: it adds
 * nothing to sigma. With a preferred angle the equivalent is told whose pick's x, seen in the
 * frame's xy plane, stands nearest to it. */
flatpose_status flatpose_pick_at(const flatpose_finder* finder, int32_t index,
                                 const flatpose_pick* pick, flatpose_match* match);

/* ---- teach ---------------------------------------------------------------------------------- */

#define FLATPOSE_TEACH_SCAN_COUNT_MAX 16
typedef struct flatpose_teach_config {
  size_t struct_size;
  const char* name;       /* UTF-8; null: none */
  flatpose_region region; /* where the part lies in the first scan; ALL: the lone part */
  int32_t symmetry_order; /* 1 none, N, 0 full */
  int32_t has_origin;     /* default: the centroid of the surface */
  double origin_xy_mm[2];
  int32_t has_x_axis; /* default: x of the frame */
  double x_axis_xy[2];
  int32_t has_symmetry_center; /* default: the contour's own */
  double symmetry_center_xy_mm[2];
} flatpose_teach_config;
#define FLATPOSE_TEACH_CONFIG_INIT                                                            \
  {                                                                                           \
    sizeof(flatpose_teach_config), NULL, {FLATPOSE_REGION_ALL, 0.0, 0.0, 0.0, 0, NULL}, 1, 0, \
        {0.0, 0.0}, 0, {0.0, 0.0}, 0, {                                                       \
      0.0, 0.0                                                                                \
    }                                                                                         \
  }

/* Teaches a part from one scan, or from more of it in other poses. `config` may be null.
 * Fails: also NO_PART, SEVERAL_PARTS, NO_CONTOUR, TOO_FEW_POINTS; INVALID_ARGUMENT when the
 * finder's limits said that it would not teach.  Cost: hundreds of milliseconds. */
flatpose_status flatpose_teach(flatpose_finder* finder, const flatpose_scan* const* scans,
                               int32_t scan_count, const flatpose_teach_config* config,
                               void* part_memory, size_t part_memory_bytes, flatpose_part** part);

#ifdef __cplusplus
}
#endif

#endif /* FLATPOSE_FLATPOSE_H_ */
