// scanseg for C++17: owns the memory of a segmenter and of its results. The description of everything is in scanseg.h.
//
//     scanseg::Config config;                     // the defaults
//     config.columns = 640;                       // as in C
//     scanseg::Segmenter segmenter(config);
//     if (!segmenter.status()) { puts(segmenter.status().what()); }
//     for each row: segmenter.push_row(ranges_m); // then labels() and events()
//     segmenter.finish();                         // then reset() for the next scan
//
// A whole image in one call: segmenter.segment_image(ranges_m, turns_rad), then labels() and events().
//
// Calls answer with a status, and nothing is thrown; with SCANSEG_EXCEPTIONS defined before the header is included, errors
// are thrown as scanseg::Error. Memory is taken when a segmenter is made, and for images by segment_image; not by other calls.
#ifndef SCANSEG_HPP
#define SCANSEG_HPP

#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#ifdef SCANSEG_EXCEPTIONS
#include <stdexcept>
#endif

#include "scanseg.h"

namespace scanseg {

/// Elements in a row: from a pointer and a length, or from whatever has data() and size(), as std::vector, std::array,
/// std::span. It does not own them.
template <class T>
class Span {
public:
    constexpr Span() noexcept = default;
    constexpr Span(T *data, std::size_t size) noexcept : data_(data), size_(size) {}
    template <std::size_t N>
    constexpr Span(T (&array)[N]) noexcept : data_(array), size_(N) {}
    template <class C, class = std::enable_if_t<std::is_convertible_v<decltype(std::declval<C &>().data()), T *>>>
    constexpr Span(C &&of) noexcept : data_(of.data()), size_(of.size()) {}

    constexpr T *data() const noexcept { return data_; }
    constexpr std::size_t size() const noexcept { return size_; }
    constexpr bool empty() const noexcept { return size_ == 0; }
    constexpr T *begin() const noexcept { return data_; }
    constexpr T *end() const noexcept { return data_ + size_; }
    constexpr T &operator[](std::size_t i) const noexcept { return data_[i]; }

private:
    T *data_ = nullptr;
    std::size_t size_ = 0;
};

/// What a call answered. True unless it is an error.
class [[nodiscard]] Status {
public:
    constexpr Status(scanseg_status code) noexcept : code_(code) {}
    constexpr scanseg_status code() const noexcept { return code_; }
    constexpr explicit operator bool() const noexcept { return code_ >= 0; }
    const char *what() const noexcept { return scanseg_strerror(code_); }

private:
    scanseg_status code_;
};

#ifdef SCANSEG_EXCEPTIONS
/// An error, where exceptions are wanted.
class Error : public std::runtime_error {
public:
    explicit Error(Status status) : std::runtime_error(status.what()), code(status.code()) {}
    scanseg_status code;
};
#endif

/// A configuration with the defaults.
struct Config : scanseg_config {
    Config() noexcept : scanseg_config() { scanseg_config_init(this, sizeof(scanseg_config), SCANSEG_ABI_VERSION); }
    /// Name of the first field that cannot be used, nullptr if there is none.
    const char *bad_field() const noexcept { return scanseg_bad_field(this); }
};

/// Where the beams of a row point: at a turn, and what else there is to say.
struct RowBeams : scanseg_row_beams {
    explicit RowBeams(float turn_rad = 0) noexcept : scanseg_row_beams() {
        scanseg_row_beams_init(this, sizeof(scanseg_row_beams), turn_rad);
    }
    /// Free beams: x, y and z of each column.
    explicit RowBeams(Span<const float> of) noexcept : RowBeams() { directions = of.data(), direction_count = of.size(); }
};

/// The plane of a segment.
inline Status fit_plane(const scanseg_event &segment, scanseg_plane &plane) noexcept {
    return scanseg_fit_plane(&segment, &plane);
}

/// A segmenter with its memory. Can be moved, not copied. Results stay until the next call.
class Segmenter {
public:
    /// None yet: every call answers with an error.
    Segmenter() noexcept = default;

    /// See status() for whether it could be made.
    explicit Segmenter(const Config &config) { made_ = checked(make(config)); }

    /// How it was made.
    Status status() const noexcept { return made_; }

    /// Takes the next row; see scanseg_push_row.
    Status push_row(Span<const float> ranges_m, float turn_rad = 0) {
        clear();
        return checked(scanseg_push_row(get(), ranges_m.data(), ranges_m.size(), turn_rad, &output_));
    }

    /// The same for a row whose beams lie beside where its turn alone says; see scanseg_push_row_beams.
    Status push_row(Span<const float> ranges_m, const RowBeams &beams) {
        clear();
        return checked(scanseg_push_row_beams(get(), ranges_m.data(), ranges_m.size(), &beams, &output_));
    }

    /// Ends the scan; see scanseg_finish.
    Status finish() {
        clear();
        return checked(scanseg_finish(get(), &output_));
    }

    /// Drops what was pushed; see scanseg_reset.
    Status reset() {
        clear();
        return checked(scanseg_reset(get()));
    }

