// The serial port's pacing and formats.

#include "linuxboard/shim/devices/tty_port.h"

#include <catch2/catch.hpp>

using namespace puckloop::cosim;
using namespace puckloop::linuxboard;

namespace {
termios raw(speed_t speed, tcflag_t more = 0) {
    termios settings = initial_termios();
    cfmakeraw(&settings);
    cfsetspeed(&settings, speed);
    settings.c_cflag |= more;
    return settings;
}
}  // namespace

TEST_CASE("bytes leave back to back from the moment they are written") {
    TtyPort port;
    port.open();
    port.configure(raw(B115200));
    CHECK(port.write("abc", kMillisecond) == 3);
    std::vector<UartFrame> sent;
    port.advance(kMillisecond, sent);
    REQUIRE(sent.size() == 1);
    CHECK(sent[0].start == kMillisecond);
    CHECK(port.output_queue(kMillisecond) == 3);
    port.advance(2 * kMillisecond, sent);
    REQUIRE(sent.size() == 3);
    CHECK(sent[1].start == kMillisecond + 10 * Time{8'680'556});
    CHECK(sent[2].start == kMillisecond + 20 * Time{8'680'556});
    CHECK(port.drain_time() == kMillisecond + 30 * Time{8'680'556});
}

TEST_CASE("format follows termios") {
    TtyPort port;
    port.open();
    port.configure(raw(B9600, PARENB | PARODD | CSTOPB));
    port.write("\x07", 0);
    std::vector<UartFrame> sent;
    port.advance(0, sent);
    REQUIRE(sent.size() == 1);
    CHECK(sent[0].bit_period == 104'166'667);
    CHECK(sent[0].parity == 1);
    CHECK(sent[0].parity_bit == 0);  // three ones are odd already
    CHECK(sent[0].stop_bits == 2);
    CHECK(port.drain_time() == 12 * Time{104'166'667});
}

TEST_CASE("the driver takes 4095 bytes, the queue can be flushed but for the byte on the line") {
    TtyPort port;
    port.open();
    port.configure(raw(B115200));
    CHECK(port.write(std::string(5000, 'x'), 0) == TtyPort::kOutputSize);
    std::vector<UartFrame> sent;
    port.advance(0, sent);
    CHECK(port.output_room() == 1);
    port.flush_output();
    port.advance(kSecond, sent);
    CHECK(sent.size() == 1);
}

TEST_CASE("a port nobody has open hears nothing and still sends what was written") {
    TtyPort port;
    UartFrame frame;
    frame.bit_period = 8'680'556;
    frame.data = 'x';
    port.deliver(frame, 9 * frame.bit_period);
    port.open();
    port.configure(raw(B115200));
    port.write("ab", 0);
    std::vector<UartFrame> sent;
    port.advance(kMillisecond, sent);
    CHECK(port.readable() == 0);
    CHECK(sent.size() == 2);
    port.write("c", kMillisecond);
    port.close();
    port.advance(2 * kMillisecond, sent);
    CHECK(sent.size() == 3);
}

TEST_CASE("a frame of another rate arrives as the garbage it is") {
    TtyPort port(0.0, 1);
    port.open();
    port.configure(raw(B57600));
    UartFrame frame;
    frame.bit_period = 8'680'556;
    frame.data = 0x55;
    port.deliver(frame, 9 * frame.bit_period);
    std::vector<UartFrame> sent;
    port.advance(kSecond, sent);
    // Every second boundary of the sender's bits, then the idle line: 0xFF at best, never 0x55.
    CHECK(port.readable() == 1);
    CHECK(port.read(1) != "\x55");
}

TEST_CASE("XOFF holds output until XON") {
    TtyPort port(0.0, 1);
    port.open();
    termios settings = raw(B115200);
    settings.c_iflag |= IXON;
    port.configure(settings);
    UartFrame frame;
    frame.bit_period = 8'680'556;
    frame.data = 'S' - '@';
    port.deliver(frame, 9 * frame.bit_period);
    std::vector<UartFrame> sent;
    port.advance(kMillisecond, sent);
    port.write("x", kMillisecond);
    port.advance(2 * kMillisecond, sent);
    CHECK(sent.empty());
    frame.start = 3 * kMillisecond;
    frame.data = 'Q' - '@';
    port.deliver(frame, frame.start + 9 * frame.bit_period);
    port.advance(4 * kMillisecond, sent);
    REQUIRE(sent.size() == 1);
    CHECK(sent[0].start > 3 * kMillisecond);
}
