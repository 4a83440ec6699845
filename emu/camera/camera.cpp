#include "emu/camera/camera.h"

#include <algorithm>
#include <cmath>

namespace puckloop::camera {

namespace {

using cosim::I2cPhase;
using cosim::I2cPhaseKind;

constexpr std::uint8_t kBankRegister = 0x03;
constexpr std::uint8_t kFullScale = 255;
constexpr std::uint64_t kSettled = 64;  // frames after which automatic control has come to rest

std::uint64_t fnv1a(const std::vector<std::uint8_t>& bytes) {
    std::uint64_t hash = 0xCBF29CE484222325u;
    for (const std::uint8_t byte : bytes)
        hash = (hash ^ byte) * 0x100000001B3u;
    return hash;
}

std::uint8_t level(double value) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 1.0) * kFullScale));
}

/// ITU-R BT.601, full range.
struct Luma {
    std::uint8_t y, u, v;
};
Luma luma(const std::uint8_t* rgb) {
    const double r = rgb[0], g = rgb[1], b = rgb[2];
    const double y = 0.299 * r + 0.587 * g + 0.114 * b;
    constexpr double kMiddle = 128.0;
    return {level(y / kFullScale), level((kMiddle + 0.564 * (b - y)) / kFullScale),
            level((kMiddle + 0.713 * (r - y)) / kFullScale)};
}

}  // namespace

std::string_view name_of(PixelFormat format) {
    return format == PixelFormat::Rgb565 ? "rgb565" : format == PixelFormat::Yuv ? "yuv" : "grey";
}

Camera::Camera(const Fitting& fitting, Scenery& scenery)
    : model_(fitting.model),
      turned_(fitting.turned),
      scenery_(scenery),
      registers_(defaults_of(model_)),
      mode_(mode_of(model_, registers_)),
      timing_(mode_, 0) {}

void Camera::set_reset(bool high, Cycle now) {
    if (high == running_) return;
    running_ = high;
    selected_ = false;
    registers_ = defaults_of(model_);
    automatic_.reset();
    mode_ = mode_of(model_, registers_);
    restart(now);
}

void Camera::restart(Cycle now) {
    start_ = now;
    timing_ = VideoTiming(mode_, start_);
    taken_frame_.reset();
    edges_moved_ = true;
}

void Camera::set_mode() {
    mode_ = mode_of(model_, registers_);
    timing_ = VideoTiming(mode_, start_);
}

std::uint8_t Camera::bank() const {
    if (model_ == Model::Po3030k || number_ == kBankRegister) return 0;
    return registers_[kBankRegister] % kBanks;
}

void Camera::write(std::uint8_t value, Cycle now) {
    constexpr std::uint8_t kIdentification = 2;  // registers 0 and 1
    if (number_ >= kIdentification) registers_[index(bank(), number_)] = value;
    const VideoMode mode = mode_of(model_, registers_);
    const bool same = mode.same_timing(mode_);
    mode_ = mode;
    if (!same) restart(now);
}

std::optional<I2cPhase> Camera::i2c(const I2cPhase& phase, Cycle now) {
    constexpr std::uint8_t kRead = 1;
    I2cPhase answer = phase;
    answer.kind = I2cPhaseKind::Acknowledge;
    answer.ack = 1;
    switch (phase.kind) {
    case I2cPhaseKind::Start:
        selected_ = running_ && phase.byte >> 1 == kI2cAddress;
        number_next_ = !(phase.byte & kRead);
        break;
    case I2cPhaseKind::Write:
        if (!selected_) break;
        if (number_next_) {
            number_next_ = false;
            number_ = phase.byte;
        } else {
            write(phase.byte, now);
            ++number_;
        }
        break;
    case I2cPhaseKind::Read:
        answer.kind = I2cPhaseKind::Data;
        answer.byte = registers_[index(bank(), number_)];
        if (selected_) ++number_;
        break;
    default:
        selected_ = false;
    }
    if (!selected_) return std::nullopt;
    return answer;
}

