// puckloop frames from the outside.
#include "tests/tools/shell.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <string>

using puckloop::tests::Ran;

namespace {

/// puckloop frames ARGUMENTS.
Ran frames(const std::string& arguments, const std::string& input = "") {
    return puckloop::tests::run_puckloop("frames " + arguments, input);
}

void expect(const Ran& result, int status, const std::string& output) {
    CHECK(result.output == output);
    CHECK(result.status == status);
}

const std::string k1234 = "1111110101100110100101011001011001010110011010";
const std::string kC3 = "111111101001010101101010100101";
const std::string k1235Wrong = "1111111001100110100101011001011001010110011010";  // payload bit 0 flipped

}  // namespace

TEST_CASE("frames rab encodes payloads from arguments and lines") {
    expect(frames("rab encode --size 16 --payload 1234"), 0, k1234 + "\n");
    expect(frames("rab encode --payload 0x1234"), 0, k1234 + "\n");
    expect(frames("rab encode --size 8", "C3\\n c3 \\r\\n"), 0, kC3 + "\n" + kC3 + "\n");
    expect(frames("rab encode --size 8 --payload C3 --json"), 0,
           R"({"size":8,"payload":"C3","ones":4,"check":12,"chips":")" + kC3 + "\"}\n");
}

TEST_CASE("frames rab decodes and checks") {
    expect(frames("rab decode " + k1234), 0, "size 16 payload 1234 ones 5 check B\n");
    expect(frames("rab decode", k1234 + "\\n" + kC3), 0,
           "size 16 payload 1234 ones 5 check B\nsize 8 payload C3 ones 4 check C\n");
    expect(frames("rab decode --json " + k1234), 0,
           R"({"ok":true,"size":16,"payload":"1234","ones":5,"check":11})"
           "\n");
    expect(frames("rab check " + k1234), 0, "ok\n");
    expect(frames("rab check --size 8 " + k1234), 1, "bad length: 46 chips, and a frame of 8 bits has 30\n");
    const std::string wrong = "bad check: B from chip 38 on, and payload 1235 needs A\n";
    expect(frames("rab decode " + k1235Wrong), 1, wrong);
    expect(frames("rab check", k1234 + "\\n" + k1235Wrong + "\\n" + kC3), 1, "ok\n" + wrong + "ok\n");
    expect(frames("rab check --json " + k1235Wrong), 1,
           R"({"ok":false,"size":16,"payload":"1235","ones":6,"check":11,"fault":"check","chip":38,)"
           R"("problem":"check: B from chip 38 on, and payload 1235 needs A"})"
           "\n");
    expect(frames("rab check --json 1111111101"), 1,
           R"({"ok":false,"fault":"manchester","chip":6,"problem":"manchester: chips 6 and 7 are equal"})"
           "\n");
}

TEST_CASE("frames rab errors prints the classification") {
    // The figures are derived in tests/protocols/rab_errors_test.cpp.
    const Ran result = frames("rab errors --size 16 --payload 1234");
    CHECK(result.status == 0);
    CHECK(result.output.starts_with("size 16 payload 1234 ones 5 check B: 46 chips\n"));
    for (const char* row : {"one chip inverted       46         6          40       0      0       0\n",
                            "two chips inverted    1035       255         760       0     20       0\n",
                            "two bits flipped       190         0           0       0    124      66\n",
                            "  missed   55: a set and a clear payload bit flip: the number of ones stays\n",
                            "  missed   11: a payload bit and the check's lowest bit flip: the sum stays\n"})
        CHECK_THAT(result.output, Catch::Contains(row));
    CHECK_THAT(frames("rab errors --payload 1234 --json").output,
               Catch::Contains(R"("missed":66,"missed_because":{"swap":55,"check_follows":11}})"));
}

