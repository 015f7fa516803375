/* Segments a 16-bit range image of a scanner that nods, in one call, and writes the segment number of each pixel, 1 for the
 * largest. The same numbers as `labels.png` of `scanseg segment`.
 *
 *     segment_pgm SCAN.pgm LABELS.pgm unit_m=0.001 beam_start_deg=-90 beam_step_deg=0.5 turn_start_deg=-48.7
 *                 turn_step_deg=0.516889 range_noise_m=0.01 min_range_m=0.48 no_return=32767 no_return=32765
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <scanseg.h>

enum { MIN_PIXELS = 30, MAX_NO_RETURN = 16 };

typedef struct {
    double unit_m, beam_start_deg, beam_step_deg, turn_start_deg, turn_step_deg;
    double no_return[MAX_NO_RETURN];
    int no_returns;
} geometry;

static void fail(const char *what, const char *why) {
    fprintf(stderr, "%s: %s\n", what, why);
    exit(1);
}

static void *allocate(void *old, size_t bytes) {
    void *memory = realloc(old, bytes);
    if (memory == NULL) fail("memory", "not enough");
    return memory;
}

static int by_size(const void *a, const void *b) {
    const scanseg_event *one = a, *other = b;
    if (one->pixels != other->pixels) return one->pixels < other->pixels ? 1 : -1;
    return one->label < other->label ? -1 : 1;
}

static int header_number(FILE *file) {
    int number, c;
    while ((c = fgetc(file)) == '#' || c == ' ' || c == '\n' || c == '\r' || c == '\t') {
        if (c == '#') {
            while (c != '\n' && c != EOF) c = fgetc(file);
        }
    }
    ungetc(c, file);
    return fscanf(file, "%d", &number) == 1 ? number : -1;
}

static uint16_t *read_pgm(const char *name, int *columns, int *rows) {
    FILE *file = fopen(name, "rb");
    if (file == NULL) fail(name, "cannot be read");
    if (fgetc(file) != 'P' || fgetc(file) != '5') fail(name, "not a binary PGM");
    *columns = header_number(file);
    *rows = header_number(file);
    if (header_number(file) != 65535 || *columns < 1 || *columns > 16384 || *rows < 1 || *rows > 65535) {
        fail(name, "not a PGM of 16 bits");
    }
    fgetc(file);
    size_t pixels = (size_t)*columns * (size_t)*rows;
    uint16_t *counts = allocate(NULL, pixels * sizeof *counts);
    for (size_t i = 0; i < pixels; i++) {
        int high = fgetc(file), low = fgetc(file);
        if (low == EOF) fail(name, "too short");
        counts[i] = (uint16_t)(high << 8 | low);
    }
    fclose(file);
    return counts;
}

static float radians(double deg) {
    return (float)(fmod(deg, 360) * (3.14159265358979323846 / 180));
}

static void setting(const char *argument, geometry *geometry, scanseg_config *config) {
    const char *equals = strchr(argument, '=');
    if (equals == NULL) fail(argument, "not of the form name=value");
    size_t length = (size_t)(equals - argument);
    double value = strtod(equals + 1, NULL);
#define IS(name) (strlen(name) == length && strncmp(argument, name, length) == 0)
    if (IS("unit_m")) geometry->unit_m = value;
    else if (IS("beam_start_deg")) geometry->beam_start_deg = value;
    else if (IS("beam_step_deg")) geometry->beam_step_deg = value;
    else if (IS("turn_start_deg")) geometry->turn_start_deg = value;
    else if (IS("turn_step_deg")) geometry->turn_step_deg = value;
    else if (IS("no_return") && geometry->no_returns < MAX_NO_RETURN) geometry->no_return[geometry->no_returns++] = value;
    else if (IS("approach")) config->approach = (uint32_t)value;
    else if (IS("range_noise_m")) config->range_noise_m = (float)value;
    else if (IS("min_range_m")) config->min_range_m = (float)value;
    else if (IS("max_range_m")) config->max_range_m = (float)value;
    else fail(argument, "no such setting");
#undef IS
}

static float range_m(const geometry *geometry, uint16_t count) {
    for (int i = 0; i < geometry->no_returns; i++) {
        if (count == geometry->no_return[i]) return 0;
    }
    return (float)(count * geometry->unit_m);
}

static void check(int status) {
    if (status < 0) fail("scanseg", scanseg_strerror(status));
}

int main(int argc, char **argv) {
    if (argc < 3) fail("usage", "segment_pgm SCAN.pgm LABELS.pgm [name=value ...]");
    int columns, rows;
    uint16_t *counts = read_pgm(argv[1], &columns, &rows);

    scanseg_config config;
    check(scanseg_config_init(&config, sizeof config, SCANSEG_ABI_VERSION));
    geometry geometry = {0.001, -90, 0.5, 0, 0.5, {0}, 0};
    for (int i = 3; i < argc; i++) setting(argv[i], &geometry, &config);
    config.columns = (uint32_t)columns;
    config.beams = SCANSEG_NODDING_Y;
    config.column_start_rad = radians(geometry.beam_start_deg);
    config.column_step_rad = (float)(geometry.beam_step_deg * (3.14159265358979323846 / 180));

    size_t size;
    int status = scanseg_state_size(&config, &size);
    if (status == SCANSEG_ERROR_CONFIG) fail(scanseg_bad_field(&config), "cannot be used");
    check(status);
    void *memory = allocate(NULL, size);
    scanseg_segmenter *segmenter;
    check(scanseg_init(memory, size, &config, &segmenter));

    size_t width = (size_t)columns, height = (size_t)rows, pixels = width * height;
    float *ranges_m = allocate(NULL, pixels * sizeof *ranges_m);
    for (size_t i = 0; i < pixels; i++) ranges_m[i] = range_m(&geometry, counts[i]);
    float *turns_rad = allocate(NULL, height * sizeof *turns_rad);
    for (size_t row = 0; row < height; row++) {
        turns_rad[row] = radians(geometry.turn_start_deg + (double)row * geometry.turn_step_deg);
    }
    uint32_t *work = allocate(NULL, SCANSEG_IMAGE_WORK(height, width) * sizeof *work);
    uint32_t *labels = allocate(NULL, pixels * sizeof *labels);
    scanseg_output output = SCANSEG_OUTPUT_INIT;
    output.labels = labels;
    output.label_capacity = pixels;
    /* no segment has less than a pixel, so that there is room for all; little of this memory is ever touched */
    output.events = allocate(NULL, pixels * sizeof *output.events);
    output.event_capacity = pixels;
    check(scanseg_segment_image(segmenter, ranges_m, height, width, turns_rad, NULL, work, SCANSEG_IMAGE_WORK(height, width),
                                &output));

    /* the events are the segments; the labels become their places by size */
    uint32_t most = 0;
    size_t found = 0;
    for (size_t i = 0; i < output.event_count; i++) {
        most = output.events[i].label > most ? output.events[i].label : most;
        if (output.events[i].pixels >= MIN_PIXELS) output.events[found++] = output.events[i];
    }
    qsort(output.events, found, sizeof *output.events, by_size);
    uint32_t *numbers = allocate(NULL, ((size_t)most + 1) * sizeof *numbers);
    memset(numbers, 0, ((size_t)most + 1) * sizeof *numbers);
    for (size_t i = 0; i < found; i++) {
        const scanseg_event *segment = &output.events[i];
        scanseg_plane plane;
        numbers[segment->label] = (uint32_t)i + 1;
        if (i < 10 && scanseg_fit_plane(segment, &plane) == SCANSEG_OK) {
            printf("%3zu: %6u pixels, normal %6.3f %6.3f %6.3f, distance %6.3f m, rms %.4f m\n", i + 1, segment->pixels,
                   plane.normal[0], plane.normal[1], plane.normal[2], plane.distance_m, plane.rms_m);
        }
    }
    FILE *file = fopen(argv[2], "wb");
    if (file == NULL) fail(argv[2], "cannot be written");
    fprintf(file, "P5\n%d %d\n65535\n", columns, rows);
    for (size_t i = 0; i < pixels; i++) {
        uint32_t number = labels[i] <= most ? numbers[labels[i]] : 0;
        fputc((int)(number >> 8), file);
        fputc((int)(number & 255), file);
    }
    if (fclose(file) != 0) fail(argv[2], "cannot be written");
    printf("%zu segments of %d pixels or more in %d x %d pixels\n", found, MIN_PIXELS, rows, columns);
    free(numbers);
    free(output.events);
    free(labels);
    free(work);
    free(turns_rad);
    free(ranges_m);
    free(memory);
    free(counts);
    return 0;
}
