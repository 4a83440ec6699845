#include "protocols/serial/epuck_serial.h"

#include <bit>
#include <cmath>

namespace puckloop::protocols {

namespace {

constexpr int kAdcMaximum = 4095;  // 12 bits

/// Walks a record field by field, low byte first.
class Writer {
  public:
    explicit Writer(std::span<std::uint8_t> bytes) : bytes_(bytes) {}
    void put(std::uint8_t value) { bytes_[at_++] = value; }
    void put(std::uint16_t value) {
        put(static_cast<std::uint8_t>(value & 0xFF));
        put(static_cast<std::uint8_t>(value >> 8));
    }
    void put(std::int16_t value) { put(static_cast<std::uint16_t>(value)); }
    void put(float value) {
        const auto bits = std::bit_cast<std::uint32_t>(value);
        put(static_cast<std::uint16_t>(bits & 0xFFFF));
        put(static_cast<std::uint16_t>(bits >> 16));
    }
    template <typename T, std::size_t N>
    void put(const std::array<T, N>& values) {
        for (const T value : values)
            put(value);
    }

  private:
    std::span<std::uint8_t> bytes_;
    std::size_t at_ = 0;
};

class Reader {
  public:
    explicit Reader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
    void get(std::uint8_t& value) { value = bytes_[at_++]; }
    void get(std::uint16_t& value) {
        value = static_cast<std::uint16_t>(bytes_[at_] | bytes_[at_ + 1] << 8);
        at_ += 2;
    }
    void get(std::int16_t& value) {
        std::uint16_t bits = 0;
        get(bits);
        value = static_cast<std::int16_t>(bits);
    }
    void get(float& value) {
        std::uint16_t low = 0;
        std::uint16_t high = 0;
        get(low);
        get(high);
        value = std::bit_cast<float>(static_cast<std::uint32_t>(high) << 16 | low);
    }
    template <typename T, std::size_t N>
    void get(std::array<T, N>& values) {
        for (T& value : values)
            get(value);
    }

  private:
    std::span<const std::uint8_t> bytes_;
    std::size_t at_ = 0;
};

// One list of fields a record, used both ways, so that the two directions cannot disagree.
template <typename Record, typename Visit>
void fields(Record& r, EpuckConfiguration*, Visit visit) {
    visit(r.rab_range), visit(r.rab_enabled), visit(r.padding);
}

template <typename Record, typename Visit>
void fields(Record& r, EpuckActuators*, Visit visit) {
    visit(r.left), visit(r.right), visit(r.rab_data), visit(r.ring_leds), visit(r.other_leds);
    visit(r.ircom_enabled), visit(r.ircom_data), visit(r.reset), visit(r.padding);
}

template <typename Record, typename Visit>
void fields(Record& r, EpuckSensors*, Visit visit) {
    visit(r.rab_data), visit(r.rab_range), visit(r.rab_bearing), visit(r.proximity), visit(r.battery_ok);
    visit(r.accelerometer), visit(r.microphones), visit(r.light), visit(r.rab_received);
    visit(r.ircom_received), visit(r.ircom_data), visit(r.padding), visit(r.ircom_sensor);
    visit(r.ircom_range), visit(r.ircom_bearing);
}

template <std::size_t N, typename Record>
std::array<std::uint8_t, N> encode_record(const Record& record) {
    std::array<std::uint8_t, N> bytes{};
    Writer writer(bytes);
    fields(record, static_cast<Record*>(nullptr), [&](const auto& field) { writer.put(field); });
    return bytes;
}

template <typename Record>
Record decode_record(std::span<const std::uint8_t> bytes) {
    Record record;
    Reader reader(bytes);
    fields(record, static_cast<Record*>(nullptr), [&](auto& field) { reader.get(field); });
    return record;
}

bool within(const auto& values, int low, int high) {
    for (const int value : values)
        if (value < low || value > high) return false;
    return true;
}

}  // namespace

EpuckConfigurationBytes encode(const EpuckConfiguration& configuration) {
    return encode_record<kEpuckConfigurationBytes>(configuration);
}

EpuckActuatorBytes encode(const EpuckActuators& actuators) {
    return encode_record<kEpuckActuatorBytes>(actuators);
}

EpuckSensorBytes encode(const EpuckSensors& sensors) {
    return encode_record<kEpuckSensorBytes>(sensors);
}

EpuckConfiguration decode_configuration(std::span<const std::uint8_t, kEpuckConfigurationBytes> bytes) {
    return decode_record<EpuckConfiguration>(bytes);
}

EpuckActuators decode_actuators(std::span<const std::uint8_t, kEpuckActuatorBytes> bytes) {
    return decode_record<EpuckActuators>(bytes);
}

EpuckSensors decode_sensors(std::span<const std::uint8_t, kEpuckSensorBytes> bytes) {
    return decode_record<EpuckSensors>(bytes);
}

std::string_view why_implausible(const EpuckSensors& s) {
    if (s.padding != 0) return "padding byte 61 is not 0";
    if (s.battery_ok > 1) return "battery state is neither 0 nor 1";
    if (!within(s.proximity, -kAdcMaximum, kAdcMaximum)) return "a proximity value is outside -4095..4095";
    if (!within(s.light, 0, kAdcMaximum)) return "a light value is outside 0..4095";
    if (!within(s.accelerometer, -kAdcMaximum, kAdcMaximum)) return "an acceleration is outside -4095..4095";
    if (!within(s.microphones, -kAdcMaximum, kAdcMaximum)) return "a microphone is outside -4095..4095";
    if (s.rab_received > 1) return "the range-and-bearing flag is neither 0 nor 1";
    if (s.ircom_received > 1) return "the IRcom flag is neither 0 nor 1";
    if (s.ircom_sensor >= kEpuckRing) return "the IRcom sensor is outside 0..7";
    if (!std::isfinite(s.rab_bearing) || !std::isfinite(s.ircom_range) || !std::isfinite(s.ircom_bearing))
        return "a range or bearing is not a number";
    return {};
}

}  // namespace puckloop::protocols