    /// Segments a whole image, row after row, and applies all joins; see scanseg_segment_image. One turn for each row, or
    /// none for a camera; with free beams three numbers of direction for each pixel. Takes 12 bytes of memory a pixel, and keeps them for the next image. Runs twice where there are
    /// more segments than there was room for.
    Status segment_image(Span<const float> ranges_m, Span<const float> turns_rad = {}, Span<const float> directions = {}) {
        clear();
        return checked(image(ranges_m, turns_rad, directions));
    }

    /// Labels that the last call has given out, rows() of them, row after row.
    Span<const std::uint32_t> labels() const noexcept { return {labels_.get(), rows() * columns_}; }
    /// Number of the first of these rows.
    std::size_t first_row() const noexcept { return output_.first_row; }
    std::size_t rows() const noexcept { return memory_ ? output_.row_count : 0; }
    std::size_t columns() const noexcept { return columns_; }
    /// Joins and segments that the last call has found; of an image its segments. There is room for all.
    Span<const scanseg_event> events() const noexcept { return {events_.get(), memory_ ? output_.event_count : 0}; }
    /// The share by which beam angles are too small, as the scan of the last call tells it.
    float beam_stretch() const noexcept { return output_.beam_stretch; }
    /// All that the last call has given out.
    const scanseg_output &output() const noexcept { return output_; }

    /// For the functions of scanseg.h; nullptr if it could not be made.
    scanseg_segmenter *get() const noexcept { return reinterpret_cast<scanseg_segmenter *>(memory_.get()); }

private:
    scanseg_status make(const Config &config) noexcept {
        std::size_t size = 0;
        scanseg_status status = scanseg_state_size(&config, &size);
        if (status < 0) return status;
        columns_ = config.columns;
        output_.struct_size = sizeof output_;
        output_.label_capacity = SCANSEG_LATENCY_ROWS * columns_;
        output_.event_capacity = SCANSEG_MAX_EVENTS(columns_);
        memory_.reset(new (std::nothrow) std::max_align_t[size / sizeof(std::max_align_t) + 1]);
        labels_.reset(new (std::nothrow) std::uint32_t[output_.label_capacity]);
        events_.reset(new (std::nothrow) scanseg_event[output_.event_capacity]);
        output_.labels = labels_.get();
        output_.events = events_.get();
        status = labels_ && events_ ? SCANSEG_OK : SCANSEG_ERROR_NULL;
        scanseg_segmenter *made = nullptr;
        if (status == SCANSEG_OK) status = scanseg_init(memory_.get(), size, &config, &made);
        if (status < 0) memory_.reset();
        return status;
    }

    scanseg_status image(Span<const float> ranges_m, Span<const float> turns_rad, Span<const float> directions) noexcept {
        if (memory_ == nullptr) return SCANSEG_ERROR_NULL;
        const std::size_t rows = ranges_m.size() / columns_;
        if (ranges_m.size() != rows * columns_) return SCANSEG_ERROR_ROW_LENGTH;
        if (!turns_rad.empty() && turns_rad.size() != rows) return SCANSEG_ERROR_TURN_ANGLE;
        if (!directions.empty() && directions.size() != 3 * ranges_m.size()) return SCANSEG_ERROR_ROW_BEAMS;
        if (!room(labels_, output_.label_capacity, rows * columns_)) return SCANSEG_ERROR_NULL;
        if (!room(work_, work_size_, SCANSEG_IMAGE_WORK(rows, columns_))) return SCANSEG_ERROR_NULL;
        output_.labels = labels_.get();
        for (;;) {
            const scanseg_status status = scanseg_segment_image(get(), ranges_m.data(), rows, columns_, turns_rad.data(),
                                                                directions.data(), work_.get(), work_size_, &output_);
            if (status != SCANSEG_EVENTS_FULL) return status;
            if (!room(events_, output_.event_capacity, output_.event_count + output_.events_lost)) return status;
            output_.events = events_.get();
        }
    }

    /// Makes room for so many elements, unless there is.
    template <class T>
    static bool room(std::unique_ptr<T[]> &array, std::size_t &size, std::size_t needed) noexcept {
        if (size >= needed) return true;
        std::unique_ptr<T[]> larger(new (std::nothrow) T[needed]);
        if (larger == nullptr) return false;
        array = std::move(larger);
        size = needed;
        return true;
    }

    void clear() noexcept { output_.row_count = 0, output_.event_count = 0; }

    static Status checked(Status status) {
#ifdef SCANSEG_EXCEPTIONS
        if (!status) throw Error(status);
#endif
        return status;
    }

    std::unique_ptr<std::max_align_t[]> memory_;
    std::unique_ptr<std::uint32_t[]> labels_;
    std::unique_ptr<scanseg_event[]> events_;
    std::unique_ptr<std::uint32_t[]> work_;
    std::size_t work_size_ = 0;
    std::size_t columns_ = 0;
    scanseg_output output_ = {};
    Status made_ = SCANSEG_ERROR_NULL;
};

static_assert(alignof(std::max_align_t) >= SCANSEG_STATE_ALIGN, "memory from new would not be aligned");

} // namespace scanseg

#endif
