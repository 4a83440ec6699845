#pragma once
// A Bluetooth module LMX9820A: packets on its serial line, links over the air, transparent mode.
// Sources: LMX9820A data sheet (SNOSAF5), sections 10 and 12; software user's guides of its siblings (AN-1699
// for the LMX9838) for opcodes, fields, error codes; the e-puck library's bluetooth module for what an
// e-puck's module answers in which order.
//
// Deviations:
// 1. Every request is confirmed a fixed time (`processing`) after its last byte, and a module is ready a
//    fixed time (`boot`) after a reset; the sheets give neither.
// 2. Packets that are wrong, and requests with an opcode in no list, are dropped and counted. Listed opcodes
//    that are not here (service discovery, low power modes, port status, test modes) are confirmed with
//    UNSPECIFIED_ERROR and counted.
// 3. With event filter 2 or 3 confirms are not sent either: the e-puck library waits for none.
// 4. Of an incoming link in automatic mode the host gets the indication 0C only, then the data.
// 5. Transparent mode that ends by a break gives a confirm-like indication 11 (mode 0); one that ends with
//    its link a break on the line, indication 0E, then indication 11.
// 6. The serial line has no handshake: on the e-puck RTS and CTS lead nowhere. What comes from the air waits
//    without limit.
// 7. The version that READY carries, and the data of the requests 12 to 15 (stored connections), are our own.

#include "cosim/core/seconds_form.h"
#include "emu/bluetooth/network.h"
#include "emu/bluetooth/serial_out.h"
#include "emu/bluetooth/settings.h"
#include "protocols/radio/lmx9820_packet.h"

#include <map>
#include <string>

namespace puckloop::bluetooth {

inline constexpr std::uint8_t kOk = 0, kBadCount = 1, kTimeout = 4, kNoConnection = 0x1F;  ///< of a confirm
inline constexpr std::size_t kMostPayload = 330;  ///< of a packet of data, bytes
inline constexpr std::size_t kMostLinks = 3;      ///< active at once, data sheet 1

struct ModuleOptions {
    std::string name = "robot0";
    Settings settings{};
    cosim::Time start = 0;  ///< power on
    cosim::Time boot = 500 * cosim::kMillisecond;
    cosim::Time processing = 2 * cosim::kMillisecond;

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(field("name", &ModuleOptions::name, "whose it is").required(),
                     part(&ModuleOptions::settings), unlisted(&ModuleOptions::start),
                     field("boot_s", &ModuleOptions::boot, "from reset until READY")
                         .in("s")
                         .above(0)
                         .as<cosim::Seconds>(),
                     field("processing_s", &ModuleOptions::processing, "of a request")
                         .in("s")
                         .above(0)
                         .as<cosim::Seconds>());
    }
};
static_assert(lists_all_fields<ModuleOptions>);

struct ModuleCounts {
    std::uint64_t bytes_in = 0, while_down = 0, framing_errors = 0, between_packets = 0;
    std::map<std::string, std::uint64_t> bad_packets{};  ///< by what was wrong
    std::map<std::string, std::uint64_t> requests{};     ///< by name
    std::map<std::string, std::uint64_t> errors{};       ///< confirmed, by name
    std::map<std::string, std::uint64_t> not_modelled{};
    std::uint64_t transparent_in = 0, transparent_out = 0, resets = 0;
};

class Module : public Station {
  public:
    Module(const ModuleOptions& options, Network& network);

    // The serial line.
    void byte_received(std::uint8_t byte, cosim::Time now);
    void break_received(cosim::Time now);
    void framing_error() { ++counts_.framing_errors; }
    SerialOut& serial() { return serial_; }
    const SerialOut& serial() const { return serial_; }
    /// How its receiver is set.
    const SerialSettings& line() const { return line_; }

    const ModuleCounts& counts() const { return counts_; }
    const Settings& settings() const { return settings_; }
    bool transparent() const { return transparent_ != 0; }
    std::size_t links() const { return links_.size(); }

    // Station.
    std::string_view name() const override { return options_.name; }
    Address address() const override { return settings_.address; }
    DeviceClass device_class() const override { return settings_.device_class; }
    std::string friendly_name() const override;
    bool discoverable() const override { return up_ && discoverable_; }
    bool connectable() const override { return up_ && connectable_; }
    std::uint8_t port_state(std::uint8_t port) const override;
    bool authenticates() const override { return settings_.security > 1; }
    std::string pin(const Address&) const override { return settings_.pin; }
    bool has_key(const Address& peer) const override;
    void keep_key(const Address& peer) override;
    cosim::Time link_timeout() const override;
    void found(const Address& address, const DeviceClass& device_class, cosim::Time now) override;
    void inquiry_over(cosim::Time now) override;
    void named(const Address& address, const std::optional<std::string>& name, cosim::Time now) override;
    void linked(const Address& peer, std::uint8_t port, std::uint8_t remote_port, std::uint8_t status,
                LinkId link, cosim::Time now) override;
    void incoming(const Address& peer, std::uint8_t port, LinkId link, cosim::Time now) override;
    void received(LinkId link, const Bytes& bytes, cosim::Time now) override;
    void released(LinkId link, std::uint8_t reason, cosim::Time now) override;
    void happen(const Event& event, cosim::Time now) override;

