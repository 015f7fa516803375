/* scanseg: range-image segmentation that runs while the scanner is still scanning.
 *
 *     scanseg_config config;
 *     scanseg_config_init(&config, sizeof config, SCANSEG_ABI_VERSION);
 *     config.columns = 361;                            // and what else there is to set: see the struct
 *     scanseg_init(memory, sizeof memory, &config, &segmenter);
 *     for each row: scanseg_push_row(segmenter, ranges_m, 361, turn_rad, &output);
 *     scanseg_finish(segmenter, &output);              // then scanseg_reset for the next scan
 *
 * A whole image that is there already takes one call, `scanseg_segment_image`.
 *
 * The segmenter lives in memory of yours, `SCANSEG_STATE_SIZE(columns)` bytes; nothing is allocated, no call blocks, and
 * there is no global state: one segmenter belongs to one thread at a time, and different ones do not know of each other.
 *
 * Pointers. NULL, a pointer that is not aligned, and a wrong size are told by a status. Beyond that every pointer must point
 * to as many elements as it says, for the time of the call, and arrays of one call must not overlap. While a segmenter is in
 * use its memory is left alone: not written to, moved or copied. A segmenter that was never made, overwritten or copied is
 * told by a status, provided that there is memory that was written to at some time. To end its use needs no call.
 *
 * Statuses. 0 is success; above 0 the call did what it should, and there is something to know; below 0 the call did nothing.
 *
 * Made by cbindgen from core/capi/src: do not edit. */

#ifndef SCANSEG_H
#define SCANSEG_H

#include <stddef.h>
#include <stdint.h>

/** Bytes that a segmenter needs at most for images of so many columns: even columns or a camera, up to two traces that reach
 *  back up to three rows. A constant expression. `scanseg_state_size` gives the exact number. */
#define SCANSEG_STATE_SIZE(columns) SCANSEG_STATE_SIZE_WITH(columns, 0, 2, 3)

/** The same, with listed columns (`listed` = 1, else 0), so many traces, and the most rows that a trace reaches back. */
#define SCANSEG_STATE_SIZE_WITH(columns, listed, traces, trace_rows) \
    ((size_t)1536 + (size_t)(columns) * (66 + 4 * (size_t)(listed) + 4 * (size_t)((traces) > 2 ? (traces) : 2) \
                                         + 4 * (size_t)((trace_rows) > 3 ? (trace_rows) : 3)) \
     + 136 * (size_t)(traces))

/** The same for `SCANSEG_FREE`: `SCANSEG_STATE_SIZE` and the directions of the rows that are kept. Full turns take
 *  `2 * columns` more. */
#define SCANSEG_STATE_SIZE_FREE(columns) (SCANSEG_STATE_SIZE(columns) + (size_t)36 * (columns))

/** Events that one row or the end of a scan can bring at most, for images of so many columns. */
#define SCANSEG_MAX_EVENTS(columns) (2 * (size_t)(columns) + 4)

/** Elements of the work memory of `scanseg_segment_image`. */
#define SCANSEG_IMAGE_WORK(rows, columns) (2 * ((size_t)(rows) * (size_t)(columns) + 1))

/** An output that nothing was asked of yet: `scanseg_output output = SCANSEG_OUTPUT_INIT;` */
#define SCANSEG_OUTPUT_INIT {sizeof(scanseg_output), 0, NULL, 0, NULL, 0, NULL, NULL, 0, 0, 0, 0, 0, 0}


/**
 * `approach`: planes that go on from row to row. The default, and right at the noise of real
 * scanners.
 */
#define SCANSEG_PLANE 0

/**
 * `approach`: areas between edges of bearing-angle images, as in the paper. Labels come three rows
 * late.
 */
#define SCANSEG_EDGE 1

/**
 * `approach`: regions grown from the lines of each row, the paper's other one.
 */
#define SCANSEG_REGION 2

