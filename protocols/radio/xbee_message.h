#pragma once
// What the data of an XBee API frame holds, one struct per frame type; numbers are big-endian.
// Sources: TAM fact sheet, section 6; XBee/XBee-PRO DigiMesh 2.4 manual (90000991), "API frame
// specifications".

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace puckloop::protocols {

using XBeeBytes = std::vector<std::uint8_t>;
using XBeeCommand = std::array<char, 2>;  ///< "NI", "ND", ... two printable characters

inline constexpr std::uint64_t kXBeeBroadcast = 0xFFFF;
inline constexpr std::uint16_t kXBeeUnknownNet = 0xFFFE;  ///< DigiMesh has no 16-bit addresses

// Each struct lists its fields in the order of the frame: `fields(message, visit)` calls visit(name, member).

/// An AT command, host to module; `id` 0 asks for no answer.
template <bool Queued>
struct XBeeAtRequest {
    static constexpr std::uint8_t kType = Queued ? 0x09 : 0x08;
    static constexpr std::string_view kName = Queued ? "queued-at" : "at";
    std::uint8_t id = 1;
    XBeeCommand command{};
    XBeeBytes value;
    static void fields(auto& m, auto&& visit) {
        visit("id", m.id), visit("command", m.command), visit("value", m.value);
    }
    bool operator==(const XBeeAtRequest&) const = default;
};
/// 08: in force at once.
using XBeeAt = XBeeAtRequest<false>;
/// 09: in force only after AC, WR or an 08.
using XBeeQueuedAt = XBeeAtRequest<true>;

/// 10, host to module: send `data` over the air; `id` 0 asks for no XBeeTxStatus.
struct XBeeTx {
    static constexpr std::uint8_t kType = 0x10;
    static constexpr std::string_view kName = "tx";
    std::uint8_t id = 1;
    std::uint64_t to = kXBeeBroadcast;
    std::uint16_t net = kXBeeUnknownNet;
    std::uint8_t radius = 0;   ///< most hops of a broadcast; 0: NH
    std::uint8_t options = 0;  ///< bit 0: no acknowledgement
    XBeeBytes data;
    static void fields(auto& m, auto&& visit) {
        visit("id", m.id), visit("to", m.to), visit("net", m.net), visit("radius", m.radius);
        visit("options", m.options), visit("data", m.data);
    }
    bool operator==(const XBeeTx&) const = default;
};

/// 17, host to module: an AT command for another module.
struct XBeeRemoteAt {
    static constexpr std::uint8_t kType = 0x17;
    static constexpr std::string_view kName = "remote-at";
    std::uint8_t id = 1;
    std::uint64_t to = kXBeeBroadcast;
    std::uint16_t net = kXBeeUnknownNet;
    std::uint8_t options = 0;  ///< bit 1: in force at once
    XBeeCommand command{};
    XBeeBytes value;
    static void fields(auto& m, auto&& visit) {
        visit("id", m.id), visit("to", m.to), visit("net", m.net), visit("options", m.options);
        visit("command", m.command), visit("value", m.value);
    }
    bool operator==(const XBeeRemoteAt&) const = default;
};

/// 88, module to host.
struct XBeeAtResponse {
    static constexpr std::uint8_t kType = 0x88;
    static constexpr std::string_view kName = "at-response";
    std::uint8_t id = 1;
    XBeeCommand command{};
    std::uint8_t status =
        0;  ///< 0 OK, 1 error, 2 no such command, 3 no such parameter; the upper half is flags
    XBeeBytes value;
    static void fields(auto& m, auto&& visit) {
        visit("id", m.id), visit("command", m.command), visit("status", m.status), visit("value", m.value);
    }
    bool operator==(const XBeeAtResponse&) const = default;
};

/// 8A, module to host; status 0 hardware reset, 1 watchdog reset.
struct XBeeModemStatus {
    static constexpr std::uint8_t kType = 0x8A;
    static constexpr std::string_view kName = "modem-status";
    std::uint8_t status = 0;
    static void fields(auto& m, auto&& visit) { visit("status", m.status); }
    bool operator==(const XBeeModemStatus&) const = default;
};

/// 8B, module to host: what became of an XBeeTx.
struct XBeeTxStatus {
    static constexpr std::uint8_t kType = 0x8B;
    static constexpr std::string_view kName = "tx-status";
    std::uint8_t id = 1;
    std::uint16_t net = kXBeeUnknownNet;
    std::uint8_t retries = 0;
    std::uint8_t delivery = 0;   ///< 0 delivered
    std::uint8_t discovery = 0;  ///< 0 none, 2 route discovery
    static void fields(auto& m, auto&& visit) {
        visit("id", m.id), visit("net", m.net), visit("retries", m.retries);
        visit("delivery", m.delivery), visit("discovery", m.discovery);
    }
    bool operator==(const XBeeTxStatus&) const = default;
};

/// 90, module to host: data that came over the air.
struct XBeeRx {
    static constexpr std::uint8_t kType = 0x90;
    static constexpr std::string_view kName = "rx";
    std::uint64_t from = 0;
    std::uint16_t net = kXBeeUnknownNet;
    std::uint8_t options = 0;  ///< bit 0 acknowledged, bit 1 a broadcast
    XBeeBytes data;
    static void fields(auto& m, auto&& visit) {
        visit("from", m.from), visit("net", m.net), visit("options", m.options), visit("data", m.data);
    }
    bool operator==(const XBeeRx&) const = default;
};

/// 97, module to host.
struct XBeeRemoteAtResponse {
    static constexpr std::uint8_t kType = 0x97;
    static constexpr std::string_view kName = "remote-at-response";
    std::uint8_t id = 1;
    std::uint64_t from = 0;
    std::uint16_t net = kXBeeUnknownNet;
    XBeeCommand command{};
    std::uint8_t status = 0;  ///< as XBeeAtResponse; 4: no answer
    XBeeBytes value;
    static void fields(auto& m, auto&& visit) {
        visit("id", m.id), visit("from", m.from), visit("net", m.net), visit("command", m.command);
        visit("status", m.status), visit("value", m.value);
    }
    bool operator==(const XBeeRemoteAtResponse&) const = default;
};

/// Any other type, or data too short for its type.
struct XBeeOther {
    std::uint8_t type = 0;
    XBeeBytes data;  ///< behind the type
    static constexpr std::string_view kName = "other";
    static void fields(auto& m, auto&& visit) { visit("type", m.type), visit("data", m.data); }
    bool operator==(const XBeeOther&) const = default;
};

using XBeeMessage = std::variant<XBeeAt, XBeeQueuedAt, XBeeTx, XBeeRemoteAt, XBeeAtResponse, XBeeModemStatus,
                                 XBeeTxStatus, XBeeRx, XBeeRemoteAtResponse, XBeeOther>;

/// Frame data of a message, type first, and back: exact inverses for all data that is not empty.
XBeeBytes encode(const XBeeMessage& message);
XBeeMessage decode_xbee(std::span<const std::uint8_t> data);

}  // namespace puckloop::protocols