  private:
    struct Open {
        LinkId link = 0;  ///< 0: being set up
        Address peer{};
        std::uint8_t remote_port = 1;
        bool transparent = false;  ///< to become so
        int attempts = 1;          ///< left
    };

    void wait(cosim::Time at, EventKind kind, Bytes bytes = {});
    void boot(cosim::Time now);
    void restart(cosim::Time now);
    void flush(cosim::Time now);
    void confirm(std::uint8_t opcode, const Bytes& data, cosim::Time now);
    void indicate(std::uint8_t opcode, const Bytes& data, cosim::Time now);
    void dial(const DefaultConnection& stored, cosim::Time now);
    std::uint8_t port_of(LinkId link) const;

    // Requests (module_requests.cpp, module_links.cpp).
    using Answer = void (Module::*)(const Bytes& data, cosim::Time now);
    struct Request {
        std::uint8_t opcode;
        int length;  ///< of its data; -1: looks itself
        Answer answer;
    };
    static const Request* find(std::uint8_t opcode);
    void request(const Bytes& packet, cosim::Time now);
    void status(std::uint8_t error, cosim::Time now) { confirm(asked_, {error}, now); }
    void refuse_port(std::uint8_t error, std::uint8_t port, cosim::Time now) {
        confirm(asked_, {error, port}, now);
    }
    void inquiry(const Bytes& data, cosim::Time now);
    void remote_name(const Bytes& data, cosim::Time now);
    void read_name(const Bytes& data, cosim::Time now);
    void write_name(const Bytes& data, cosim::Time now);
    void read_address(const Bytes& data, cosim::Time now);
    void write_address(const Bytes& data, cosim::Time now);
    void write_class(const Bytes& data, cosim::Time now);
    void scan_mode(const Bytes& data, cosim::Time now);
    void read_pin(const Bytes& data, cosim::Time now);
    void write_pin(const Bytes& data, cosim::Time now);
    void read_security(const Bytes& data, cosim::Time now);
    void write_security(const Bytes& data, cosim::Time now);
    void factory(const Bytes& data, cosim::Time now);
    void remove_pairing(const Bytes& data, cosim::Time now);
    void list_paired(const Bytes& data, cosim::Time now);
    void read_ports(const Bytes& data, cosim::Time now);
    void write_ports(const Bytes& data, cosim::Time now);
    void nvs_speed(const Bytes& data, cosim::Time now);
    void serial_settings(const Bytes& data, cosim::Time now);
    void read_mode(const Bytes& data, cosim::Time now);
    void write_mode(const Bytes& data, cosim::Time now);
    void read_policy(const Bytes& data, cosim::Time now);
    void write_policy(const Bytes& data, cosim::Time now);
    void read_timeout(const Bytes& data, cosim::Time now);
    void write_timeout(const Bytes& data, cosim::Time now);
    void read_filter(const Bytes& data, cosim::Time now);
    void write_filter(const Bytes& data, cosim::Time now);
    void reset(const Bytes& data, cosim::Time now);
    void rssi(const Bytes& data, cosim::Time now);
    void establish(const Bytes& data, cosim::Time now);
    void release(const Bytes& data, cosim::Time now);
    void send_data(const Bytes& data, cosim::Time now);
    void go_transparent(const Bytes& data, cosim::Time now);
    void dial_default(const Bytes& data, cosim::Time now);
    void store_default(const Bytes& data, cosim::Time now);
    void list_defaults(const Bytes& data, cosim::Time now);
    void delete_default(const Bytes& data, cosim::Time now);

    ModuleOptions options_;
    Settings settings_;
    Network& network_;
    std::size_t number_;
    SerialOut serial_;
    SerialSettings line_{};
    protocols::LmxReader reader_;
    bool up_ = false, discoverable_ = true, connectable_ = true, inquiring_ = false;
    std::uint64_t turn_ = 0;              ///< counts resets: events of an earlier turn are void
    std::map<std::uint8_t, Open> links_;  ///< by local port
    std::uint8_t transparent_ = 0;        ///< port, 0: command mode
    Bytes gathered_;                      ///< transparent bytes that are not on the air yet
    std::uint8_t asked_ = 0;              ///< opcode of the request that is being answered
    ModuleCounts counts_;
};

}  // namespace puckloop::bluetooth