/**
 * `beams`: a 2D scanner whose scan plane tilts about the axis y (to the left).
 * Direction = (cos b cos t, sin b, cos b sin t) for the column angle b and the row angle t.
 */
#define SCANSEG_NODDING_Y 1

/**
 * `beams`: a 2D scanner whose scan plane pans about the axis z (upright). Direction = (cos b cos
 * t, cos b sin t, sin b).
 */
#define SCANSEG_NODDING_Z 2

/**
 * `beams`: a spinning scanner. Direction = (cos e cos a, cos e sin a, sin e) for the column angle
 * a (azimuth) and the row angle e (elevation).
 */
#define SCANSEG_SPINNING 3

/**
 * `beams`: a camera. Direction = (1, -(u - cx) / fx, -(v - cy) / fy), normalised, for column u and
 * row v. Ranges are along the beam, not depths.
 */
#define SCANSEG_PINHOLE 4

/**
 * `beams`: any; each row brings the directions of its beams, see `scanseg_row_beams`. Takes some
 * two times as long as the other kinds.
 */
#define SCANSEG_FREE 5

/**
 * `closing`: a pixel and its four neighbours, as in the paper.
 */
#define SCANSEG_PLUS 0

/**
 * `closing`: 3 x 3 pixels.
 */
#define SCANSEG_SQUARE 1

/**
 * Elements of `traces`.
 */
#define SCANSEG_MAX_TRACES 8

/**
 * `kind` of an event: pixels labelled `label` in earlier rows belong to `into`, the smaller label.
 */
#define SCANSEG_JOIN 1

/**
 * `kind` of an event: the segment `label` is complete. With `SCANSEG_PLANE` it may still be joined
 * with another one that turns out to be a part of the same surface; then it is given again when
 * that is complete, and the later one counts.
 */
#define SCANSEG_SEGMENT 2

/**
 * A pixel: nothing was measured.
 */
#define SCANSEG_NO_RETURN 0

/**
 * A pixel: part of an edge; of the approaches by plane and region: on no surface.
 */
#define SCANSEG_ON_EDGE 4294967295

/**
 * A pixel: part of an area that got no label, because the table of live labels was full.
 */
#define SCANSEG_UNLABELLED 4294967294

/**
 * Rows of labels that `scanseg_finish` gives out at most: `SCANSEG_EDGE` is so many rows late, the
 * others are not.
 */
#define SCANSEG_LATENCY_ROWS 3

/**
 * Alignment of the memory of a segmenter, bytes.
 */
#define SCANSEG_STATE_ALIGN 8

/**
 * Version of this header: first number.
 */
#define SCANSEG_VERSION_MAJOR 0

/**
 * Version of this header: second number.
 */
#define SCANSEG_VERSION_MINOR 1

/**
 * Version of this header: third number.
 */
#define SCANSEG_VERSION_PATCH 0

/**
 * Counts the incompatible changes of structs and functions. `scanseg_config_init` and
 * `scanseg_init` compare it with the library's.
 */
#define SCANSEG_ABI_VERSION 4

/**
 * A segmenter, in memory of yours.
 */
typedef struct scanseg_segmenter scanseg_segmenter;

/**
 * What a call answers: one of the `SCANSEG_` statuses. 0 is success, above 0 there is something to
 * know, below 0 the call did nothing.
 */
typedef int32_t scanseg_status;

/**
 * A direction through the image: from a pixel back to the previous one on the trace.
 */
typedef struct scanseg_trace {
    /**
     * The previous pixel is so many rows earlier, 0 to 16.
     */
    uint8_t rows;
    /**
     * And so many columns to the left; negative, only with `rows` above 0, is to the right.
     */
    int8_t columns;
} scanseg_trace;

/**
 * The configuration of a segmenter. `scanseg_config_init` sets it to the defaults; then at least
 * `columns` and `beams` are to be set, and what the beams need. It is copied: nothing of it need
 * stay after `scanseg_init`.
 */
