// The C++ face with exceptions: an error is thrown, a segmenter can be moved, spans come from anything with data and size.
#define CHECK(condition) \
    do { \
        if (!(condition)) { \
            std::printf("%s:%d: %s\n", __FILE__, __LINE__, #condition); \
            failures++; \
        } \
    } while (0)

#include <array>
#include <cstdio>
#include <string_view>
#include <utility>
#include <vector>

#include <scanseg.hpp>

int main() {
    int failures = 0;
    scanseg::Config config;
    int code = 0;
    try {
        scanseg::Segmenter none(config);
    } catch (const scanseg::Error &error) {
        code = error.code;
    }
    CHECK(code == SCANSEG_ERROR_CONFIG && std::string_view(config.bad_field()) == "columns");

    config.columns = 8;
    config.beams = SCANSEG_NODDING_Z;
    config.column_step_rad = 0.02F;
    scanseg::Segmenter first(config);
    const float plain[8] = {2, 2, 2, 2, 2, 2, 2, 2};
    const std::array<float, 8> array = {2, 2, 2, 2, 2, 2, 2, 2};
    std::vector<float> vector(8, 2.0F);
    CHECK(first.push_row(plain, 0.00F));
    CHECK(first.push_row(array, 0.02F));
    CHECK(first.push_row(vector, 0.04F) && first.rows() == 1 && first.first_row() == 2);
    scanseg::Segmenter second(std::move(first));
    CHECK(first.labels().empty() && first.get() == nullptr && second.labels().size() == 8);
    CHECK(second.push_row({vector.data(), vector.size()}, 0.06F));
    code = 0;
    try {
        (void)first.push_row(plain);
    } catch (const scanseg::Error &error) {
        code = error.code;
    }
    CHECK(code == SCANSEG_ERROR_NULL);
    CHECK(second.finish() && second.beam_stretch() == 0 && second.output().scan_rows == 4 && second.events().size() == 1);
    CHECK(second.events()[0].pixels == 32);
    first = std::move(second);
    CHECK(first.reset() && first.finish() && first.output().scan_rows == 0);

    // an image: a wall with a bar in front of it, more segments than there is room for at first, and then room
    std::vector<float> image, turns;
    for (int row = 0; row < 200; row++) {
        turns.push_back(0.02F * static_cast<float>(row % 100) - 1.0F);
        for (int column = 0; column < 8; column++) image.push_back(column == 3 ? 1.0F : 2.0F + 0.4F * static_cast<float>(row % 7));
    }
    CHECK(first.segment_image(image, turns) && first.rows() == 200 && first.labels().size() == 1600);
    const std::size_t found = first.events().size();
    CHECK(found > 1 && first.output().events_lost == 0);
    for (const scanseg_event &event : first.events()) {
        std::size_t pixels = 0;
        for (std::uint32_t label : first.labels()) pixels += label == event.label;
        CHECK(event.kind == SCANSEG_SEGMENT && pixels == event.pixels);
    }
    CHECK(first.segment_image(image, turns).code() == SCANSEG_OK && first.events().size() == found);
    code = 0;
    try {
        (void)first.segment_image(image, plain);
    } catch (const scanseg::Error &error) {
        code = error.code;
    }
    CHECK(code == SCANSEG_ERROR_TURN_ANGLE);
    CHECK(first.reset() && first.push_row(plain) && first.rows() == 1);
    return failures;
}
