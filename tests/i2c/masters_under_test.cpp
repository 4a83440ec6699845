#include "tests/i2c/masters_under_test.h"

#include "cosim/conductor.h"
#include "cosim/i2c/i2c_bus.h"
#include "emu/dspic/devices/device.h"
#include "emu/pic/pic_node.h"
#include "linuxboard/shim/devices/i2c_adapter.h"
#include "tests/avr/rig.h"
#include "tests/kit/node_under_test.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cerrno>

namespace puckloop::tests {

using cosim::I2cPhase;
using cosim::Message;
using cosim::Node;
using cosim::PortIndex;
using cosim::Time;

namespace {

constexpr double kBusHertz = 100e3;
constexpr std::uint16_t kUnitsDone = 0x0900, kStatusLost = 0x0902;  // of the dsPIC's program
constexpr int kLogAt = 0x200;                                       // of the AVR's
constexpr std::uint8_t kArbitrationLost = 0x38;

class SharedDevice final : public cosim::I2cSlave {
  public:
    explicit SharedDevice(std::vector<std::uint8_t>& written) : written_(written) {}
    std::string_view name() const override { return "shared"; }
    bool listens_to(std::uint8_t address) const override { return address == kSharedDevice; }
    cosim::I2cAnswer start(bool, Time) override { return {true, 0xFF, 0}; }
    cosim::I2cAnswer write(std::uint8_t byte, Time) override {
        written_.push_back(byte);
        return {true, 0xFF, 0};
    }
    cosim::I2cAnswer read(Time) override { return {false, next_++, 0}; }

  private:
    std::vector<std::uint8_t>& written_;
    std::uint8_t next_ = 0x11;
};

// ---- programs

std::string dspic_transfer(const MasterUnderTest& master) {
    const auto loops = static_cast<long>(master.delay / 203'451);  // three cycles at 14.7456 MHz
    std::string text = fmt::format(R"(
        .org 0x200
main:   mov #0x1000, w15
        mov #0x27f0, w0
        mov w0, SPLIM
        clr 0x0900
        clr 0x0902
        mov #150, w0
        mov w0, I2CBRG
        mov #0x9000, w0
        mov w0, I2CCON
        mov #{}, w3
pause:  dec w3, w3
        bra nz, pause
)",
                                   loops + 1);
    int label = 0;
    const auto request = [&](const char* reg, int bit, const std::string& before) {
        text += fmt::format("{0}\nwait{1}: btsc {2}, #{3}\n        bra wait{1}\n        btsc I2CSTAT, #10\n"
                            "        bra lost\n",
                            before, label++, reg, bit);
    };
    const auto control = [&](int bit) {
        request("I2CCON", bit, fmt::format("        bset I2CCON, #{}", bit));
    };
    const auto done = [&] { text += "        inc 0x0900\n"; };
    bool first = true;
    for (const TransferPart& part : master.transfer) {
        control(first ? 0 : 1);
        first = false;
        const auto put = [&](int byte) {
            request("I2CSTAT", 14, fmt::format("        mov #{}, w4\n        mov w4, I2CTRN", byte));
            done();
        };
        put(kSharedDevice << 1 | (part.read ? 1 : 0));
        if (master.halts) text += "        bra over\n";
        for (std::size_t i = 0; i < part.bytes.size(); ++i) {
            if (!part.read) {
                put(part.bytes[i]);
                continue;
            }
            control(3);
            text += "        mov I2CRCV, w5\n";
            text += i + 1 < part.bytes.size() ? "        bclr I2CCON, #5\n" : "        bset I2CCON, #5\n";
            control(4);
            done();
        }
    }
    control(2);
    done();
    return text + "over:   bra over\nlost:   mov I2CSTAT, w0\n        mov w0, 0x0902\n        bra over\n";
}

std::string avr_transfer(const MasterUnderTest& master) {
    const auto loops = std::max<Time>(1, master.delay / (250 * cosim::kNanosecond));  // four cycles at 16 MHz
    std::string text = fmt::format(R"(
        ldi r26, 0x00
        ldi r27, 0x02
        ldi r16, 80
        sts TWBR, r16
        ldi r24, {}
        ldi r25, {}
pause:  sbiw r24, 1
        brne pause
)",
                                   loops & 0xFF, loops >> 8 & 0xFF);
    int label = 0;
    const auto act = [&](int control) {
        text += fmt::format(R"(        ldi r16, {0}
        sts TWCR, r16
wait{1}: lds r17, TWCR
        {2}
        rjmp wait{1}
        lds r17, TWSR
        st X+, r17
        cpi r17, 0x38
        brne next{1}
        rjmp over
next{1}:
)",
                            control, label, (control & 0x10) != 0 ? "sbrc r17, 4" : "sbrs r17, 7");
        ++label;
    };
    const auto put = [&](int byte) {
        text += fmt::format("        ldi r18, {}\n        sts TWDR, r18\n", byte);
        act(0x84);
    };
    for (const TransferPart& part : master.transfer) {
        act(0xA4);
        put(kSharedDevice << 1 | (part.read ? 1 : 0));
        for (std::size_t i = 0; i < part.bytes.size(); ++i) {
            if (part.read)
                act(i + 1 < part.bytes.size() ? 0xC4 : 0x84);
            else
                put(part.bytes[i]);
        }
    }
    act(0x94);
    return text + "over:   rjmp over\n";
}

