// What a module answers to requests about itself.

#include "emu/bluetooth/module.h"

#include <algorithm>
#include <array>
#include <iterator>

namespace puckloop::bluetooth {

using cosim::Time;

namespace {

// Errors of confirms, as protocols::lmx_error_name() names them.
constexpr std::uint8_t kBadDuration = 0x02, kBadMode = 0x03, kNameTooLong = 0x06, kBadDiscoverable = 0x07,
                       kBadConnectable = 0x08, kBadSecurity = 0x09, kNoKey = 0x0A, kBadSpeed = 0x11,
                       kUnexpected = 0x1C, kUnspecified = 0x27, kBadPolicy = 0x2D, kPinTooLong = 0x2E,
                       kBadParity = 0x2F, kBadStopBits = 0x30;
constexpr Time kInquiryUnit = 1280 * cosim::kMillisecond;
constexpr std::uint8_t kLongestInquiry = 0x30;

Address address_at(const Bytes& data, std::size_t at) {
    Address address{};
    std::copy_n(data.begin() + static_cast<std::ptrdiff_t>(at), address.size(), address.begin());
    return address;
}

/// Text with its length before it, and nothing behind; null octets at its end do not count.
bool read_text(const Bytes& data, std::string& text) {
    if (data.empty() || data.size() != 1 + std::size_t{data[0]}) return false;
    text.assign(data.begin() + 1, data.end());
    while (!text.empty() && text.back() == '\0')
        text.pop_back();
    return true;
}

Bytes words(std::uint8_t status, std::uint32_t value, int octets) {
    Bytes data{status};
    for (int i = 0; i < octets; ++i)
        data.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    return data;
}

}  // namespace

const Module::Request* Module::find(std::uint8_t opcode) {
    static constexpr auto kRequests = std::to_array<Request>({
        {0x00, 3, &Module::inquiry},
        {0x02, 6, &Module::remote_name},
        {0x03, 0, &Module::read_name},
        {0x04, -1, &Module::write_name},
        {0x05, 0, &Module::read_address},
        {0x06, 2, &Module::scan_mode},
        {0x0A, 8, &Module::establish},
        {0x0D, 1, &Module::release},
        {0x0F, -1, &Module::send_data},
        {0x11, 1, &Module::go_transparent},
        {0x12, 1, &Module::dial_default},
        {0x13, 9, &Module::store_default},
        {0x14, 0, &Module::list_defaults},
        {0x15, 1, &Module::delete_default},
        {0x16, 0, &Module::read_pin},
        {0x17, -1, &Module::write_pin},
        {0x18, 0, &Module::read_security},
        {0x19, 1, &Module::write_security},
        {0x1A, 0, &Module::factory},
        {0x1B, 6, &Module::remove_pairing},
        {0x1C, 0, &Module::list_paired},
        {0x1F, 0, &Module::read_ports},
        {0x20, 6, &Module::rssi},
        {0x22, 4, &Module::write_ports},
        {0x23, 1, &Module::nvs_speed},
        {0x26, 0, &Module::reset},
        {0x27, 6, &Module::write_address},
        {0x28, 3, &Module::write_class},
        {0x48, 3, &Module::serial_settings},
        {0x49, 0, &Module::read_mode},
        {0x4A, 1, &Module::write_mode},
        {0x4C, 2, &Module::write_policy},
        {0x4D, 0, &Module::read_policy},
        {0x4E, 1, &Module::write_filter},
        {0x4F, 0, &Module::read_filter},
        {0x55, 2, &Module::write_timeout},
        {0x56, 0, &Module::read_timeout},
    });
    const auto found = std::find_if(kRequests.begin(), kRequests.end(),
                                    [&](const Request& request) { return request.opcode == opcode; });
    return found == kRequests.end() ? nullptr : &*found;
}

void Module::request(const Bytes& packet, Time now) {
    asked_ = packet[0];
    const Bytes data(packet.begin() + 1, packet.end());
    const std::string name = protocols::lmx_opcode_name(asked_);
    const Request* request = find(asked_);
    if (request == nullptr) {
        ++counts_.not_modelled[name];
        if (!name.starts_with("0x")) status(kUnspecified, now);
        return;
    }
    ++counts_.requests[name];
    if (request->length >= 0 && data.size() != static_cast<std::size_t>(request->length))
        return status(kBadCount, now);
    (this->*request->answer)(data, now);
}

void Module::inquiry(const Bytes& data, Time now) {
    if (data[0] < 1 || data[0] > kLongestInquiry) return status(kBadDuration, now);
    if (data[2] > 1) return status(kBadMode, now);
    if (inquiring_) return status(kUnexpected, now);
    inquiring_ = true;
    network_.inquire(number_, data[0] * kInquiryUnit, data[1], now);
}

void Module::remote_name(const Bytes& data, Time now) {
    network_.ask_name(number_, address_at(data, 0), now);
}

void Module::read_name(const Bytes&, Time now) {
    // The e-puck library counts on the null octet.
    Bytes answer{kOk, static_cast<std::uint8_t>(settings_.name.size() + 1)};
    std::copy(settings_.name.begin(), settings_.name.end(), std::back_inserter(answer));
    answer.push_back(0);
    confirm(asked_, answer, now);
}

void Module::write_name(const Bytes& data, Time now) {
    std::string name;
    if (!read_text(data, name)) return status(kBadCount, now);
    if (data[0] > kMostName || name.size() >= kMostName) return status(kNameTooLong, now);
    settings_.name = name;
    status(kOk, now);
}

void Module::read_address(const Bytes&, Time now) {
    Bytes answer{kOk};
    std::copy(settings_.address.begin(), settings_.address.end(), std::back_inserter(answer));
    confirm(asked_, answer, now);
}

void Module::write_address(const Bytes& data, Time now) {
    settings_.address = address_at(data, 0);
    status(kOk, now);
}

void Module::write_class(const Bytes& data, Time now) {
    std::copy_n(data.begin(), settings_.device_class.size(), settings_.device_class.begin());
    status(kOk, now);
}

void Module::scan_mode(const Bytes& data, Time now) {
    if (data[0] > 1) return status(kBadConnectable, now);
    if (data[1] > 2) return status(kBadDiscoverable, now);
    connectable_ = data[0] != 0;
    discoverable_ = data[1] != 0;
    status(kOk, now);
}

void Module::read_pin(const Bytes&, Time now) {
    Bytes answer{kOk, static_cast<std::uint8_t>(settings_.pin.size())};
    std::copy(settings_.pin.begin(), settings_.pin.end(), std::back_inserter(answer));
    confirm(asked_, answer, now);
}

void Module::write_pin(const Bytes& data, Time now) {
    std::string pin;
    if (!read_text(data, pin)) return status(kBadCount, now);
    if (data[0] > kMostPin) return status(kPinTooLong, now);
    settings_.pin = pin;
    status(kOk, now);
}

void Module::read_security(const Bytes&, Time now) {
    confirm(asked_, {kOk, settings_.security}, now);
}

void Module::write_security(const Bytes& data, Time now) {
    if (data[0] < 1 || data[0] > 3) return status(kBadSecurity, now);
    settings_.security = data[0];
    status(kOk, now);
}

void Module::factory(const Bytes&, Time now) {
    const Address address = settings_.address;
    settings_ = {};
    settings_.address = address;
    status(kOk, now);
}

void Module::remove_pairing(const Bytes& data, Time now) {
    const auto found = std::find(settings_.paired.begin(), settings_.paired.end(), address_at(data, 0));
    if (found == settings_.paired.end()) return status(kNoKey, now);
    settings_.paired.erase(found);
    status(kOk, now);
}

void Module::list_paired(const Bytes&, Time now) {
    Bytes answer{kOk, static_cast<std::uint8_t>(settings_.paired.size())};
    for (const Address& address : settings_.paired)
        std::copy(address.begin(), address.end(), std::back_inserter(answer));
    confirm(asked_, answer, now);
}

void Module::read_ports(const Bytes&, Time now) {
    confirm(asked_, words(kOk, settings_.ports_open, 4), now);
}

void Module::write_ports(const Bytes& data, Time now) {
    settings_.ports_open = data[0] | data[1] << 8 | data[2] << 16 | static_cast<std::uint32_t>(data[3]) << 24;
    status(kOk, now);
}

/// From the next reset on.
void Module::nvs_speed(const Bytes& data, Time now) {
    if (baud_of(data[0]) == 0) return status(kBadSpeed, now);
    settings_.serial.speed = data[0];
    status(kOk, now);
}

/// Once the confirm is through.
void Module::serial_settings(const Bytes& data, Time now) {
    if (baud_of(data[0]) == 0) return status(kBadSpeed, now);
    if (data[1] > 2) return status(kBadParity, now);
    if (data[2] < 1 || data[2] > 2) return status(kBadStopBits, now);
    settings_.serial = {data[0], data[1], data[2]};
    status(kOk, now);
    constexpr Time kCharacter = 12;  // bits
    const auto characters = static_cast<Time>(serial_.waiting());
    wait(now + characters * kCharacter * SerialOut::bit_period_of(line_), EventKind::SpeedTaken);
}

void Module::read_mode(const Bytes&, Time now) {
    confirm(asked_, {kOk, static_cast<std::uint8_t>(settings_.automatic ? 1 : 0)}, now);
}

void Module::write_mode(const Bytes& data, Time now) {
    if (data[0] > 1) return status(kBadMode, now);
    settings_.automatic = data[0] == 1;
    status(kOk, now);
}

void Module::read_policy(const Bytes&, Time now) {
    confirm(asked_, words(kOk, settings_.link_policy, 2), now);
}

void Module::write_policy(const Bytes& data, Time now) {
    constexpr std::uint8_t kMostPolicy = 0x0F;  // role switch, hold, sniff, park
    if (data[0] > kMostPolicy || data[1] != 0) return status(kBadPolicy, now);
    settings_.link_policy = data[0];
    status(kOk, now);
}

void Module::read_timeout(const Bytes&, Time now) {
    confirm(asked_, words(kOk, settings_.link_timeout, 2), now);
}

void Module::write_timeout(const Bytes& data, Time now) {
    settings_.link_timeout = static_cast<std::uint16_t>(data[0] | data[1] << 8);
    status(kOk, now);
}

void Module::read_filter(const Bytes&, Time now) {
    confirm(asked_, {kOk, settings_.event_filter}, now);
}

void Module::write_filter(const Bytes& data, Time now) {
    if (data[0] > 3) return status(kBadMode, now);
    settings_.event_filter = data[0];
    status(kOk, now);
}

/// READY is the answer.
void Module::reset(const Bytes&, Time now) {
    restart(now);
}

/// 0: within the receiver's golden range.
void Module::rssi(const Bytes& data, Time now) {
    const Address peer = address_at(data, 0);
    const bool there = std::any_of(links_.begin(), links_.end(), [&](const auto& entry) {
        return entry.second.link != 0 && entry.second.peer == peer;
    });
    confirm(asked_, {there ? kOk : kNoConnection, 0}, now);
}

}  // namespace puckloop::bluetooth
