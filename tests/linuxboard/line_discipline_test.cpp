// termios(3) between the wire and read().

#include "linuxboard/shim/devices/line_discipline.h"
#include "linuxboard/shim/devices/tty_settings.h"

#include <catch2/catch.hpp>

#include <cstring>
#include <string_view>

using namespace puckloop::linuxboard;
using puckloop::protocols::ReceivedCharacter;

namespace {
termios raw() {
    termios settings = initial_termios();
    cfmakeraw(&settings);
    return settings;
}

std::string feed(LineDiscipline& line, std::string_view bytes, const termios& settings) {
    std::string echo;
    for (const char byte : bytes) {
        ReceivedCharacter character;
        character.data = static_cast<unsigned char>(byte);
        echo += line.receive(character, settings).echo;
    }
    return echo;
}

std::string damaged(const termios& settings, bool framing, bool parity, bool is_break = false) {
    LineDiscipline line;
    ReceivedCharacter character;
    character.data = is_break ? 0 : 'x';
    character.framing_error = framing || is_break;
    character.parity_error = parity;
    character.is_break = is_break;
    line.receive(character, settings);
    return line.take(16, settings);
}
}  // namespace

TEST_CASE("raw mode passes every byte") {
    LineDiscipline line;
    std::string all;
    for (int byte = 0; byte < 256; ++byte)
        all += static_cast<char>(byte);
    CHECK(feed(line, all, raw()).empty());
    CHECK(line.take(512, raw()) == all);
}

TEST_CASE("canonical mode gives whole lines, edited") {
    const termios settings = initial_termios();
    LineDiscipline line;
    CHECK(feed(line,
               "ab\x7f"
               "c\rrest",
               settings) == "ab\b \bc\r\nrest");
    CHECK(line.readable(settings) == 3);
    CHECK(line.take(100, settings) == "ac\n");
    CHECK(line.readable(settings) == 0);
    feed(line, "\x04", settings);  // end of file gives what is there without a newline
    CHECK(line.take(100, settings) == "rest");
    feed(line, "\x04", settings);
    CHECK(line.has_line());
    CHECK(line.take(100, settings).empty());
}

TEST_CASE("damaged characters by IGNPAR, PARMRK, INPCK") {
    termios settings = raw();
    CHECK(damaged(settings, true, false) == "x");
    CHECK(damaged(settings, false, true) == "x");  // not asked to check parity
    settings.c_iflag |= INPCK;
    CHECK(damaged(settings, false, true) == std::string(1, '\0'));
    settings.c_iflag |= PARMRK;
    CHECK(damaged(settings, true, false) == std::string("\377\0x", 3));
    CHECK(damaged(settings, false, false, true) == std::string("\377\0\0", 3));
    LineDiscipline line;
    feed(line, "\377", settings);
    CHECK(line.take(4, settings) == "\377\377");
    settings.c_iflag |= IGNPAR;
    CHECK(damaged(settings, true, false).empty());
    settings.c_iflag |= IGNBRK;
    CHECK(damaged(settings, false, false, true).empty());
}

TEST_CASE("XON and XOFF act on output and are not read") {
    termios settings = raw();
    settings.c_iflag |= IXON;
    LineDiscipline line;
    ReceivedCharacter character;
    character.data = 'S' - '@';
    CHECK(line.receive(character, settings).stop_output);
    character.data = 'Q' - '@';
    CHECK(line.receive(character, settings).start_output);
    CHECK(line.readable(settings) == 0);
}

TEST_CASE("a full buffer drops what comes and counts it") {
    LineDiscipline line;
    feed(line, std::string(LineDiscipline::kBufferSize + 10, 'x'), raw());
    CHECK(line.readable(raw()) == LineDiscipline::kBufferSize);
    CHECK(line.dropped() == 10);
}
