#pragma once
// What a module keeps in its flash ("NVS").
// Sources: LMX9820A data sheet, section 10, table 26; defaults as the LMX98xx family is delivered.

#include "base/fields/field.h"
#include "base/fields/json_value.h"
#include "emu/bluetooth/network.h"

#include <cstdint>
#include <string>
#include <vector>

namespace puckloop::bluetooth {

inline constexpr std::size_t kMostName = 40, kMostPin = 16, kMostPaired = 8, kMostDefaults = 3;
inline constexpr int kPorts = 30;  ///< RFCOMM ports 1..30

/// The serial line's settings: index of the speed, 0 none 1 odd 2 even, stop bits.
struct SerialSettings {
    std::uint8_t speed = 7;  ///< 115200: what the e-puck's board straps
    std::uint8_t parity = 0;
    std::uint8_t stop_bits = 1;
};
/// Baud of a speed's index, 0 beyond the last (10: 921600).
std::uint32_t baud_of(std::uint8_t speed);

/// A link that is set up after a reset, in automatic mode.
struct DefaultConnection {
    std::uint8_t port = 1;
    Address address{};
    std::uint8_t remote_port = 1;
    bool transparent = false;
};

/// "08:00:17:2C:00:01" in descriptions.
struct AddressForm {
    static JsonValue write(const Address& address);
    static void read(Address& address, const JsonValue& from, const std::string& place);
};

struct Settings {
    std::string name = "Serial port device";
    std::string pin = "0000";
    Address address{};
    DeviceClass device_class{};  ///< e-pucks have 0: nobody has set it
    bool automatic = true;       ///< operation mode
    std::uint8_t security = 2;
    std::uint8_t event_filter = 1;  ///< 0 all events, 1 no ACL links, 2 none, 3 none and no break
    SerialSettings serial{};
    std::uint32_t ports_open = 1;  ///< bit 0: port 1
    std::uint16_t link_policy = 0;
    std::uint16_t link_timeout = 0x7D00;  ///< slots of 0.625 ms: 20 s
    std::vector<Address> paired{};        ///< the first is the oldest
    std::vector<DefaultConnection> defaults{};

    /// What differs from one delivered module to the next.
    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(field("friendly_name", &Settings::name, "that others see"),
                     field("pin", &Settings::pin, "fixed PIN"),
                     field("address", &Settings::address, "six octets").as<AddressForm>(),
                     unlisted(&Settings::device_class),
                     field("automatic", &Settings::automatic, "transparent once somebody has linked with it"),
                     unlisted(&Settings::security), unlisted(&Settings::event_filter),
                     unlisted(&Settings::serial), unlisted(&Settings::ports_open),
                     unlisted(&Settings::link_policy), unlisted(&Settings::link_timeout),
                     unlisted(&Settings::paired), unlisted(&Settings::defaults));
    }
};
static_assert(lists_all_fields<Settings>);

}  // namespace puckloop::bluetooth