typedef struct scanseg_config {
    /**
     * `sizeof(scanseg_config)`.
     */
    uint32_t struct_size;
    /**
     * `SCANSEG_ABI_VERSION`.
     */
    uint32_t abi_version;
    /**
     * `SCANSEG_PLANE` (default), `SCANSEG_EDGE` or `SCANSEG_REGION`.
     */
    uint32_t approach;
    /**
     * Columns of the image, 1 to 16384. No default.
     */
    uint32_t columns;
    /**
     * Most live labels; 0 (default): as many as any indoor scan needs, and by the paper's two
     * approaches any image. Fewer save 88 bytes each.
     */
    uint32_t max_labels;
    /**
     * `SCANSEG_NODDING_Y`, `SCANSEG_NODDING_Z`, `SCANSEG_SPINNING` or `SCANSEG_PINHOLE`. No
     * default.
     */
    uint32_t beams;
    /**
     * Spinning and free: 1 if the last column neighbours the first, else 0. Even columns must then go round
     * exactly once.
     */
    uint32_t wraps;
    /**
     * Nodding and spinning, even columns: angle of column 0, radians, within +-2 pi. Nodding:
     * measured from the middle of the scan plane, so that the axis is at +-pi / 2.
     */
    float column_start_rad;
    /**
     * From a column to the next, radians; not 0, within +-pi / 2.
     */
    float column_step_rad;
    /**
     * Nodding and spinning, columns that are not even: one angle per column, radians. NULL: they
     * are even.
     */
    const float *column_angles_rad;
    /**
     * Elements of `column_angles_rad`: `columns`, or 0 for even columns.
     */
    uint32_t column_angle_count;
    /**
     * Nodding, with `column_angles_rad`: how much more than its row each column is turned, radians,
     * within +-pi / 2, as of the lasers of one firing that look beside it. NULL: not at all.
     */
    const float *column_turns_rad;
    /**
     * Elements of `column_turns_rad`: `columns`, or 0.
     */
    uint32_t column_turn_count;
    /**
     * Plane: 1 if a scan is a full turn, whose last row neighbours its first one, as the firings of a
     * spinning lidar; else 0 (default).
     */
    uint32_t full_turns;
    /**
     * Pinhole: focal length along a row, pixels; not 0.
     */
    float fx_px;
    /**
     * Pinhole: focal length along a column, pixels; not 0.
     */
    float fy_px;
    /**
     * Pinhole: column of the optical axis.
     */
    float cx_px;
    /**
     * Pinhole: row of the optical axis.
     */
    float cy_px;
    /**
     * Standard deviation of one range, metres, 0 to 10; default 0.01. `SCANSEG_PLANE` measures the
     * noise in the scan too, and the larger of both counts; with 0 that measured.
     */
    float range_noise_m;
    /**
     * Plane: the standard deviation grows by so much with each metre of the range; 0 to 1, default
     * 0. Only `SCANSEG_PLANE` uses this and what follows up to `flatness_m`.
     */
    float range_noise_per_m;
    /**
     * Plane: and by so much with the square of the range, 1 / m; 0 to 1, default 0. Cameras with a
     * disparity noise of d pixels at baseline B and focal length f have d / (f B).
     */
    float range_noise_per_m2;
    /**
     * Plane: step between neighbouring counts of a range, metres; 0 to 10, default 0.
     */
    float range_step_m;
    /**
     * Plane: the same, growing with the square of the range, 1 / m; 0 to 1, default 0.
     */
    float range_step_per_m2;
    /**
     * Plane: pixels over which errors of ranges are alike, along rows and columns; 1 to 100,
     * default 1. Depth cameras: 4.
     */
    float noise_correlation_px;
    /**
     * Plane: standard deviation of the direction of a beam within its row, radians; 0 to 0.1,
     * default 0.
     */
    float beam_noise_rad;
    /**
     * Plane: standard deviation of the turn angle of a row, radians; 0 to 0.1, default 0. Of nodding
     * scanners only.
     */
    float turn_noise_rad;
    /**
     * Plane: surfaces are flat to this, one standard deviation across the plane, metres; 0 to 10,
     * default 0.
     */
    float flatness_m;
    /**
     * Nearer ranges are no return, metres, above 0; default 0.05.
     */
    float min_range_m;
    /**
     * Farther ranges are no return, metres, up to 500; default 100.
     */
    float max_range_m;
    /**
     * Edge: a roof edge is where the bearing angle turns by this much, radians, above 0, up to pi;
     * default 20 deg.
     */
    float roof_angle_rad;
    /**
     * Edge: a step edge needs a bearing angle within this of 0 or pi, radians, 0 to pi / 2;
     * default 6 deg.
     */
    float step_angle_rad;
    /**
     * Edge: `SCANSEG_PLUS` (default) or `SCANSEG_SQUARE`.
     */
    uint32_t closing;
    /**
     * Region: a line ends where the bearing angle turns by this much, radians, above 0, up to pi /
     * 2; default 3 deg.
     */
    float line_angle_rad;
    /**
     * Region: how far a surface may be from a plane beside the noise, metres, 0 to 1; default
     * 0.005.
     */
    float plane_distance_m;
    /**
     * Edge: how many of `traces` are used, 1 to 8; default 2.
     */
    uint32_t trace_count;
    /**
     * Edge: the traces whose edges are combined; default: along rows and along columns, between
     * neighbours.
     */
    struct scanseg_trace traces[SCANSEG_MAX_TRACES];
} scanseg_config;