std::uint8_t Camera::data(Cycle now) {
    if (!timed(now)) return 0;
    const std::optional<VideoTiming::Place> place = timing_.place(now);
    if (!place) return 0;
    if (taken_frame_ != timing_.frame(now)) take(now);
    return byte_at(*place);
}

std::uint8_t Camera::quiet_data(Cycle now) const {
    if (!timed(now) || taken_frame_ != timing_.frame(now)) return 0;
    const std::optional<VideoTiming::Place> place = timing_.place(now);
    return place ? byte_at(*place) : std::uint8_t{0};
}

void Camera::take(Cycle now) {
    const std::uint64_t frame = timing_.frame(now);
    const std::uint64_t unseen = taken_frame_ ? frame - *taken_frame_ - 1 : frame;
    taken_frame_ = frame;
    Picture& picture = pictures_[++pictures_taken_ % kPictures];
    picture.width = (turned_ ? kArrayHeight : kArrayWidth) / mode_.step;
    picture.height = (turned_ ? kArrayWidth : kArrayHeight) / mode_.step;
    picture.rgb.resize(3u * picture.width * picture.height);
    scenery_.render(picture.width, picture.height, pictures_taken_, picture.rgb);
    const SeenLight light(picture.rgb);
    for (std::uint64_t i = 0; i < std::min(unseen, kSettled); ++i)
        automatic_.frame(light, mode_.automatic, mode_.gain);
    const std::array<double, 3> gain = automatic_.gain(mode_.automatic, mode_.gain);
    expose(picture, gain);
    automatic_.frame(light, mode_.automatic, mode_.gain);
    frames_.push_back({now, *taken_frame_, mode_.format, mode_.step,
                       static_cast<std::int32_t>(mode_.first_column - mode_.array_column),
                       static_cast<std::int32_t>(mode_.first_row - mode_.array_row), fnv1a(picture.rgb),
                       gain[1]});
}

void Camera::expose(Picture& picture, const std::array<double, 3>& gain) const {
    std::array<std::array<std::uint8_t, 256>, 3> curve{};
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t i = 0; i < 256; ++i) {
            const double light = static_cast<double>(i) / kFullScale * gain[c];
            curve[c][i] = level((light - 0.5) * mode_.contrast + 0.5 + mode_.brightness);
        }
    for (std::size_t i = 0; i < picture.rgb.size(); ++i)
        picture.rgb[i] = curve[i % 3][picture.rgb[i]];
}

std::uint8_t Camera::byte_at(const VideoTiming::Place& place) const {
    const Picture& picture = pictures_[pictures_taken_ % kPictures];
    const auto step = static_cast<std::int32_t>(mode_.step);
    if (place.column < 0 || place.row < 0) return 0;
    std::uint32_t x = static_cast<std::uint32_t>(place.column / step);
    std::uint32_t y = static_cast<std::uint32_t>(place.row / step);
    const std::uint32_t columns = turned_ ? picture.height : picture.width;
    const std::uint32_t rows = turned_ ? picture.width : picture.height;
    if (x >= columns || y >= rows) return 0;
    if (mode_.mirror) x = columns - 1 - x;
    if (mode_.flip) y = rows - 1 - y;
    if (turned_) {  // what is on the left of the array is below in the picture
        const std::uint32_t up = x;
        x = y;
        y = columns - 1 - up;
    }
    const std::uint8_t* rgb = &picture.rgb[3u * (y * picture.width + x)];
    switch (mode_.format) {
    case PixelFormat::Rgb565:
        return static_cast<std::uint8_t>(place.byte == 0 ? (rgb[0] & 0xF8) | rgb[1] >> 5
                                                         : (rgb[1] << 3 & 0xE0) | rgb[2] >> 3);
    case PixelFormat::Yuv: {
        const Luma colour = luma(rgb);
        return place.byte == 0 ? colour.y : place.pixel % 2 == 0 ? colour.u : colour.v;
    }
    case PixelFormat::Grey:
        return luma(rgb).y;
    }
    return 0;
}

}  // namespace puckloop::camera
