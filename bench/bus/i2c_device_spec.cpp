#include "bench/bus/i2c_device_spec.h"

#include "base/error.h"
#include "base/text/suggest.h"
#include "emu/i2c_devices/ground_sensor.h"
#include "emu/i2c_devices/lsm330.h"
#include "emu/i2c_devices/rgb_turret.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace puckloop::exec {

namespace {

using Kind = I2cDeviceSpec::Kind;

constexpr std::string_view kShape =
    "ground, turret, lsm330 or rab=IMAGE, with @0xADDRESS if it is not the usual one";
constexpr std::uint8_t kLowest = 0x08, kHighest = 0x77;  // the others are reserved by the specification

[[noreturn]] void fail(const std::string& problem, std::string_view expected) {
    throw InputError("", "--i2c-device", problem, expected);
}

std::uint8_t address_in(std::string_view text, std::string_view device) {
    std::uint8_t value = 0;
    const std::string_view digits = text.substr(std::min<std::size_t>(text.size(), 2));
    const char* const last = digits.data() + digits.size();
    const auto [end, error] = std::from_chars(digits.data(), last, value, 16);
    if (!text.starts_with("0x") || error != std::errc{} || end != last || value < kLowest || value > kHighest)
        fail(fmt::format("'{}' has no 7-bit address after @", device), "0x08 to 0x77");
    return value;
}

I2cDeviceSpec parse(const std::string& text) {
    I2cDeviceSpec spec;
    std::string_view name = text;
    // A file's name may hold an @ of its own; an address begins with 0x.
    if (const std::size_t at = name.rfind('@');
        at != name.npos && (name.substr(at + 1).starts_with("0x") || name.find('=') == name.npos)) {
        spec.address = address_in(name.substr(at + 1), text);
        name = name.substr(0, at);
    }
    const std::size_t equals = name.find('=');
    if (equals != name.npos) {
        spec.image = name.substr(equals + 1);
        name = name.substr(0, equals);
    }
    if (name == "ground")
        spec.kind = Kind::Ground;
    else if (name == "turret")
        spec.kind = Kind::Turret;
    else if (name == "lsm330")
        spec.kind = Kind::Lsm330;
    else if (name == "rab")
        spec.kind = Kind::Rab;
    else {
        const std::string near = nearest_name(name, {"ground", "turret", "lsm330", "rab"});
        fail(fmt::format("no device '{}'", text),
             near.empty() ? std::string(kShape) : fmt::format("{}; did you mean {}?", kShape, near));
    }
    if (spec.kind == Kind::Lsm330 && spec.address)
        fail(fmt::format("'{}': the LSM330 has two addresses, 0x1e and 0x6a", text), "lsm330");
    if (spec.kind == Kind::Rab && spec.image.empty())
        fail(fmt::format("'{}' has no firmware", text), "rab=IMAGE, a HEX, ELF or COFF file");
    if (spec.kind != Kind::Rab && equals != std::string_view::npos)
        fail(fmt::format("'{}': {} has no firmware of its own", text, name), kShape);
    return spec;
}

/// The addresses it answers to, as far as they are known before its firmware has run.
std::vector<std::uint8_t> addresses_of(const I2cDeviceSpec& spec) {
    if (spec.address) return {*spec.address};
    switch (spec.kind) {
    case Kind::Ground:
        return {i2c_devices::kGroundSensorAddress};
    case Kind::Turret:
        return {i2c_devices::kRgbTurretAddress};
    case Kind::Lsm330:
        return {i2c_devices::Lsm330::kAccelerometerAddress, i2c_devices::Lsm330::kGyroscopeAddress};
    case Kind::Rab:
        return {};
    }
    return {};
}

}  // namespace

std::vector<I2cDeviceSpec> parse_i2c_devices(const std::vector<std::string>& texts) {
    std::vector<I2cDeviceSpec> devices;
    for (const std::string& text : texts) {
        const I2cDeviceSpec spec = parse(text);
        for (const I2cDeviceSpec& other : devices) {
            if (other.kind == spec.kind)
                fail(fmt::format("'{}' is the second of its kind", text), "one of each, as on a robot");
            const auto taken = addresses_of(other);
            for (const std::uint8_t address : addresses_of(spec))
                if (std::ranges::find(taken, address) != taken.end())
                    fail(fmt::format("'{}' is the second device at 0x{:02x}", text, address),
                         "an address of its own");
        }
        devices.push_back(spec);
    }
    return devices;
}

}  // namespace puckloop::exec
