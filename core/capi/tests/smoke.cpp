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
    CHECK(second.finish() && second.output().scan_rows == 4 && second.events().size() == 1);
    CHECK(second.events()[0].pixels == 32);
    first = std::move(second);
    CHECK(first.reset() && first.finish() && first.output().scan_rows == 0);
    return failures;
}
