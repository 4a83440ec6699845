#pragma once
// A computer with Bluetooth of its own, which links with one robot's module as `rfcomm connect` does: what
// its program writes goes to the robot once the link stands, and back.
//
// Deviations:
// 1. It is near everybody, does not answer inquiries, and knows the PIN.
// 2. It tries again 2 s after an attempt failed or a link ended, for ever.
// 3. What its program writes before the link stands waits.

#include "cosim/core/seconds_form.h"
#include "emu/bluetooth/network.h"
#include "emu/bluetooth/serial_out.h"

#include <string>

namespace puckloop::bluetooth {

struct ComputerOptions {
    std::string name = "computer";
    Address address{};
    Address robot{};
    std::string pin{};
    cosim::Time connect = 0;
    SerialSettings serial{};  ///< of the line to its program

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(
            field("name", &ComputerOptions::name, "of the port").required(),
            field("address", &ComputerOptions::address, "its own").required().as<AddressForm>(),
            field("robot", &ComputerOptions::robot, "whom it links with").required().as<AddressForm>(),
            field("pin", &ComputerOptions::pin, "the robot's"),
            field("connect_s", &ComputerOptions::connect, "when it begins to link")
                .in("s")
                .at_least(0)
                .as<cosim::Seconds>(),
            unlisted(&ComputerOptions::serial));
    }
};
static_assert(lists_all_fields<ComputerOptions>);

class Computer : public Station {
  public:
    Computer(const ComputerOptions& options, Network& network);

    void byte_received(std::uint8_t byte, cosim::Time now);
    SerialOut& serial() { return serial_; }
    const SerialOut& serial() const { return serial_; }
    const SerialSettings& line() const { return options_.serial; }
    bool linked() const { return link_ != 0; }

    std::string_view name() const override { return options_.name; }
    Address address() const override { return options_.address; }
    DeviceClass device_class() const override { return {0x04, 0x01, 0x10}; }
    std::string friendly_name() const override { return options_.name; }
    bool discoverable() const override { return false; }
    bool connectable() const override { return false; }
    std::uint8_t port_state(std::uint8_t) const override { return kRfcommInvalidPort; }
    bool authenticates() const override { return false; }
    std::string pin(const Address&) const override { return options_.pin; }
    bool has_key(const Address&) const override { return has_key_; }
    void keep_key(const Address&) override { has_key_ = true; }
    cosim::Time link_timeout() const override { return 20 * cosim::kSecond; }
    void found(const Address&, const DeviceClass&, cosim::Time) override {}
    void inquiry_over(cosim::Time) override {}
    void named(const Address&, const std::optional<std::string>&, cosim::Time) override {}
    void linked(const Address& peer, std::uint8_t port, std::uint8_t remote_port, std::uint8_t status,
                LinkId link, cosim::Time now) override;
    void incoming(const Address&, std::uint8_t, LinkId, cosim::Time) override {}
    void received(LinkId link, const Bytes& bytes, cosim::Time now) override;
    void released(LinkId link, std::uint8_t reason, cosim::Time now) override;
    void happen(const Event& event, cosim::Time now) override;

  private:
    void again(cosim::Time at);
    void flush(cosim::Time now);

    ComputerOptions options_;
    Network& network_;
    std::size_t number_;
    SerialOut serial_;
    LinkId link_ = 0;
    bool has_key_ = false, flush_waits_ = false;
    Bytes gathered_;
};

}  // namespace puckloop::bluetooth