/**
 * Two areas are one, or a segment is complete. Of a join only `kind`, `label` and `into` are set,
 * the rest is 0.
 */
typedef struct scanseg_event {
    /**
     * `SCANSEG_JOIN` or `SCANSEG_SEGMENT`.
     */
    uint32_t kind;
    /**
     * The segment's label, or the label that ends here. Labels count up from 1 and are never used
     * twice within a scan.
     */
    uint32_t label;
    /**
     * Join: the label that goes on.
     */
    uint32_t into;
    /**
     * Segment: number of its pixels.
     */
    uint32_t pixels;
    /**
     * Segment: first row with a pixel of it.
     */
    uint16_t first_row;
    /**
     * Segment: last row with a pixel of it.
     */
    uint16_t last_row;
    /**
     * Segment: leftmost column with a pixel of it. Across the seam of a wrapped image: 0.
     */
    uint16_t first_column;
    /**
     * Segment: rightmost column with a pixel of it. Across the seam of a wrapped image: the last
     * one.
     */
    uint16_t last_column;
    /**
     * Segment of `SCANSEG_EDGE` or `SCANSEG_REGION`: sums of x, y, z over its points, in units of
     * 1/4096 m. By planes 0.
     */
    int64_t first_moments[3];
    /**
     * The same: sums of xx, yy, zz, xy, xz, yz, in units of 1/4096 m squared. See
     * `scanseg_fit_plane`.
     */
    int64_t second_moments[6];
    /**
     * Segment of `SCANSEG_PLANE`: its plane with the sums that it was found from. Else 0.
     * `scanseg_fit_plane` makes a plane of it with its covariance. With the beam u of a point, a
     * unit vector, and its weight r^4 / sigma^2 of its range r and the standard deviation of that:
     * the sum of the weights, less what errors that all pixels of a row share take of it, m^2; the
     * sum of the weights, m^2; x, y, z of the weighted mean of the beams; xx, yy, zz, xy, xz,
     * yz of their weighted scatter about it, m^2; x, y, z of the plane m, the points p with p . m =
     * 1, 1 / m; the sum of the squared range errors in units of the noise.
     */
    float plane_sums[15];
} scanseg_event;

