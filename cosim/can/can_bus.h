#pragma once
// A CAN bus as a node: a port for each controller. The bus is bit by bit (can_wire.h, can_station.h); what
// crosses links is what a controller wants and what became of it (CanMessage, cosim/core/message.h).
//
// A controller sends Join when its program has it on the bus, with how it cuts time, and Offer when it has a
// frame; the bus sends that as soon as it is idle, again and again until it has gone or the controller sends
// Withdraw. News come when a frame or an error frame is over, with both error counters. Nothing that comes in
// has an answer within 14 bits, those of the shortest error frame behind a start of frame; at 1 Mbit/s, CAN's
// highest rate, that is the bus's lookahead. A controller that is set faster is informed as much later.
//
// Deviations
//  1. Error counters, TXLARB and TXERR are reported when the error frame, or the frame that won, is over; a
//     withdrawal is answered and a sleeping controller woken after 14 us.
//  2. A controller that its program switches off or resets within a frame takes part to the end of it.
//  3. A second reason to delay the next frame within one intermission is not limited to two overload frames.

#include "base/fields/field.h"
#include "base/logs/node_log.h"
#include "cosim/can/can_wire.h"
#include "cosim/core/node.h"

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace puckloop::cosim {

struct CanBusOptions {
    static constexpr std::string_view kKind = "can_bus";

    std::string name = "can";
    std::vector<std::string> controllers;
    std::string log{};
    std::vector<CarriedFault> faults{};

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(
            field("name", &CanBusOptions::name, "of the node").required(),
            field("controllers", &CanBusOptions::controllers, "port names: \"robot0.pic.can1\"").required(),
            field("log", &CanBusOptions::log, "file for the bus's log; empty: none"),
            unlisted(&CanBusOptions::faults));
    }
};
static_assert(lists_all_fields<CanBusOptions>);

class CanBusNode final : public Node {
  public:
    explicit CanBusNode(CanBusOptions options);

    std::string_view name() const override { return options_.name; }
    std::span<const Port> ports() const override { return ports_; }
    void advance(Time until, std::span<const Message> inbox, std::vector<Message>& outbox) override;
    Time earliest_output(PortIndex port) const override;
    Time lookahead(PortIndex port) const override;
    std::string finish() override;

    static constexpr Time kFastestBit = kMicrosecond;
    /// A bit less than that: edges may have moved bits.
    static constexpr Time kLookahead = (CanStation::kErrorBits - 1) * kFastestBit;

  private:
    struct Counters {
        std::uint64_t sent = 0, received = 0, lost = 0, bus_off = 0, dropped = 0;
        std::uint64_t errors_sending = 0, errors_receiving = 0;
        std::array<std::uint64_t, kMostCanError + 1> errors{};  ///< of frames sent, by protocols::CanError
    };
    struct Controller {
        Counters counters;
        CanTiming timing;      ///< as it joined last
        bool joined = false;   ///< ever
        bool watches = false;  ///< wants Wake
        Time last_posted = 0;  ///< no message earlier than this any more
        enum class State : std::uint8_t { Off, Active, Passive, BusOff } state = State::Off;
    };
    void receive(PortIndex port, const CanMessage& message);
    void join(PortIndex port, const CanMessage& message);
    void post(std::size_t index, CanMessage message, Time time);
    void take_news(std::size_t index, const CanNews& news, Time time);
    bool dropped(std::size_t index, const CanNews& news);
    void take_edge(Time now, Time quiet);
    void watch_state(std::size_t index, Time time);
    void write(Time time, const std::string& text) { log_.line(to_seconds(time), text); }
    /// How much later than others a controller is informed that cuts bits shorter than the fastest.
    static Time lag(const CanTiming& timing);
    std::vector<std::string> warnings() const;

    CanBusOptions options_;
    std::vector<Port> ports_;
    CanWire wire_;
    std::vector<Controller> controllers_;
    std::vector<Message> outgoing_;
    NodeLog log_;
    std::uint64_t frames_ = 0, error_frames_ = 0;
    Time now_ = 0;
};

}  // namespace puckloop::cosim