// ---- nodes

/// Records a master's port.
class TappedMaster final : public Node {
  public:
    TappedMaster(std::unique_ptr<Node> inner, PortIndex port, MasterUnderTest& master)
        : inner_(std::move(inner)), port_(port), master_(master) {}
    std::string_view name() const override { return inner_->name(); }
    std::span<const cosim::Port> ports() const override { return inner_->ports(); }
    void advance(Time until, std::span<const Message> inbox, std::vector<Message>& outbox) override {
        const std::size_t before = outbox.size();
        for (const Message& message : inbox)
            if (message.port == port_)
                master_.answered.push_back({message.time, std::get<I2cPhase>(message.payload)});
        inner_->advance(until, inbox, outbox);
        for (std::size_t i = before; i < outbox.size(); ++i)
            if (outbox[i].port == port_)
                master_.sent.push_back({outbox[i].time, std::get<I2cPhase>(outbox[i].payload)});
    }
    Time earliest_output(PortIndex port) const override { return inner_->earliest_output(port); }
    Time lookahead(PortIndex port) const override { return inner_->lookahead(port); }
    std::string finish() override { return inner_->finish(); }

  private:
    std::unique_ptr<Node> inner_;
    PortIndex port_;
    MasterUnderTest& master_;
};

class DspicMaster final : public pic::PicNode {
  public:
    DspicMaster(const pic::PicNodeOptions& options, MasterUnderTest& master)
        : PicNode(assembled(dspic::dspic30f6014a(), dspic_transfer(master)), options), master_(master) {}
    std::string finish() override {
        master_.units_done = chip().peek_data(kUnitsDone);
        master_.lost = (chip().peek_data(kStatusLost) & 0x0400) != 0;
        return PicNode::finish();
    }

  private:
    MasterUnderTest& master_;
};

class AvrMaster final : public Node {
  public:
    AvrMaster(std::string name, MasterUnderTest& master)
        : name_(std::move(name)), rig_(avr_transfer(master)), master_(master) {}
    std::string_view name() const override { return name_; }
    std::span<const cosim::Port> ports() const override { return ports_; }
    void advance(Time until, std::span<const Message> inbox, std::vector<Message>& outbox) override {
        for (const Message& message : inbox) {
            run(message.time, outbox);
            rig_.chip.twi_answer(std::get<I2cPhase>(message.payload));
            hand_out(outbox);
        }
        run(until, outbox);
        granted_ = until;
    }
    Time earliest_output(PortIndex) const override { return granted_; }
    Time lookahead(PortIndex) const override { return 0; }
    std::string finish() override {
        for (int at = kLogAt; rig_.ram(static_cast<std::uint16_t>(at)) != 0; ++at)
            master_.statuses.push_back(rig_.ram(static_cast<std::uint16_t>(at)));
        for (const std::uint8_t status : master_.statuses) {
            master_.lost = master_.lost || status == kArbitrationLost;
            master_.units_done += status != 0x08 && status != 0x10 && status != kArbitrationLost;
        }
        return "{}";
    }

  private:
    void run(Time until, std::vector<Message>& outbox) {
        rig_.chip.run_until(until);
        hand_out(outbox);
    }
    void hand_out(std::vector<Message>& outbox) {
        for (const I2cPhase& phase : std::exchange(rig_.phases, {}))
            outbox.push_back({phase.start, 0, phase});
    }

    std::string name_;
    avr::test::Rig rig_;
    MasterUnderTest& master_;
    std::vector<cosim::Port> ports_{{"i2c", cosim::PortKind::I2c}};
    Time granted_ = 0;
};

class LinuxMaster final : public Node {
  public:
    LinuxMaster(std::string name, MasterUnderTest& master)
        : name_(std::move(name)),
          adapter_(static_cast<Time>(1e12 / kBusHertz), EREMOTEIO),
          master_(master),
          begins_(master.delay) {}
    std::string_view name() const override { return name_; }
    std::span<const cosim::Port> ports() const override { return ports_; }
    void advance(Time until, std::span<const Message> inbox, std::vector<Message>& outbox) override {
        for (const Message& message : inbox) {
            run_until(message.time, outbox);
            adapter_.deliver(std::get<I2cPhase>(message.payload), message.time);
        }
        run_until(until, outbox);
        granted_ = until;
    }
    Time earliest_output(PortIndex) const override { return std::max(granted_, next()); }
    Time lookahead(PortIndex) const override { return 0; }

