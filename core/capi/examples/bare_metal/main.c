/* The library on a microcontroller without an operating system or a C library: a Cortex-M4F, as QEMU's mps2-an386 has it.
 * A nodding scanner sees a floor and a wall; each approach segments it, and the program says what was found, and how much of
 * the stack was used. Ends with 0 if every approach finds both.
 *
 *     ../../build.sh lib thumbv7em-none-eabihf
 *     arm-none-eabi-gcc -mcpu=cortex-m4 -mfloat-abi=hard -mfpu=fpv4-sp-d16 -std=c99 -Os -ffreestanding -nostdlib \
 *         -I../../include -T mps2_an386.ld main.c lib/libscanseg.a -o main.elf
 *     qemu-system-arm -M mps2-an386 -nographic -semihosting-config enable=on,target=native -kernel main.elf
 */
#include <scanseg.h>

enum { COLUMNS = 181, ROWS = 60, EVENTS = 32 };
#define STEP_RAD 0.01f
#define PATTERN 0x5A5A5A5Au

extern uint32_t data_start, data_end, data_load, bss_start, bss_end, stack_top;

/* All the memory that there is: known when the program is built. */
static uint64_t memory[(SCANSEG_STATE_SIZE(COLUMNS) + 7) / 8];
static uint32_t labels[SCANSEG_LATENCY_ROWS * COLUMNS];
static scanseg_event events[EVENTS];
static float ranges_m[COLUMNS];

static uint32_t host(uint32_t operation, const void *argument) {
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

static void end(uint32_t code) {
    const uint32_t exit[2] = {0x20026, code};
    host(0x20, exit);
    for (;;) {
    }
}

static void text(const char *s) {
    host(0x04, s);
}

static void number(int32_t n) {
    char digits[12];
    char *at = digits + sizeof digits - 1;
    uint32_t rest = n < 0 ? -(uint32_t)n : (uint32_t)n;
    *at = 0;
    do {
        *--at = (char)('0' + rest % 10);
        rest /= 10;
    } while (rest != 0);
    if (n < 0) *--at = '-';
    text(at);
}

/* Enough for angles below 1 rad. */
static float cosine(float x) {
    float s = x * x;
    return 1 - s / 2 * (1 - s / 12 * (1 - s / 30 * (1 - s / 56)));
}

static float sine(float x) {
    float s = x * x;
    return x * (1 - s / 6 * (1 - s / 20 * (1 - s / 42 * (1 - s / 72))));
}

/* Floor at z = -0.5 m, wall at x = 2 m; the scanner tilts down. */
static float range_m(int row, int column) {
    float b = STEP_RAD * (float)(column - COLUMNS / 2), t = -STEP_RAD * (float)row;
    float x = cosine(b) * cosine(t), z = cosine(b) * sine(t);
    float wall = 2 / x, floor = z < -0.01f ? -0.5f / z : 1000;
    return wall < floor ? wall : floor;
}

static uint32_t stack_used(void) {
    const volatile uint32_t *at = &bss_end;
    while (at < &stack_top && *at == PATTERN) at++;
    return (uint32_t)((uintptr_t)&stack_top - (uintptr_t)at);
}

static int segment(uint32_t approach) {
    scanseg_config config;
    scanseg_segmenter *segmenter;
    scanseg_output output = SCANSEG_OUTPUT_INIT;
    size_t size;
    int large = 0;
    scanseg_config_init(&config, sizeof config, SCANSEG_ABI_VERSION);
    config.approach = approach;
    config.columns = COLUMNS;
    config.beams = SCANSEG_NODDING_Y;
    config.column_start_rad = -STEP_RAD * (COLUMNS / 2);
    config.column_step_rad = STEP_RAD;
    if (scanseg_init(memory, sizeof memory, &config, &segmenter) < 0) return 0;
    scanseg_state_size(&config, &size);
    output.labels = labels;
    output.label_capacity = sizeof labels / sizeof *labels;
    output.events = events;
    output.event_capacity = EVENTS;
    for (int row = 0; row <= ROWS; row++) {
        for (int column = 0; column < COLUMNS; column++) ranges_m[column] = range_m(row, column);
        int32_t status = row < ROWS ? scanseg_push_row(segmenter, ranges_m, COLUMNS, -STEP_RAD * (float)row, &output)
                                    : scanseg_finish(segmenter, &output);
        if (status < 0) {
            text(scanseg_strerror(status));
            return 0;
        }
        for (size_t i = 0; i < output.event_count; i++) {
            scanseg_plane plane;
            if (events[i].kind != SCANSEG_SEGMENT || events[i].pixels < 500) continue;
            if (scanseg_fit_plane(&events[i], &plane) != SCANSEG_OK) continue;
            int is_wall = plane.normal[0] < -0.999f && plane.distance_m > 1.99f && plane.distance_m < 2.01f;
            int is_floor = plane.normal[2] > 0.999f && plane.distance_m > 0.49f && plane.distance_m < 0.51f;
            large += is_wall ? 1 : is_floor ? 10 : 100;
            text(is_wall ? "wall, " : is_floor ? "floor, " : "neither, ");
            number((int32_t)events[i].pixels);
            text(" pixels, mm: ");
            number((int32_t)(plane.distance_m * 1000 + 0.5f));
            text("\n");
        }
    }
    text("approach ");
    number((int32_t)approach);
    text(", bytes of state: ");
    number((int32_t)size);
    text(" of ");
    number((int32_t)sizeof memory);
    text(", of stack so far: ");
    number((int32_t)stack_used());
    text("\n");
    return large == 11;
}

void reset(void) {
    volatile uint32_t *to = &data_start;
    const uint32_t *from = &data_load;
    while (to < &data_end) *to++ = *from++;
    for (to = &bss_start; to < &bss_end; to++) *to = 0;
    *(volatile uint32_t *)0xE000ED88 |= 0xF00000; /* floating point on */
    __asm__ volatile("dsb\nisb" ::: "memory");
    /* what is below this frame is the stack to come */
    uint32_t here;
    const uintptr_t below = (uintptr_t)&here - 256;
    for (to = &bss_end; (uintptr_t)to < below; to++) *to = PATTERN;
    int good = 1;
    for (uint32_t approach = SCANSEG_PLANE; approach <= SCANSEG_REGION; approach++) good &= segment(approach);
    end(good ? 0 : 1);
}

static void fault(void) {
    text("fault\n");
    end(2);
}

__attribute__((section(".vectors"), used)) static const struct {
    void *stack;
    void (*handlers[6])(void);
} vectors = {&stack_top, {reset, fault, fault, fault, fault, fault}};