/**
 * Called with each event while a call runs: `user` is that of the output, the event lives for the
 * call. Answer 0 to go on, anything else to drop the scan. It must return (no exception, no
 * longjmp), and must not use the segmenter.
 */
typedef int32_t (*scanseg_on_event)(void *user, const struct scanseg_event *event);

/**
 * Where a call puts what it finds, and how much that was. Start with `SCANSEG_OUTPUT_INIT`, set
 * what you want, and use it for all calls. Everything may be left out: without labels and events
 * only the callback is told, and so on.
 */
typedef struct scanseg_output {
    /**
     * `sizeof(scanseg_output)`.
     */
    uint32_t struct_size;
    /**
     * Given out: number of the first row of `labels`.
     */
    uint32_t first_row;
    /**
     * For the labels, one per pixel, row after row: the label of a segment, `SCANSEG_NO_RETURN`,
     * `SCANSEG_ON_EDGE` or `SCANSEG_UNLABELLED`. NULL: no labels.
     */
    uint32_t *labels;
    /**
     * Elements of `labels`: at least `columns` for `scanseg_push_row`, and with `SCANSEG_EDGE`
     * `SCANSEG_LATENCY_ROWS * columns` for `scanseg_finish`; `rows * columns` for
     * `scanseg_segment_image`.
     */
    size_t label_capacity;
    /**
     * For the events, in their order. NULL: no events.
     */
    struct scanseg_event *events;
    /**
     * Elements of `events`; for one row `SCANSEG_MAX_EVENTS(columns)` always suffice.
     */
    size_t event_capacity;
    /**
     * Called with each event; or NULL. Needs no array.
     */
    scanseg_on_event on_event;
    /**
     * For the callback.
     */
    void *user;
    /**
     * Given out: events in `events`.
     */
    size_t event_count;
    /**
     * Given out: events that did not fit; by `scanseg_segment_image` also where there is no array.
     */
    size_t events_lost;
    /**
     * Given out: rows in `labels`, or that would be if there were `labels`.
     */
    uint32_t row_count;
    /**
     * Given out: pixels in these rows that got no label, because the table of live labels was
     * full.
     */
    uint32_t unlabelled;
    /**
     * Given out by `scanseg_finish` and `scanseg_segment_image`: rows of the scan.
     */
    uint32_t scan_rows;
    /**
     * Given out: the share by which beam angles are too small, as the walls of the scan so far tell
     * it. 0.01: a beam that is said to be 30 deg from the middle one is 30.3 deg from it, and
     * planes are those of the points along such beams. 0 where angles are right or nothing tells,
     * and but for `SCANSEG_PLANE` with nodding beams; else 0.003 to 0.12 either way.
     */
    float beam_stretch;
} scanseg_output;

/**
 * Where the beams of one row point, beside what the configuration says of all rows.
 * `scanseg_row_beams_init` sets it to a row of this turn and nothing else. What is not used costs
 * nothing; what is used costs a sine and a cosine per pixel at most.
 */
typedef struct scanseg_row_beams {
    /**
     * `sizeof(scanseg_row_beams)`.
     */
    uint32_t struct_size;
    /**
     * The row's turn (nodding) or elevation (spinning), radians, within +-6300.
     */
    float turn_rad;
    /**
     * Nodding and spinning: added to the angles of all columns, radians, within +-2 pi. A laser that
     * looks beside the others.
     */
    float offset_rad;
    /**
     * Nodding: distance of the scanner's origin from the axis about which it turns, along the beam
     * at angle 0, metres, within +-10.
     */
    float lever_arm_m;
    /**
     * Nodding: column c is turned by `c * column_turn_rad + (c % sets) * set_turn_rad` more than the
     * row, as the turn goes on while the row is measured; over a row within +-pi / 2.
     */
    float column_turn_rad;
    /**
     * Nodding: sets of columns that lie between one another and are measured set after set, 1 to
     * 255.
     */
    uint32_t sets;
    /**
     * Nodding: from a set to the next, radians; over all sets within +-pi / 2.
     */
    float set_turn_rad;
    /**
     * `SCANSEG_FREE`: the directions of the beams, unit vectors, x, y and z of each column; else NULL.
     */
    const float *directions;
    /**
     * Elements of `directions`: three times the columns, or 0.
     */
    size_t direction_count;
} scanseg_row_beams;

