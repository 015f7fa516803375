/* The library from C: misuse is told by a status, the macros say what the functions say, a scan gives its plane. Run under
 * valgrind and AddressSanitizer. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <scanseg.h>

enum { COLUMNS = 181, ROWS = 40 };

static int failures;

#define CHECK(condition) \
    do { \
        if (!(condition)) { \
            printf("%s:%d: %s\n", __FILE__, __LINE__, #condition); \
            failures++; \
        } \
    } while (0)

static scanseg_config configuration(uint32_t columns) {
    scanseg_config config;
    CHECK(scanseg_config_init(&config, sizeof config, SCANSEG_ABI_VERSION) == SCANSEG_OK);
    config.columns = columns;
    config.beams = SCANSEG_NODDING_Y;
    config.column_start_rad = -1.5f;
    config.column_step_rad = columns > 1 ? 3.0f / (float)columns : 0.1f;
    return config;
}

static void versions(void) {
    char text[32];
    snprintf(text, sizeof text, "%d.%d.%d", SCANSEG_VERSION_MAJOR, SCANSEG_VERSION_MINOR, SCANSEG_VERSION_PATCH);
    CHECK(strcmp(text, scanseg_version()) == 0);
    CHECK(scanseg_abi_version() == SCANSEG_ABI_VERSION);
    CHECK(scanseg_state_align() == SCANSEG_STATE_ALIGN);
    CHECK(strcmp(scanseg_strerror(SCANSEG_OK), "success") == 0);
    CHECK(strcmp(scanseg_strerror(12345), scanseg_strerror(-12345)) == 0);
}

/* The macros against the function: never less, and not much more. */
static void sizes(void) {
    static float angles[16384];
    for (uint32_t columns = 1; columns <= 16384; columns += columns < 800 ? 1 : 97) {
        for (unsigned listed = 0; listed < 2; listed++) {
            for (uint32_t traces = 1; traces <= SCANSEG_MAX_TRACES; traces++) {
                unsigned rows = 1 + 5 * (traces % 4);
                scanseg_config config = configuration(columns);
                size_t size;
                config.trace_count = traces;
                for (uint32_t i = 0; i < traces; i++) {
                    config.traces[i].rows = (uint8_t)rows;
                    config.traces[i].columns = 0;
                }
                if (listed) {
                    config.column_angles_rad = angles;
                    config.column_angle_count = columns;
                }
                CHECK(scanseg_state_size(&config, &size) == SCANSEG_OK);
                CHECK(size <= SCANSEG_STATE_SIZE_WITH(columns, listed, traces, rows));
                CHECK(size + size / 20 + 1024 + 140 * traces >= SCANSEG_STATE_SIZE_WITH(columns, listed, traces, rows));
                config = configuration(columns);
                CHECK(scanseg_state_size(&config, &size) == SCANSEG_OK && size <= SCANSEG_STATE_SIZE(columns));
            }
        }
    }
}

static int stop(void *user, const scanseg_event *event) {
    (void)event;
    return ++*(int *)user;
}