TEST_CASE("frames rab refuses what cannot be a frame on one line") {
    const auto refused = [](const Ran& result, const std::string& line) {
        expect(result, 2, "puckloop: " + line + "\n");
    };
    refused(frames("rab encode --size 7 --payload 1"),
            "--size: 7 bits cannot be sent (expected 8, 16, 24 or 32)");
    refused(frames("rab decode --size x 1"),
            "--size: \"x\" is no number (expected -2147483648 to 2147483647)");
    refused(frames("rab encode --size 8 --payload 100"),
            "--payload: \"100\" is too large (expected 0 to FF, hexadecimal)");
    refused(frames("rab encode --size 32 --payload 123456789123456789123"),
            "--payload: \"123456789123456789123\" is too large (expected 0 to FFFFFFFF, hexadecimal)");
    refused(frames("rab encode", "zz\\n"),
            "standard input, line 1: payload: \"zz\" is no number (expected 0 to FFFF, hexadecimal)");
    refused(frames("rab encode --payload ''"),
            "--payload: \"\" is no number (expected 0 to FFFF, hexadecimal)");
    refused(frames("rab check ''"), "chips: nothing to read (expected a frame as 0 and 1)");
    refused(frames("rab check 1121"), "chip 2: '2' is no chip (expected 0 or 1)");
    refused(frames("rab decode", "11x1"), "standard input, line 1: chip 2: 'x' is no chip (expected 0 or 1)");
    refused(frames("rab decode", "\\n"),
            "standard input, line 1: chips: nothing to read (expected a frame as 0 and 1)");
    refused(frames("rab decode"),
            "standard input: holds no line (expected one frame per line, or an argument)");
}

TEST_CASE("frames epuck encodes actuators and names the fields of records") {
    // 500 = 01F4, -500 = FE0C, 'N' = 4E: the record of the fact sheet.
    const std::string record = "F4010CFE000005030000"
                               "4E00";
    expect(frames("epuck encode --left 500 --right -500 --ring-leds 0x05 --other-leds 3"), 0, record + "\n");
    expect(frames("epuck decode --json " + record), 0,
           R"({"record":"actuators","left":500,"right":-500,"rab_data":0,"ring_leds":5,"other_leds":3,)"
           R"("ircom_enabled":0,"ircom_data":0,"reset":78,"padding":0})"
           "\n");
    CHECK_THAT(frames("epuck decode f4 01 0c fe 00 00 05 03 00 00 52 00").output,
               Catch::Contains("right            -500\n") && Catch::Contains("reset            82\n"));
    // The range-and-bearing switch on at power 115 = 73.
    expect(frames("epuck decode --json", "73 01 0000"), 0,
           R"({"record":"configuration","rab_range":115,"rab_enabled":1,"padding":0})"
           "\n");
}

TEST_CASE("frames epuck reads a sensor record and refuses what cannot be one") {
    // Field by field: data, range, bearing 0.25, proximity, battery, acceleration, microphones, light, flags,
    // IRcom.
    const std::string front = "34120A00"
                              "0000803E"
                              "0100FEFF000000000000000000000000"
                              "0100"
                              "010002000300"
                              "0400050006000700";
    const std::string back = "D80ED80ED80ED80ED80ED80ED80ED80E"
                             "0100"
                             "0000"
                             "7700"
                             "0300"
                             "0000C03F"
                             "000020C0";
    const Ran good = frames("epuck decode --json " + front + back);
    expect(good, 0,
           R"({"record":"sensors","rab_data":4660,"rab_range":10,"rab_bearing":0.25,)"
           R"("proximity":[1,-2,0,0,0,0,0,0],"battery_ok":1,"accelerometer":[1,2,3],"microphones":[4,5,6,7],)"
           R"("light":[3800,3800,3800,3800,3800,3800,3800,3800],"rab_received":1,"ircom_received":0,)"
           R"("ircom_data":119,"padding":0,"ircom_sensor":3,"ircom_range":1.5,"ircom_bearing":-2.5,)"
           R"("plausible":true})"
           "\n");
    const std::string shifted = front.substr(2) + back + "00";
    CHECK_THAT(frames("epuck decode", front + back + "\\n" + shifted).output,
               Catch::Contains("proximity        1 -2 0 0 0 0 0 0\n") &&
                   Catch::Contains("plausible        true\n") &&
                   Catch::Contains("plausible        false\nproblem "));
}

TEST_CASE("frames epuck refuses what is no record") {
    const auto refused = [](const Ran& result, const std::string& line) {
        expect(result, 2, "puckloop: " + line + "\n");
    };
    const std::string lengths = " (expected 12 bytes (actuators), 72 (sensors) or 4 (configuration))";
    refused(frames("epuck decode 0102"), "record: 2 bytes are no record" + lengths);
    refused(frames("epuck decode", "\\n"), "standard input, line 1: record: 0 bytes are no record" + lengths);
    refused(frames("epuck decode 010g"), "byte 1: \"0g\" is no byte (expected two hexadecimal digits)");
    refused(frames("epuck decode 010"), "byte 1: \"0\" is no byte (expected two hexadecimal digits)");
    refused(frames("epuck encode --left 40000"), "--left: \"40000\" is too large (expected -32768 to 32767)");
    refused(frames("epuck encode --rab-data -1"), "--rab-data: \"-1\" is too small (expected 0 to 65535)");
    refused(frames("epuck encode --reset Q"), "--reset: \"Q\" is neither (expected N (go on) or R (end))");
}