/**
 * The plane of a segment: the points p with normal . p + distance = 0; x forward, y left, z up.
 */
typedef struct scanseg_plane {
    /**
     * Mean of the points, metres. `SCANSEG_PLANE`: the middle of the points as the scanner sees
     * them, on the plane; far points weigh more.
     */
    float centroid_m[3];
    /**
     * Unit normal towards the scanner.
     */
    float normal[3];
    /**
     * Distance of the plane from the scanner, metres; not negative.
     */
    float distance_m;
    /**
     * Root of the mean squared distance of the points from the plane, metres.
     */
    float rms_m;
    /**
     * Covariance of (normal x, y, z, distance): symmetric, in rad^2, rad m and m^2. Of rank 3. From
     * the residuals, and where these are below 1/4096 m from the rounding of points; `SCANSEG_PLANE`: from the noise that the ranges are said or found to have, and
     * from the residuals where these are larger.
     */
    float covariance[4][4];
} scanseg_plane;

/**
 * Done.
 */
#define SCANSEG_OK 0

/**
 * Done; but the array of events was full, and `events_lost` events did not fit. A callback was
 * given all of them.
 */
#define SCANSEG_EVENTS_FULL 1

/**
 * The callback asked to stop. The scan is dropped: reset the segmenter for the next one.
 */
#define SCANSEG_STOPPED 2

/**
 * The points have no plane: fewer than four, on a line, or too many and far to be summed up
 * exactly.
 */
#define SCANSEG_NO_PLANE 3

/**
 * A pointer is NULL that must not be.
 */
#define SCANSEG_ERROR_NULL -1

/**
 * `struct_size` is not that of this library: the header is of another version, or the field was
 * not set.
 */
#define SCANSEG_ERROR_STRUCT_SIZE -2

/**
 * The program was compiled with a header of another `SCANSEG_ABI_VERSION`.
 */
#define SCANSEG_ERROR_ABI_VERSION -3

/**
 * A pointer is not aligned as its type asks; the memory of a segmenter, to `SCANSEG_STATE_ALIGN`.
 */
#define SCANSEG_ERROR_ALIGNMENT -4

/**
 * The memory is smaller than `scanseg_state_size` says.
 */
#define SCANSEG_ERROR_MEMORY_SIZE -5

/**
 * A value of the configuration cannot be used: `scanseg_bad_field` says which.
 */
#define SCANSEG_ERROR_CONFIG -6

/**
 * There is no segmenter: not made yet, overwritten, or copied from elsewhere.
 */
#define SCANSEG_ERROR_NO_SEGMENTER -7

/**
 * The segmenter was called from its own callback.
 */
#define SCANSEG_ERROR_BUSY -8

/**
 * The scan is over: finished, or stopped by the callback. Reset the segmenter for the next one.
 */
#define SCANSEG_ERROR_SCAN_OVER -9

/**
 * The row does not have one range per column, or not one direction. The row was not taken.
 */
#define SCANSEG_ERROR_ROW_LENGTH -10

/**
 * The angle of the row is NaN, infinite or beyond 6300 rad. The row was not taken.
 */
#define SCANSEG_ERROR_TURN_ANGLE -11

/**
 * The scan already has 65535 rows. The row was not taken.
 */
#define SCANSEG_ERROR_TOO_MANY_ROWS -12

/**
 * The array of labels is too small. Nothing was done.
 */
#define SCANSEG_ERROR_LABELS_SIZE -13

/**
 * The work memory is smaller than `SCANSEG_IMAGE_WORK` says. Nothing was done.
 */