/* A wall across, 2 m ahead, by each approach: one segment, its plane at x = 2. */
static void wall(uint32_t approach) {
    scanseg_config config = configuration(COLUMNS);
    scanseg_segmenter *segmenter;
    scanseg_output output = SCANSEG_OUTPUT_INIT;
    static uint32_t labels[SCANSEG_LATENCY_ROWS * COLUMNS];
    static scanseg_event events[SCANSEG_MAX_EVENTS(COLUMNS)];
    size_t size;
    config.approach = approach;
    config.beams = SCANSEG_PINHOLE;
    config.fx_px = config.fy_px = COLUMNS;
    config.cx_px = COLUMNS / 2;
    config.cy_px = ROWS / 2;
    CHECK(scanseg_state_size(&config, &size) == SCANSEG_OK);
    char *memory = malloc(size);
    CHECK(scanseg_init(memory, size - 1, &config, &segmenter) == SCANSEG_ERROR_MEMORY_SIZE && segmenter == NULL);
    CHECK(scanseg_init(memory, size, &config, &segmenter) == SCANSEG_OK && (void *)segmenter == (void *)memory);
    output.labels = labels;
    output.label_capacity = sizeof labels / sizeof *labels;
    output.events = events;
    output.event_capacity = sizeof events / sizeof *events;
    for (int scan = 0; scan < 3; scan++) {
        unsigned labelled = 0;
        int events_before_stop = 0;
        for (int row = 0; row < ROWS; row++) {
            float ranges_m[COLUMNS];
            for (int i = 0; i < COLUMNS; i++) {
                float u = (float)(i - COLUMNS / 2) / COLUMNS, v = (float)(row - ROWS / 2) / COLUMNS;
                float square = 1 + u * u + v * v, root = 1;
                for (int k = 0; k < 6; k++) root = (root + square / root) / 2;
                ranges_m[i] = 2 * root;
            }
            CHECK(scanseg_push_row(segmenter, ranges_m, COLUMNS, 0, &output) == SCANSEG_OK);
            if (output.row_count > 0) CHECK(output.first_row == labelled);
            labelled += output.row_count;
        }
        /* the second scan is stopped by the callback, the third finds the array of events full */
        output.on_event = scan == 1 ? stop : NULL;
        output.user = &events_before_stop;
        if (scan == 2) output.event_capacity = 0;
        int status = scanseg_finish(segmenter, &output);
        if (scan == 0) {
            scanseg_plane plane;
            CHECK(status == SCANSEG_OK && output.event_count == 1 && output.scan_rows == ROWS);
            CHECK(labelled + output.row_count == ROWS && output.beam_stretch == 0);
            CHECK(events[0].kind == SCANSEG_SEGMENT && events[0].pixels > (COLUMNS - 8) * (ROWS - 8));
            CHECK(scanseg_fit_plane(&events[0], &plane) == SCANSEG_OK);
            CHECK(plane.normal[0] < -0.9999f && plane.distance_m > 1.999f && plane.distance_m < 2.001f);
            CHECK(plane.rms_m < 0.001f && plane.covariance[3][3] >= 0);
        } else if (scan == 1) {
            CHECK(status == SCANSEG_STOPPED && events_before_stop == 1);
        } else {
            CHECK(status == SCANSEG_EVENTS_FULL && output.event_count == 0 && output.events_lost == 1);
        }
        CHECK(scanseg_finish(segmenter, &output) == SCANSEG_ERROR_SCAN_OVER);
        CHECK(scanseg_reset(segmenter) == SCANSEG_OK);
    }
    char *copy = malloc(size);
    memcpy(copy, memory, size);
    CHECK(scanseg_reset((scanseg_segmenter *)(void *)copy) == SCANSEG_ERROR_NO_SEGMENTER);
    free(copy);
    free(memory);
}

/* Two walls with a post in front of one, in one call: few segments, whose pixels are those of their labels. */
static void image(uint32_t approach) {
    scanseg_config config = configuration(COLUMNS);
    scanseg_segmenter *segmenter;
    scanseg_output output = SCANSEG_OUTPUT_INIT;
    static double memory[SCANSEG_STATE_SIZE(COLUMNS) / sizeof(double) + 1];
    static float ranges_m[ROWS * COLUMNS], turns_rad[ROWS];
    static uint32_t labels[ROWS * COLUMNS], work[SCANSEG_IMAGE_WORK(ROWS, COLUMNS)];
    static scanseg_event events[1000];
    unsigned total = 0;
    config.approach = approach;
    CHECK(scanseg_init(memory, sizeof memory, &config, &segmenter) == SCANSEG_OK);
    for (int row = 0; row < ROWS; row++) {
        turns_rad[row] = 0.01f * (float)(row - ROWS / 2);
        for (int i = 0; i < COLUMNS; i++) ranges_m[row * COLUMNS + i] = i / 8 == 9 && row > 3 ? 1.0f : 2.0f;
    }
    output.labels = labels;
    output.label_capacity = ROWS * COLUMNS;
    output.events = events;
    output.event_capacity = 1000;
    CHECK(scanseg_segment_image(segmenter, ranges_m, ROWS, COLUMNS, turns_rad, NULL, work, SCANSEG_IMAGE_WORK(ROWS, COLUMNS),
                                &output) == SCANSEG_OK);
    CHECK(output.row_count == ROWS && output.event_count > 0 && output.events_lost == 0);
    for (size_t i = 0; i < output.event_count; i++) {
        unsigned pixels = 0;
        for (size_t j = 0; j < ROWS * COLUMNS; j++) pixels += labels[j] == events[i].label;
        CHECK(events[i].kind == SCANSEG_SEGMENT && pixels == events[i].pixels);
        total += pixels;
    }
    CHECK(total > ROWS * COLUMNS / 2);
    /* without arrays: the number of segments */
    total = (unsigned)output.event_count;
    output.labels = NULL;
    output.events = NULL;
    output.event_capacity = 0;
    CHECK(scanseg_segment_image(segmenter, ranges_m, ROWS, COLUMNS, turns_rad, NULL, work, SCANSEG_IMAGE_WORK(ROWS, COLUMNS),
                                &output) == SCANSEG_OK);
    CHECK(output.event_count == 0 && output.events_lost == total);
}

