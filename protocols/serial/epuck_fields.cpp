#include "protocols/serial/epuck_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>

namespace puckloop::protocols {

namespace {

/// `count` numbers of `width` bytes each from byte `first` on.
struct Field {
    const char* name;
    std::size_t first, width, count;
    std::size_t end() const { return first + width * count; }
};

constexpr Field kSession[]{
    {"wake_up", 0, 1, 1}, {"rab_range", 1, 1, 1}, {"rab_enabled", 2, 1, 1}, {"padding", 3, 2, 1}};
constexpr Field kActuators[]{{"left", 0, 2, 1},       {"right", 2, 2, 1},      {"rab_data", 4, 2, 1},
                             {"ring_leds", 6, 1, 1},  {"other_leds", 7, 1, 1}, {"ircom_enabled", 8, 1, 1},
                             {"ircom_data", 9, 1, 1}, {"reset", 10, 1, 1},     {"padding", 11, 1, 1}};
constexpr Field kSensors[]{
    {"rab_data", 0, 2, 1},        {"rab_range", 2, 2, 1},    {"rab_bearing", 4, 4, 1},
    {"proximity", 8, 2, 8},       {"battery_ok", 24, 2, 1},  {"accelerometer", 26, 2, 3},
    {"microphones", 32, 2, 4},    {"light", 40, 2, 8},       {"rab_received", 56, 2, 1},
    {"ircom_received", 58, 2, 1}, {"ircom_data", 60, 1, 1},  {"padding", 61, 1, 1},
    {"ircom_sensor", 62, 2, 1},   {"ircom_range", 64, 4, 1}, {"ircom_bearing", 68, 4, 1}};

std::span<const Field> fields_of(EpuckRecord record) {
    switch (record) {
    case EpuckRecord::Session:
        return kSession;
    case EpuckRecord::Actuators:
        return kActuators;
    case EpuckRecord::Sensors:
        break;
    }
    return kSensors;
}

}  // namespace

std::size_t size_of(EpuckRecord record) {
    return fields_of(record).back().end();
}

const char* name_of(EpuckRecord record) {
    constexpr const char* kNames[]{"session", "actuators", "sensors"};
    return kNames[static_cast<std::size_t>(record)];
}

std::string field_at(EpuckRecord record, std::size_t byte) {
    const auto fields = fields_of(record);
    const auto found =
        std::find_if(fields.begin(), fields.end(), [&](const Field& field) { return byte < field.end(); });
    const std::size_t place = byte - found->first, part = place % found->width;
    std::string text = found->name;
    if (found->count > 1) text += fmt::format("[{}]", place / found->width);
    if (found->width == 2) text += part == 0 ? " low" : " high";
    if (found->width > 2) text += fmt::format(" byte {}", part);
    return text;
}

}  // namespace puckloop::protocols
