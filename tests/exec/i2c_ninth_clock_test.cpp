// A main board whose program leaves out ninth clocks, refuses what a device acknowledges, or transmits and
// receives against what it agreed with the address byte: what its status bits and the bytes that it gets
// show, compared with the two wires, bit by bit (dsPIC30F Family Reference Manual, DS70068, sections 21.5
// to 21.7).

#include "base/random.h"
#include "tests/dspic_pieces.h"
#include "tests/exec/command.h"
#include "tests/wires/wire_slave.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <vector>

using namespace puckloop;
using exec::Outcome;
using exec::text_of;

namespace {

constexpr int kAddress = 0x20, kFirstByte = 0xA5;

/// Sends kFirstByte and the next ones, reads what comes.
const std::string kDevice = R"(
        goto main
        .org 0x200
main:   mov #0x7FF0, w0
        mov w0, SPLIM
        mov #0x6000, w15
        mov #0x20, w0
        mov w0, I2C1ADD
        mov #0x9000, w0
        mov w0, I2C1CON
        mov #0xA5, w11
loop:   btss IFS1, #0
        bra loop
        bclr IFS1, #0
        mov I2C1RCV, w1
        btss I2C1STAT, #2
        bra free
        mov w11, I2C1TRN
        inc w11, w11
free:   bset I2C1CON, #12
        bra loop
)";

struct Act {
    enum class Kind { Start, Restart, Transmit, Receive, Acknowledge, Stop } kind;
    int value = 0;  ///< byte, or ACKDT
};
using Kind = Act::Kind;

/// What the program sends of each activity: ACKSTAT and BCL, then the byte received newest.
struct Shown {
    int status = 0, received = 0;
    bool operator==(const Shown&) const = default;
};
constexpr int kRefused = 0x80, kCollision = 0x04;  // of I2CSTAT's high byte

class DeviceOnWires {
  public:
    void start() {
        mode_ = Mode::Address;
        count_ = 0;
        pulls_ = false;
    }
    void stop() {
        mode_ = Mode::Idle;
        count_ = 0;
        pulls_ = false;
    }
    /// In the clock that comes.
    bool holds_low() const {
        return count_ == 8 ? pulls_ : mode_ == Mode::Send && (byte_ >> (7 - count_) & 1) == 0;
    }
    bool clock(bool sda) {
        const bool line = sda && !holds_low();
        if (count_ < 8) {
            shift_ = (shift_ << 1 | (line ? 1 : 0)) & 0xFF;
            if (++count_ == 8 && mode_ == Mode::Send) loaded_ = false;
            if (count_ == 8)
                pulls_ = mode_ == Mode::Receive || (mode_ == Mode::Address && shift_ >> 1 == kAddress);
            return line;
        }
        count_ = 0;
        const bool sends = mode_ == Mode::Send ? !line : mode_ == Mode::Address && (shift_ & 1) != 0;
        if (mode_ == Mode::Address)
            mode_ = !pulls_ ? Mode::Idle : sends ? Mode::Send : Mode::Receive;
        else if (mode_ == Mode::Send && line)
            mode_ = Mode::Idle;
        if (mode_ == Mode::Send) serve();
        pulls_ = false;
        return line;
    }

  private:
    /// The device's program. I2CTRN takes nothing before what it holds is out.
    void serve() {
        if (!loaded_) byte_ = next_;
        loaded_ = true;
        next_ = (next_ + 1) & 0xFF;
    }

    enum class Mode { Idle, Address, Receive, Send } mode_ = Mode::Idle;
    int count_ = 0, shift_ = 0, byte_ = 0xFF, next_ = kFirstByte;
    bool pulls_ = false, loaded_ = false;
};

/// Up to the first collision.
std::vector<Shown> on_wires(const std::vector<Act>& acts) {
    DeviceOnWires device;
    std::vector<Shown> all;
    Shown now;
    for (const Act& act : acts) {
        bool collides = false;
        switch (act.kind) {
        case Kind::Start:
        case Kind::Restart:
        case Kind::Stop:
            collides = device.holds_low();
            if (!collides) act.kind == Kind::Stop ? device.stop() : device.start();
            break;
        case Kind::Transmit: {
            for (int bit = 7; bit >= 0 && !collides; --bit) {
                const bool one = (act.value >> bit & 1) != 0;
                collides = one && !device.clock(true);
                if (!one) device.clock(false);
            }
            if (!collides) now.status = device.clock(true) ? kRefused : 0;
            break;
        }
        case Kind::Receive:
            now.received = 0;
            for (int bit = 0; bit < 8; ++bit)
                now.received = now.received << 1 | (device.clock(true) ? 1 : 0);
            break;
        case Kind::Acknowledge:
            collides = !device.clock(act.value != 0) && act.value != 0;
            break;
        }
        if (collides) now.status |= kCollision;
        all.push_back(now);
        if (collides) break;
    }
    return all;
}

