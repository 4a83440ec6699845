#include "ends/scripts.h"

#include "base/error.h"
#include "base/random.h"
#include "emu/pic/signals.h"
#include "ends/uart_spec.h"

#include <catch2/catch.hpp>

#include <string>

using namespace puckloop;
using namespace puckloop::exec;
using Catch::Contains;
using namespace std::string_view_literals;

namespace {

template <typename Parse>
std::string error_of(Parse parse) {
    try {
        parse();
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

std::string uart_error(std::string_view text) {
    return error_of([&] { parse_uart_script("u.txt", text); });
}
std::string i2c_error(std::string_view text) {
    return error_of([&] { parse_i2c_script("i.txt", text); });
}
std::string stimulus_error(std::string_view text) {
    return error_of([&] { parse_stimulus("s.txt", text, pic::signals()); });
}

}  // namespace

TEST_CASE("a UART script: times, bytes with and without spaces, comments, any order") {
    const auto script =
        parse_uart_script("u.txt", "# wake up\n2.5 01\n\n 0.25\tF4010cfe 00 # frame\r\n2.5 02");
    REQUIRE(script.size() == 3);
    CHECK(script[0].time == cosim::kSecond / 4);
    CHECK(script[0].bytes == std::vector<std::uint8_t>{0xF4, 0x01, 0x0C, 0xFE, 0x00});
    CHECK(script[1].bytes == std::vector<std::uint8_t>{1});
    CHECK(script[2].bytes == std::vector<std::uint8_t>{2});
    CHECK(parse_uart_script("u.txt", "").empty());
}

TEST_CASE("a UART script's mistakes name file, line and what was expected") {
    CHECK(uart_error("1 00\n2") == "u.txt: line 2: too short (expected <time_s> <hex bytes>)");
    CHECK(uart_error("x 00") == "u.txt: line 1: 'x' is not a time in seconds (expected a number)");
    CHECK_THAT(uart_error("-1 00"), Contains("out of range"));
    CHECK_THAT(uart_error("nan 00"), Contains("not a time"));
    CHECK_THAT(uart_error("1e300 00"), Contains("out of range"));
    CHECK_THAT(uart_error("\n\n1 0g"), Contains("line 3") && Contains("'0g' is not hexadecimal bytes"));
    CHECK_THAT(uart_error("1 012"), Contains("two digits a byte"));
    CHECK_THAT(uart_error("1 \x01\x02\n"), Contains("'\?\?'"));
}

TEST_CASE("an I2C master's script: writes and reads") {
    const auto script = parse_i2c_script("i.txt", "0.1 w 0x20 0E 55\n0.2 r 0X20 0 1\n0.3 r 0x20 0x15 256\n");
    REQUIRE(script.size() == 3);
    CHECK_FALSE(script[0].read);
    CHECK(script[0].address == 0x20);
    CHECK(script[0].bytes == std::vector<std::uint8_t>{0x0E, 0x55});
    CHECK(script[1].read);
    CHECK(script[1].address == 0x20);
    CHECK(script[1].count == 1);
    CHECK(script[2].register_number == 0x15);
    CHECK(script[2].count == 256);
}

TEST_CASE("an I2C master's script: ten-bit addresses and raw steps") {
    using Kind = I2cRawStep::Kind;
    const auto script = parse_i2c_script(
        "i.txt", "1 r ten:0x2A5 - 2\n0 w ten:0x5 0e\n2 raw s3e w0f/3 s3F r n w80 p s00 w01 p\n");
    REQUIRE(script.size() == 3);
    CHECK((script[0].ten_bits && script[0].address == 0x005 && script[0].raw.empty()));
    CHECK((script[1].ten_bits && script[1].address == 0x2A5 && script[1].read));
    const std::vector<I2cRawStep>& raw = script[2].raw;
    REQUIRE(raw.size() == 10);
    CHECK((raw[0].kind == Kind::Start && raw[0].byte == 0x3E && raw[0].clocks == 9));
    CHECK((raw[1].kind == Kind::Write && raw[1].byte == 0x0F && raw[1].clocks == 3));
    CHECK((raw[2].kind == Kind::Start && raw[2].byte == 0x3F));
    CHECK((raw[3].kind == Kind::Read && raw[3].acknowledge));
    CHECK((raw[4].kind == Kind::Read && !raw[4].acknowledge));
    CHECK((raw[6].kind == Kind::Stop && raw[7].kind == Kind::Start && raw[7].byte == 0));
}

TEST_CASE("an I2C script's mistakes") {
    CHECK_THAT(i2c_error("0 w ten:0x400 00"), Contains("10-bit address 0x400 is out of range"));
    CHECK_THAT(i2c_error("0 w ten:2a5 00"), Contains("'2a5' is not a 10-bit address"));
    CHECK_THAT(i2c_error("0 raw"), Contains("too short"));
    for (const char* word :
         {"x", "s", "s3", "s3g", "s3e0", "w", "r1", "p/3", "r/0", "r/8", "r/", "/3", "s3e/33"})
        CHECK_THAT(i2c_error(std::string("0 raw s3e ") + word + " p"),
                   Contains("line 1: '") && Contains("is no step of a master"));
    CHECK_THAT(i2c_error("0 raw w3e p"), Contains("a master begins with a START"));
    CHECK_THAT(i2c_error("0 raw s3e w00"), Contains("keeps the bus for good"));
    CHECK_THAT(i2c_error("0 raw s3e/4 w00 p"), Contains("broken off is followed by another"));
    CHECK_THAT(i2c_error("0 raw s3e p r p"), Contains("a byte without a START"));
    CHECK_THAT(i2c_error("0 w 0x20"), Contains("line 1: too short"));
    CHECK_THAT(i2c_error("0 x 0x20 00"), Contains("neither a write nor a read"));
    CHECK_THAT(i2c_error("0 w 0x80 00"),
               Contains("7-bit address 0x80 is out of range (expected 0 to 127 (0x7f))"));
    CHECK_THAT(i2c_error("0 w 0x99999999999 00"), Contains("out of range"));
    // A bare 20 was read as decimal, 0x14.
    CHECK(i2c_error("0 w 0x20 00\n0 r 20 0 1") ==
          "i.txt: line 2: '20' is not a 7-bit address (expected hexadecimal after 0x, such as 0x20)");
    CHECK_THAT(i2c_error("0 w 3c 00"), Contains("line 1: '3c' is not a 7-bit address"));
    CHECK_THAT(i2c_error("0 w \x01 00"), Contains("'?' is not a 7-bit address"));
    CHECK_THAT(i2c_error("0 w 0xzz 00"), Contains("is not a 7-bit address"));
    CHECK_THAT(i2c_error("0 r 0x20 0"), Contains("wrong number of words") || Contains("too short"));
    CHECK_THAT(i2c_error("0 r 0x20 0 0"), Contains("count 0"));
    CHECK_THAT(i2c_error("0 r 0x20 0 257"), Contains("out of range"));
    CHECK_THAT(i2c_error("0 r 0x20 0 1 1"), Contains("wrong number of words"));
}

TEST_CASE("a stimulus file: signals by name, values in range") {
    const auto script = parse_stimulus("s.txt", "1 proximity0 500.5\n0 battery_low 1\n", pic::signals());
    REQUIRE(script.size() == 2);
    CHECK(script[0].signal == pic::kBatteryLow);
    CHECK(script[1].signal == pic::kProximity);
    CHECK(script[1].value == 500.5);
    CHECK(stimulus_error("0 proximty0 1") ==
          "s.txt: line 1: no signal 'proximty0' (expected one of --list-signals; did you mean proximity0?)");
    CHECK(stimulus_error("0 nonsense 1") ==
          "s.txt: line 1: no signal 'nonsense' (expected one of --list-signals)");
    CHECK_THAT(stimulus_error("0 led0 1"), Contains("'led0' is an output of the board"));
    CHECK_THAT(stimulus_error("0 selector 16"), Contains("selector 16 is out of range (expected 0 to 15)"));
    CHECK_THAT(stimulus_error("0 selector"), Contains("wrong number of words"));
    CHECK(stimulus_error("0 battery_low 0.5") ==
          "s.txt: line 1: battery_low is a level, not 0.5 (expected 0 or 1)");
    CHECK_THAT(stimulus_error("0 adc0 inf"), Contains("not a adc0") || Contains("number"));
}

TEST_CASE("the ends of a UART as options") {
    CHECK(parse_uart_spec("--uart1", "-").kind == UartSpec::Kind::Stdio);
    CHECK(parse_uart_spec("--uart1", "pty").kind == UartSpec::Kind::Pty);
    CHECK(parse_uart_spec("--uart1", "tcp:4000").port == 4000);
    CHECK(parse_uart_spec("--uart1", "script:a:b").file == "a:b");
    for (const char* bad :
         {"", "tcp", "tcp:", "tcp:x", "tcp:65536", "tcp:-1", "tcp:1 ", "script:", "file", "--"})
        CHECK_THROWS_AS(parse_uart_spec("--uart2", bad), InputError);
    CHECK(error_of([] { parse_uart_spec("--uart2", "tty"); }) ==
          "--uart2: 'tty' is not an end for a UART (expected -, pty, tcp:PORT or script:FILE)");
}

TEST_CASE("random and damaged script files give an InputError of one line or a list, nothing else") {
    RandomStream random(7, "script fuzz");
    const std::string seeds[] = {"0.5 01 02 03\n1 ff\n", "0.1 w 0x20 0E 55\n0.2 r 0x20 0 1\n",
                                 "0 adc8 3800\n1 selector 4 # x\n"};
    constexpr std::string_view kAlphabet = "0123456789abcdefxwr.-+e# \t\n\r_proximity\0\xff"sv;
    int errors = 0;
    for (int i = 0; i < 6000; ++i) {
        std::string text = i % 4 == 3 ? std::string() : seeds[i % 3];
        const std::uint64_t edits = 1 + random.below(i % 4 == 3 ? 60 : 6);
        for (std::uint64_t e = 0; e < edits; ++e) {
            const char c = kAlphabet[random.below(kAlphabet.size())];
            const std::size_t at = random.below(text.size() + 1);
            if (at < text.size() && random.below(3) == 0)
                text.erase(at, 1 + random.below(4));
            else if (at < text.size() && random.below(2) == 0)
                text[at] = c;
            else
                text.insert(at, 1, c);
        }
        for (const std::string& error : {uart_error(text), i2c_error(text), stimulus_error(text)}) {
            if (error == "no error") continue;
            ++errors;
            REQUIRE(error.find('\n') == std::string::npos);
            REQUIRE(error.find(".txt: line ") == 1);
        }
    }
    CHECK(errors > 6000);
}