  private:
    Time next() const { return std::min(adapter_.next_event(), begins_); }
    void run_until(Time until, std::vector<Message>& outbox) {
        for (Time now = next(); now < until; now = next()) {
            if (begins_ <= now) submit(now);
            std::vector<I2cPhase> begun;
            adapter_.advance(now, begun);
            for (const I2cPhase& phase : begun)
                outbox.push_back({phase.start, 0, phase});
            for (const linuxboard::I2cResult& result : adapter_.take_results()) {
                master_.error = result.error;
                master_.lost = result.error == EAGAIN;
                master_.read = result.data;
            }
        }
    }
    void submit(Time now) {
        begins_ = cosim::kNever;
        linuxboard::I2cTransfer transfer;
        transfer.timeout = master_.timeout;
        for (const TransferPart& part : master_.transfer) {
            linuxboard::I2cMessage message;
            message.address = kSharedDevice;
            message.read = part.read;
            if (part.read)
                message.length = static_cast<std::uint16_t>(part.bytes.size());
            else
                message.data.assign(part.bytes.begin(), part.bytes.end());
            transfer.messages.push_back(message);
        }
        adapter_.submit(transfer, now);
    }

    std::string name_;
    linuxboard::I2cAdapter adapter_;
    MasterUnderTest& master_;
    Time begins_;
    std::vector<cosim::Port> ports_{{"i2c", cosim::PortKind::I2c}};
    Time granted_ = 0;
};

std::unique_ptr<Node> master_node(const std::string& name, MasterUnderTest& master) {
    if (master.kind == MasterKind::Avr)
        return std::make_unique<TappedMaster>(std::make_unique<AvrMaster>(name, master), PortIndex{0},
                                              master);
    if (master.kind == MasterKind::Linux)
        return std::make_unique<TappedMaster>(std::make_unique<LinuxMaster>(name, master), PortIndex{0},
                                              master);
    pic::PicNodeOptions options;
    options.board.name = name;
    options.fastest_i2c_hertz = kBusHertz;
    auto node = std::make_unique<DspicMaster>(options, master);
    PortIndex port = 0;
    while (node->ports()[port].name != "i2c")
        ++port;
    return std::make_unique<TappedMaster>(std::move(node), port, master);
}

}  // namespace

std::vector<BusUnit> units_of(const Transfer& transfer) {
    std::vector<BusUnit> units;
    for (const TransferPart& part : transfer) {
        units.push_back({BusUnit::Kind::Address,
                         static_cast<std::uint8_t>(kSharedDevice << 1 | (part.read ? 1 : 0)), false});
        for (std::size_t i = 0; i < part.bytes.size(); ++i) {
            if (part.read)
                units.push_back({BusUnit::Kind::Read, 0, i + 1 < part.bytes.size()});
            else
                units.push_back({BusUnit::Kind::Write, part.bytes[i], false});
        }
    }
    units.push_back({});
    return units;
}

MastersRun run_masters(std::vector<MasterUnderTest>& masters, std::uint64_t chop) {
    MastersRun run;
    std::vector<cosim::NodeSpec> nodes{{"bus", "bus", {}}};
    std::vector<cosim::LinkSpec> links;
    std::vector<cosim::I2cMasterPort> ports;
    for (std::size_t m = 0; m < masters.size(); ++m) {
        MasterUnderTest& master = masters[m];
        master.sent.clear();
        master.answered.clear();
        master.statuses.clear();
        master.units_done = 0;
        master.lost = false;
        master.error = 0;
        const std::string name = fmt::format("m{}", m);
        nodes.push_back({name, name, {}});
        links.push_back({"i2c." + name, {name, "i2c"}, {"bus", name}});
        ports.push_back({name, master.kind != MasterKind::Dspic});
    }
    const cosim::NodeFactory factory = [&](const std::string& name) -> std::unique_ptr<Node> {
        if (name != "bus") return master_node(name, masters[static_cast<std::size_t>(name.back() - '0')]);
        cosim::I2cBusOptions options;
        options.nominal_hertz = kBusHertz;
        options.masters = ports;
        options.name = "bus";
        std::vector<std::unique_ptr<cosim::I2cSlave>> slaves;
        slaves.push_back(std::make_unique<SharedDevice>(run.written));
        return std::make_unique<cosim::I2cBusNode>(std::move(options), std::move(slaves));
    };
    cosim::RunOptions options;
    options.duration = 8 * cosim::kMillisecond;
    options.in_process = true;
    if (chop != 0) options.chop_seed = chop;
    cosim::Conductor conductor(nodes, links, {}, options, factory);
    const cosim::Outcome outcome = conductor.run();
    INFO(outcome.text);
    REQUIRE(outcome.success);
    run.sha = outcome.trace_sha256;
    run.report = outcome.nodes[0].json;
    return run;
}

}  // namespace puckloop::tests