std::string program(const std::vector<Act>& acts) {
    std::string source = tests::kMain + tests::kUart1 + R"(
        mov #150, w0
        mov w0, I2CBRG
        mov #0x8000, w0
        mov w0, I2CCON
        mov #2000, w0           ; until the other board is ready
ready:  repeat #1000
        nop
        dec w0, w0
        bra nz, ready
)";
    for (const Act& act : acts) {
        switch (act.kind) {
        case Kind::Start:
            source += "        bset I2CCON, #0\n";
            break;
        case Kind::Restart:
            source += "        bset I2CCON, #1\n";
            break;
        case Kind::Stop:
            source += "        bset I2CCON, #2\n";
            break;
        case Kind::Receive:
            source += "        bset I2CCON, #3\n";
            break;
        case Kind::Acknowledge:
            source += fmt::format("        {} I2CCON, #5\n        bset I2CCON, #4\n",
                                  act.value != 0 ? "bset" : "bclr");
            break;
        case Kind::Transmit:
            source += fmt::format("        mov #0x{:x}, w0\n        mov w0, I2CTRN\n", act.value);
            break;
        }
        source += "        call done\n";
    }
    return source + R"(
end:    bra end
put:    btsc U1STA, #9
        bra put
        mov w1, U1TXREG
        return
done:   btss IFS0, #14          ; MI2CIF
        bra done
        bclr IFS0, #14
        mov I2CSTAT, w2
        btst I2CSTAT, #1        ; RBF
        bra z, same
        mov I2CRCV, w5
same:   lsr w2, #8, w1
        call put
        mov w5, w1
        call put
        btst I2CSTAT, #10       ; BCL
        bra nz, end
        return
)";
}

/// Some transfers, each broken at its end.
std::vector<Act> drawn(RandomStream& random) {
    std::vector<Act> acts;
    const auto byte = [&] { return static_cast<int>(random.below(4) == 0 ? 0xFF : random.below(256)); };
    const auto one_in = [&](std::uint64_t n) { return random.below(n) == 0; };
    for (int transfer = 0; transfer < 5; ++transfer) {
        const bool reads = one_in(2);
        const int address = one_in(8) ? kAddress + 2 : kAddress;
        acts.push_back({Kind::Start});
        acts.push_back({Kind::Transmit, address << 1 | (reads ? 1 : 0)});
        for (auto n = random.below(3); n > 0; --n) {
            acts.push_back(reads ? Act{Kind::Receive} : Act{Kind::Transmit, byte()});
            if (reads) acts.push_back({Kind::Acknowledge, 0});
        }
        acts.push_back({Kind::Receive});
        switch (random.below(reads ? 6 : 5)) {
        case 0:
            break;  // the STOP at once
        case 1:
            acts.push_back({Kind::Acknowledge, 1});
            break;
        case 2:  // a slave that sends does not know of an acknowledge before a STOP (deviation 2 of
                 // i2c_slave.h)
            acts.push_back({Kind::Acknowledge, reads ? 1 : 0});
            break;
        case 3:
            acts.push_back({Kind::Transmit, byte()});
            break;
        case 4:
            acts.push_back({Kind::Restart});
            acts.push_back({Kind::Transmit, kAddress << 1 | 1});
            acts.push_back({Kind::Receive});
            acts.push_back({Kind::Acknowledge, 1});
            break;
        default:
            acts.push_back({Kind::Receive});
            break;
        }
        acts.push_back({Kind::Stop});
    }
    return acts;
}

std::vector<Shown> on_bench(const exec::Workbench& bench, const std::vector<Act>& acts) {
    const std::string master = bench.image("master.hex", exec::assembled(program(acts)));
    const std::string device =
        bench.image("device.hex", exec::assembled(kDevice, dspic::dspic33fj256gp710()));
    const Outcome run = bench.run("--board pic " + master + " --i2c-device rab=" + device + " --log " +
                                  bench.folder + "/log --seconds 0.2");
    INFO(run.err);
    CHECK(run.status == 0);
    const std::string csv = text_of(bench.folder + "/log/uart1.csv");
    std::vector<int> bytes;
    for (std::size_t at = 0; (at = csv.find(",tx,", at)) != std::string::npos;)
        bytes.push_back(std::stoi(csv.substr(at += 4, 2), nullptr, 16));
    std::vector<Shown> shown;
    for (std::size_t i = 0; i + 1 < bytes.size(); i += 2)
        shown.push_back({bytes[i] & (kRefused | kCollision), bytes[i + 1]});
    return shown;
}

}  // namespace

TEST_CASE("a main board that breaks its agreement finds on the bus what the wires show, drawn") {
    const auto drawn_seeds = static_cast<std::uint64_t>(wires::seeds(24));
    int collisions = 0, low_first = 0;
    for (std::uint64_t seed = 1; seed <= drawn_seeds; ++seed) {
        RandomStream random(seed, "ninth clock");
        const std::vector<Act> acts = drawn(random);
        const exec::Workbench bench;
        const std::vector<Shown> expected = on_wires(acts), shown = on_bench(bench, acts);
        INFO("seed " << seed);
        CHECK(shown.size() == expected.size());
        for (std::size_t i = 0; i < std::min(shown.size(), expected.size()); ++i) {
            INFO("act " << i << " kind " << static_cast<int>(acts[i].kind) << " value " << acts[i].value);
            CHECK(shown[i].status == expected[i].status);
            if (i > 0 || acts[i].kind == Kind::Receive) CHECK(shown[i].received == expected[i].received);
            low_first += acts[i].kind == Kind::Transmit && i > 0 && acts[i - 1].kind == Kind::Receive &&
                         expected[i].status == 0;
        }
        collisions += !expected.empty() && (expected.back().status & kCollision) != 0;
    }
    CHECK(collisions > 8);
    CHECK(low_first + collisions > 9);
}