TEST_CASE("frames xbee encodes, decodes and checks") {
    expect(frames("xbee encode 'at command NT'"), 0, "7E 00 04 08 01 4E 54 54\n");
    expect(frames("xbee encode", "modem-status status 00\\nat id 1 command ID value 01B5"), 0,
           "7E 00 02 8A 00 75\n7E 00 06 08 01 49 44 01 B5 B3\n");
    const std::string bytes = "7E 00 0F 10 01 00 7D 33 A2 00 40 8C 04 A4 FF FE 00 00 0C BC";
    const std::string text = "tx id 01 to 0013A200408C04A4 net FFFE radius 00 options 00 data 0C\n";
    expect(frames("xbee encode '" + text.substr(0, text.size() - 1) + "'"), 0, bytes + "\n");
    expect(frames("xbee decode '" + bytes + "'"), 0, text);
    expect(frames("xbee decode --json '7E 00 02 8A 00 75'"), 0,
           R"({"ok":true,"message":"modem-status","status":"00"})"
           "\n");
    expect(frames("xbee check '7E 00 02 8A 00 75 7E 00 02 8A 00 74'"), 1,
           "ok\nbad check: 74 up to byte 11, and the data needs 75\n");
    expect(frames("xbee decode --mode 1 '7E 00 02 8A 7E F7'"), 0, "modem-status status 7E\n");
}

TEST_CASE("frames xbee refuses what is no frame in one line") {
    for (const char* arguments :
         {"xbee decode 7", "xbee decode ''", "xbee encode 'nonsense'", "xbee encode 'at idd 1'",
          "xbee encode 'at id'", "xbee encode 'at id 100'", "xbee encode 'at command ABC'",
          "xbee encode 'tx to 00000000000000001'", "xbee check --mode 3 7E"}) {
        const Ran result = frames(arguments);
        CAPTURE(arguments, result.output);
        CHECK(result.status == 2);
        CHECK(result.output.starts_with("puckloop: "));
        CHECK(std::count(result.output.begin(), result.output.end(), '\n') == 1);
    }
}

TEST_CASE("frames ircom encodes, decodes and checks every word") {
    const Ran sixteen = frames("ircom encode --json 10");
    CHECK(sixteen.status == 0);
    CHECK_THAT(
        sixteen.output,
        Catch::StartsWith(R"({"word":"10","symbols":"MMMMMSMMMMSS","check":3,"edges_us":[0.0,260.0,)"));
    constexpr int kBatch = 16;  // the edges of more are too long for a command line
    for (const char* timing : {"nominal", "epuck", "tam"})
        for (int first = 0; first < 256; first += kBatch) {
            std::string words, checked, decoded;
            for (int word = first; word < first + kBatch; ++word) {
                words += fmt::format("{:02x}\\n", word);
                checked += "ok\n";
                decoded += fmt::format("word {:02X} check {}\n", word,
                                       (4 - std::popcount(static_cast<unsigned>(word)) % 4) % 4);
            }
            const Ran encoded = frames(fmt::format("ircom encode --timing {}", timing), words);
            REQUIRE(encoded.status == 0);
            std::string lines = encoded.output;
            for (std::size_t at = 0; (at = lines.find('\n', at)) != std::string::npos; at += 2)
                lines.replace(at, 1, "\\n");
            expect(frames("ircom check", lines), 0, checked);
            expect(frames("ircom decode", lines), 0, decoded);
        }
    const Ran bad = frames("ircom decode --json '0 260 520'");
    CHECK(bad.status == 1);
    CHECK_THAT(bad.output, Catch::Contains(R"("ok":false)") && Catch::Contains(R"("fault":"short")"));
}

TEST_CASE("frames ircom refuses what is no word in one line") {
    for (const char* arguments :
         {"ircom encode 100", "ircom encode G", "ircom encode --timing robot 1", "ircom decode ''",
          "ircom decode '0 1 x'", "ircom decode '0 0'", "ircom check '5 nan'", "ircom check '1e300'"}) {
        const Ran result = frames(arguments);
        CAPTURE(arguments, result.output);
        CHECK(result.status == 2);
        CHECK(result.output.starts_with("puckloop: "));
        CHECK(std::count(result.output.begin(), result.output.end(), '\n') == 1);
    }
}
