/* A wall, row by row: the example of the README. */
#include <math.h>
#include <stdio.h>

#include <scanseg.h>

enum { COLUMNS = 181, ROWS = 60 };

static uint64_t memory[SCANSEG_STATE_SIZE(COLUMNS) / 8 + 1]; /* all the memory of the segmenter */
static scanseg_event events[SCANSEG_MAX_EVENTS(COLUMNS)];

static void print(const scanseg_output *output) {
    for (size_t i = 0; i < output->event_count; i++) {
        scanseg_plane plane;
        if (events[i].kind == SCANSEG_SEGMENT && scanseg_fit_plane(&events[i], &plane) == SCANSEG_OK) {
            printf("%u pixels, %.3f m away, normal %.3f %.3f %.3f\n", (unsigned)events[i].pixels, plane.distance_m,
                   plane.normal[0], plane.normal[1], plane.normal[2]);
        }
    }
}

int main(void) {
    const float degree = 0.01745329f;
    scanseg_config config;
    scanseg_segmenter *segmenter;
    scanseg_output output = SCANSEG_OUTPUT_INIT; /* `labels` may be set too */
    output.events = events;
    output.event_capacity = sizeof events / sizeof *events;

    scanseg_config_init(&config, sizeof config, SCANSEG_ABI_VERSION);
    config.columns = COLUMNS;
    config.beams = SCANSEG_NODDING_Y;
    config.column_start_rad = -45 * degree;
    config.column_step_rad = 0.5f * degree;
    int status = scanseg_init(memory, sizeof memory, &config, &segmenter);

    for (int row = 0; row < ROWS && status >= 0; row++) {
        float turn_rad = (float)(row - 30) * degree, ranges_m[COLUMNS];
        for (int i = 0; i < COLUMNS; i++) { /* metres, from a scanner; here a wall 2 m ahead */
            ranges_m[i] = 2 / (cosf(config.column_start_rad + config.column_step_rad * (float)i) * cosf(turn_rad));
        }
        status = scanseg_push_row(segmenter, ranges_m, COLUMNS, turn_rad, &output);
        print(&output);
    }
    if (status >= 0) status = scanseg_finish(segmenter, &output);
    if (status >= 0) print(&output); /* 10860 pixels, 2.000 m away, normal -1.000 ... */
    if (status < 0) printf("%s\n", scanseg_strerror(status));
    return status < 0;
}