#define SCANSEG_ERROR_WORK_SIZE -14

/**
 * A number or a direction of `scanseg_row_beams` cannot be used. The row was not taken.
 */
#define SCANSEG_ERROR_ROW_BEAMS -15

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * Version of the library, "major.minor.patch".
 */
const char *scanseg_version(void);

/**
 * Version of the library: 10000 * major + 100 * minor + patch.
 */
uint32_t scanseg_version_number(void);

/**
 * `SCANSEG_ABI_VERSION` of the library.
 */
uint32_t scanseg_abi_version(void);

/**
 * What a status means, in a few words. Never NULL.
 */
const char *scanseg_strerror(scanseg_status status);

/**
 * Sets a configuration to the defaults:
 * `scanseg_config_init(&config, sizeof config, SCANSEG_ABI_VERSION)`.
 *
 * @return `SCANSEG_OK`, or an error if the header is of another version than the library.
 */
scanseg_status scanseg_config_init(struct scanseg_config *config, uint32_t struct_size, uint32_t abi_version);

/**
 * Name of the first field of a configuration that cannot be used; NULL if there is none, or no
 * configuration.
 */
const char *scanseg_bad_field(const struct scanseg_config *config);

/**
 * Bytes that a segmenter of this configuration needs: at most `SCANSEG_STATE_SIZE(columns)`, or
 * what `SCANSEG_STATE_SIZE_WITH` gives. To be aligned to `SCANSEG_STATE_ALIGN`, which any memory
 * of `malloc` is.
 *
 * @param size is set to the bytes; to 0 if there is an error.
 * @return `SCANSEG_OK`, or what is wrong with the configuration.
 */
scanseg_status scanseg_state_size(const struct scanseg_config *config, size_t *size);

/**
 * `SCANSEG_STATE_ALIGN` of the library.
 */
size_t scanseg_state_align(void);

/**
 * Makes a segmenter in `memory`, ready for the first row. What the memory held before does not
 * matter. The memory stays the caller's, who leaves it alone until done with the segmenter.
 *
 * @param size bytes of `memory`; see `scanseg_state_size`.
 * @param segmenter is set to the segmenter, which is at the start of `memory`; to NULL if there is
 *        an error.
 * @return `SCANSEG_OK`, or what is wrong.
 */
scanseg_status scanseg_init(void *memory,
                            size_t size,
                            const struct scanseg_config *config,
                            struct scanseg_segmenter **segmenter);

/**
 * Takes the next row. Work is linear in the columns, whatever is seen: `SCANSEG_PLANE` takes up to
 * seven times as much for scenes that no plane explains as for an office.
 *
 * @param ranges_m one range per column, metres along the beam. NaN, infinite and non-positive
 *        ranges, and those outside of the configured limits, are pixels without a return.
 * @param columns elements of `ranges_m`; must be the columns of the image.
 * @param turn_rad the row's turn (nodding) or elevation (spinning), radians; a camera does not use
 *        it.
 * @param output is given the labels of this row (`SCANSEG_EDGE`: of the row `SCANSEG_LATENCY_ROWS`
 *        earlier, if there is one), and the joins and segments that it brings. After an error it
 *        is as it was.
 * @return `SCANSEG_OK`, `SCANSEG_EVENTS_FULL`, `SCANSEG_STOPPED`, or an error: then the row was
 *        not taken.
 */
scanseg_status scanseg_push_row(struct scanseg_segmenter *segmenter,
                                const float *ranges_m,
                                size_t columns,
                                float turn_rad,
                                struct scanseg_output *output);

/**
 * Sets the beams of a row to those at this turn angle, and nothing else:
 * `scanseg_row_beams_init(&beams, sizeof beams, turn_rad)`.
 *
 * @return `SCANSEG_OK`, or an error if the header is of another version than the library.
 */
scanseg_status scanseg_row_beams_init(struct scanseg_row_beams *beams, uint32_t struct_size, float turn_rad);