static void misuse(void) {
    scanseg_config config = configuration(COLUMNS);
    scanseg_segmenter *segmenter;
    scanseg_output output = SCANSEG_OUTPUT_INIT;
    static double memory[SCANSEG_STATE_SIZE(COLUMNS) / sizeof(double) + 1];
    float ranges_m[COLUMNS] = {0};
    size_t size;
    CHECK(scanseg_config_init(NULL, sizeof config, SCANSEG_ABI_VERSION) == SCANSEG_ERROR_NULL);
    CHECK(scanseg_config_init(&config, sizeof config - 4, SCANSEG_ABI_VERSION) == SCANSEG_ERROR_STRUCT_SIZE);
    CHECK(scanseg_config_init(&config, sizeof config, SCANSEG_ABI_VERSION + 1) == SCANSEG_ERROR_ABI_VERSION);
    CHECK(scanseg_state_size(NULL, &size) == SCANSEG_ERROR_NULL && size == 0);
    CHECK(scanseg_state_size(&config, NULL) == SCANSEG_ERROR_NULL);
    CHECK(scanseg_init(NULL, sizeof memory, &config, &segmenter) == SCANSEG_ERROR_NULL && segmenter == NULL);
    CHECK(scanseg_init((char *)memory + 4, sizeof memory - 4, &config, &segmenter) == SCANSEG_ERROR_ALIGNMENT);
    CHECK(scanseg_init(memory, sizeof memory, &config, NULL) == SCANSEG_ERROR_NULL);
    CHECK(scanseg_push_row((scanseg_segmenter *)(void *)memory, ranges_m, COLUMNS, 0, &output)
          == SCANSEG_ERROR_NO_SEGMENTER);
    config.range_noise_m = -1;
    CHECK(scanseg_init(memory, sizeof memory, &config, &segmenter) == SCANSEG_ERROR_CONFIG);
    CHECK(strcmp(scanseg_bad_field(&config), "range_noise_m") == 0);
    config = configuration(COLUMNS);
    CHECK(scanseg_bad_field(&config) == NULL);
    CHECK(scanseg_init(memory, sizeof memory, &config, &segmenter) == SCANSEG_OK);
    CHECK(scanseg_push_row(segmenter, NULL, COLUMNS, 0, &output) == SCANSEG_ERROR_NULL);
    CHECK(scanseg_push_row(segmenter, ranges_m, COLUMNS, 0, NULL) == SCANSEG_ERROR_NULL);
    CHECK(scanseg_push_row(segmenter, ranges_m, COLUMNS - 1, 0, &output) == SCANSEG_ERROR_ROW_LENGTH);
    CHECK(scanseg_push_row(segmenter, ranges_m, COLUMNS, 1e6f, &output) == SCANSEG_ERROR_TURN_ANGLE);
    CHECK(scanseg_push_row(segmenter, ranges_m, COLUMNS, 0, &output) == SCANSEG_OK && output.row_count == 1);
    CHECK(scanseg_fit_plane(NULL, NULL) == SCANSEG_ERROR_NULL);
    memset(memory, 0xA5, sizeof memory);
    CHECK(scanseg_finish(segmenter, &output) == SCANSEG_ERROR_NO_SEGMENTER);
}

int main(void) {
    versions();
    sizes();
    for (uint32_t approach = SCANSEG_PLANE; approach <= SCANSEG_REGION; approach++) {
        wall(approach);
        image(approach);
    }
    misuse();
    printf("%d failures\n", failures);
    return failures != 0;
}
