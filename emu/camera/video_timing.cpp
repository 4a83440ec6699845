#include "emu/camera/video_timing.h"

#include <algorithm>

namespace puckloop::camera {

VideoTiming::VideoTiming(const VideoMode& mode, Cycle start) : mode_(mode), start_(start) {
    const std::uint64_t pixel = mode_.pixel_thirds;
    row_ = mode_.frame_width * pixel;
    frame_ = mode_.frame_height * row_;
    const std::uint64_t out = mode_.out_pixel_thirds != 0 ? mode_.out_pixel_thirds : pixel * mode_.step;
    byte_ = std::max<std::uint64_t>(2, out / mode_.bytes_per_pixel());
    rise_ = std::min(mode_.first_column * pixel, row_);
    fall_ = mode_.end_column * pixel;
    if (mode_.out_pixel_thirds != 0 && mode_.end_column > mode_.first_column)
        fall_ = rise_ + (mode_.end_column - mode_.first_column) / mode_.step * out;
    fall_ = std::clamp(fall_, rise_, row_);
    const auto instant = [&](std::uint64_t row) {
        return std::min(row * row_ + mode_.vsync_column * pixel, frame_);
    };
    vsync_on_ = instant(mode_.vsync_row);
    vsync_off_ = std::max(vsync_on_, instant(mode_.vsync_end_row));
}

bool VideoTiming::row_comes_out(std::uint64_t row) const {
    return row >= mode_.first_row && row < mode_.end_row && row < mode_.frame_height &&
           (row - mode_.first_row) % mode_.step == 0;
}

bool VideoTiming::vsync(Cycle now) const {
    const std::uint64_t at = thirds(now) % frame_;
    return at >= vsync_on_ && at < vsync_off_;
}

bool VideoTiming::href(Cycle now) const {
    const std::uint64_t at = thirds(now) % frame_;
    const std::uint64_t in_row = at % row_;
    return in_row >= rise_ && in_row < fall_ && row_comes_out(at / row_);
}

bool VideoTiming::pclk(Cycle now) const {
    const std::uint64_t in_row = thirds(now) % row_;
    // One whole byte more, so that nothing is negative ahead of HREF.
    return (in_row + byte_ * (rise_ / byte_ + 1) - rise_) % byte_ < byte_ / 2;
}

std::optional<VideoTiming::Place> VideoTiming::place(Cycle now) const {
    if (!href(now)) return std::nullopt;
    const std::uint64_t at = thirds(now) % frame_;
    const std::uint64_t byte = (at % row_ - rise_ + byte_ / 2) / byte_;
    Place place;
    place.pixel = static_cast<std::uint32_t>(byte / mode_.bytes_per_pixel());
    place.byte = static_cast<std::uint32_t>(byte % mode_.bytes_per_pixel());
    place.column = static_cast<std::int32_t>(mode_.first_column + place.pixel * mode_.step) -
                   static_cast<std::int32_t>(mode_.array_column);
    place.row = static_cast<std::int32_t>(at / row_) - static_cast<std::int32_t>(mode_.array_row);
    return place;
}

Cycle VideoTiming::next_vsync(Cycle after) const {
    if (vsync_on_ == vsync_off_) return kNoCycle;
    const std::uint64_t begin = after < start_ ? 0 : thirds(after) / frame_ * frame_;
    for (const std::uint64_t frame : {begin, begin + frame_})
        for (const std::uint64_t edge : {vsync_on_, vsync_off_})
            if (const Cycle at = cycle_of(frame + edge); at > after) return at;
    return cycle_of(begin + 2 * frame_ + vsync_on_);
}

/// The first row from `row` on that comes out, or frame_height.
std::uint64_t VideoTiming::next_row(std::uint64_t row) const {
    std::uint64_t next = std::max<std::uint64_t>(row, mode_.first_row);
    next += (mode_.step - (next - mode_.first_row) % mode_.step) % mode_.step;
    return next < std::min(mode_.end_row, mode_.frame_height) ? next : mode_.frame_height;
}

Cycle VideoTiming::next_href(Cycle after) const {
    if (rise_ == fall_ || next_row(0) == mode_.frame_height) return kNoCycle;
    const std::uint64_t now = after < start_ ? 0 : thirds(after);
    std::uint64_t begin = now / frame_ * frame_;
    std::uint64_t row = now % frame_ / row_;
    for (;;) {
        row = next_row(row);
        if (row == mode_.frame_height) {
            begin += frame_;
            row = 0;
            continue;
        }
        for (const std::uint64_t edge : {rise_, fall_})
            if (const Cycle at = cycle_of(begin + row * row_ + edge); at > after) return at;
        ++row;
    }
}

Cycle VideoTiming::next_byte(Cycle after) const {
    const std::uint64_t now = after < start_ ? 0 : thirds(after);
    const std::uint64_t row = now / row_ * row_;
    const std::uint64_t half = byte_ / 2;
    // Halves of the grid that begins at HREF; it begins anew with each row.
    std::uint64_t at = row + rise_ % half;
    if (now >= at) at += (now - at) / half * half;
    while (cycle_of(at) <= after)
        at += half;
    return std::min(cycle_of(at), std::max(cycle_of(row + row_), after + 1));
}

}  // namespace puckloop::camera
