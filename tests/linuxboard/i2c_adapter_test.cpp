// The Linux board as I2C master: phases, failures, time-outs.

#include "linuxboard/shim/devices/i2c_adapter.h"

#include <catch2/catch.hpp>

#include <cerrno>

using namespace puckloop::cosim;
using namespace puckloop::linuxboard;

namespace {
constexpr Time kClock = 10 * kMicrosecond;

I2cTransfer write_then_read() {
    I2cTransfer transfer;
    transfer.timeout = kSecond;
    transfer.messages = {{0x60, false, false, "\x05", 1}, {0x60, true, false, "", 2}};
    return transfer;
}

/// Runs one transfer against a slave that answers `answers`, each nine clocks after its phase; the phases as
/// text: S start, W write, A or N read with or without acknowledge, P stop.
std::string run(I2cAdapter& adapter, std::vector<I2cPhase> answers, I2cResult& result) {
    std::string phases;
    std::size_t next = 0;
    while (adapter.next_event() != kNever) {
        std::vector<I2cPhase> begun;
        adapter.advance(adapter.next_event(), begun);
        for (const I2cPhase& phase : begun) {
            switch (phase.kind) {
            case I2cPhaseKind::Start:
                phases += 'S';
                break;
            case I2cPhaseKind::Write:
                phases += 'W';
                break;
            case I2cPhaseKind::Read:
                phases += phase.ack != 0 ? 'A' : 'N';
                break;
            default:
                phases += 'P';
                continue;
            }
            if (next < answers.size()) adapter.deliver(answers[next++], phase.start + 9 * kClock);
        }
        for (I2cResult& done : adapter.take_results())
            result = done;
    }
    return phases;
}

I2cPhase acknowledge(bool ack) {
    I2cPhase phase;
    phase.kind = I2cPhaseKind::Acknowledge;
    phase.ack = ack ? 1 : 0;
    return phase;
}

I2cPhase data(std::uint8_t byte) {
    I2cPhase phase;
    phase.kind = I2cPhaseKind::Data;
    phase.byte = byte;
    return phase;
}
}  // namespace

TEST_CASE("write, repeated start, read, stop") {
    I2cAdapter adapter(kClock, EREMOTEIO);
    adapter.submit(write_then_read(), 0);
    I2cResult result;
    const std::string phases =
        run(adapter, {acknowledge(true), acknowledge(true), acknowledge(true), data(1), data(2)}, result);
    CHECK(phases == "SWSANP");
    CHECK(result.error == 0);
    CHECK(result.messages == 2);
    CHECK(result.data == "\1\2");
    CHECK(result.time == 5 * 9 * kClock + kClock);
}

TEST_CASE("nobody at the address") {
    I2cAdapter adapter(kClock, ENXIO);
    adapter.submit(write_then_read(), 0);
    I2cResult result;
    CHECK(run(adapter, {acknowledge(false)}, result) == "SP");
    CHECK(result.error == ENXIO);
    CHECK(adapter.failures() == 1);
}

TEST_CASE("a lost bus and a silent bus") {
    I2cAdapter adapter(kClock, EREMOTEIO);
    I2cResult result;
    I2cPhase lost;
    lost.kind = I2cPhaseKind::BusLost;
    adapter.submit(write_then_read(), 0);
    CHECK(run(adapter, {lost}, result) == "S");
    CHECK(result.error == EAGAIN);
    adapter.submit(write_then_read(), kSecond);
    CHECK(run(adapter, {}, result) == "SP");
    CHECK(result.error == ETIMEDOUT);
    CHECK(result.time == 2 * kSecond + kClock);
}

TEST_CASE("transfers of several threads wait for each other") {
    I2cAdapter adapter(kClock, EREMOTEIO);
    adapter.submit(write_then_read(), 0);
    adapter.submit(write_then_read(), 0);
    I2cResult result;
    const std::vector<I2cPhase> once{acknowledge(true), acknowledge(true), acknowledge(true), data(1),
                                     data(2)};
    std::vector<I2cPhase> twice = once;
    twice.insert(twice.end(), once.begin(), once.end());
    CHECK(run(adapter, twice, result) == "SWSANPSWSANP");
    CHECK(adapter.transfers() == 2);
}