/**
 * The same as `scanseg_push_row`, for a row whose beams lie beside where its turn alone says.
 *
 * @param beams where they lie. It is not kept.
 * @return as `scanseg_push_row`, and `SCANSEG_ERROR_ROW_BEAMS` for beams that cannot be used.
 */
scanseg_status scanseg_push_row_beams(struct scanseg_segmenter *segmenter,
                                      const float *ranges_m,
                                      size_t columns,
                                      const struct scanseg_row_beams *beams,
                                      struct scanseg_output *output);

/**
 * Ends the scan: gives out the labels that were still waiting (`SCANSEG_EDGE`: up to
 * `SCANSEG_LATENCY_ROWS` rows) and completes all segments. Before the next scan the segmenter is
 * to be reset.
 *
 * @return `SCANSEG_OK`, `SCANSEG_EVENTS_FULL`, `SCANSEG_STOPPED`, or an error: then the scan goes
 *        on.
 */
scanseg_status scanseg_finish(struct scanseg_segmenter *segmenter, struct scanseg_output *output);

/**
 * Drops what was pushed, if anything: the next row is the first of a new scan.
 */
scanseg_status scanseg_reset(struct scanseg_segmenter *segmenter);

/**
 * Segments a whole image in one call, in place of `scanseg_push_row` for each row and
 * `scanseg_finish`, and applies all joins: each pixel has the label that its surface has in the end,
 * and the events are the segments that are left, each once, in the order of their labels. Any scan
 * that is under way is dropped before; the next image needs no reset. Work is linear in the pixels.
 *
 * Where room runs out the result is still defined. Segments that do not fit in `events` are
 * counted: `event_count + events_lost` is the number of segments, and their labels are right.
 * Pixels for which the segmenter's table had no room are `SCANSEG_UNLABELLED`, and counted.
 *
 * @param ranges_m `rows` times `columns` ranges, row after row; see `scanseg_push_row`.
 * @param rows rows of the image, up to 65535.
 * @param columns must be the columns of the segmenter.
 * @param turns_rad the turn (nodding) or elevation (spinning) of each row, radians; a camera and free
 *        beams need none, and may have NULL.
 * @param directions with `SCANSEG_FREE` the directions of all pixels, x, y and z of each, row after
 *        row: `3 * rows * columns` numbers; otherwise NULL.
 * @param work memory of yours that the call works in; what it holds before and afterwards does not
 *        matter.
 * @param work_capacity elements of `work`: at least `SCANSEG_IMAGE_WORK(rows, columns)`.
 * @param output is given the labels of the image and its segments. The callback, if there is one,
 *        is told each join and segment as they come, before the joins are applied.
 * @return `SCANSEG_OK`, `SCANSEG_EVENTS_FULL`, `SCANSEG_STOPPED` (the output has the rows and
 *        segments so far), or an error. A turn angle or a direction that cannot be used is found when its row comes:
 *        then the arrays hold nothing of use, and the scan is dropped.
 */
scanseg_status scanseg_segment_image(struct scanseg_segmenter *segmenter,
                                     const float *ranges_m,
                                     size_t rows,
                                     size_t columns,
                                     const float *turns_rad,
                                     const float *directions,
                                     uint32_t *work,
                                     size_t work_capacity,
                                     struct scanseg_output *output);

/**
 * The plane of a segment. `SCANSEG_PLANE`: that of least squares of the range errors, some 300
 * operations in single precision; segments of one row have none. Else: that of total least squares,
 * some 2000 operations in double precision; ask for the segments that matter.
 *
 * @param segment an event of the kind `SCANSEG_SEGMENT`.
 * @param plane is set to the plane, unless there is none or an error.
 * @return `SCANSEG_OK`, `SCANSEG_NO_PLANE` or an error.
 */
scanseg_status scanseg_fit_plane(const struct scanseg_event *segment, struct scanseg_plane *plane);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* SCANSEG_H */
