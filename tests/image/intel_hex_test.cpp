#include "emu/image/intel_hex.h"
#include "tests/image/expect_error.h"

#include <catch2/catch.hpp>

using namespace puckloop::image;
using puckloop::image::testing::error_of;

namespace {

const std::string kEnd = ":00000001FF\n";

std::string hex_error(const std::string& text) {
    return error_of([&] { parse_intel_hex(text, "x.hex"); });
}

}  // namespace

TEST_CASE("Records join into segments, whatever their order, case and line ends") {
    const auto segments =
        parse_intel_hex(":020002000304F5\r\n:02000000abCD86\n\n:0200000400FFFB \n:0110000011DE\n"
                        ":04000005000001A056\n:020000021000EC\n:0100000022DD\n:00000001FF",
                        "x.hex");
    REQUIRE(segments.size() == 3);
    CHECK(segments[0].address == 0);
    CHECK(segments[0].bytes == std::vector<std::uint8_t>{0xAB, 0xCD, 3, 4});
    CHECK(segments[1].address == 0x10000);
    CHECK(segments[2].address == 0xFF1000);
}

TEST_CASE("Damaged HEX names file, line, problem and what was expected") {
    CHECK(hex_error(":0100000011EF\n" + kEnd) == "x.hex: line 1: checksum 0xEF is wrong (expected 0xEE)");
    CHECK(hex_error(":01000000G1EE\n") == "x.hex: line 1: 'G' in column 10 (expected a hexadecimal digit)");
    CHECK(hex_error(":010000001\n") == "x.hex: line 1: an odd number of digits (expected two a byte)");
    CHECK(hex_error("\n:0100\n") ==
          "x.hex: line 2: a record of 2 bytes (expected at least 5: the line is cut short)");
    CHECK(hex_error(":0200000011ED\n") ==
          "x.hex: line 1: 1 data bytes where the record states 2 (expected both to agree)");
    CHECK(hex_error(":0100000011EE\n") ==
          "x.hex: line 1: the file ends without an end-of-file record (expected :00000001FF as last line)");
    CHECK(hex_error(kEnd + ":0100000011EE\n") ==
          "x.hex: line 2: a record after the end-of-file record (expected the file to end there)");
    CHECK(hex_error(":0100000011EE\n:0100000011EE\n" + kEnd) ==
          "x.hex: line 2: data at byte address 0x0 was already given by line 1 (expected each address once)");
    CHECK(hex_error("hello\n") == "x.hex: line 1: the line begins with 'h' (expected ':')");
    CHECK(hex_error(":00000006FA\n") == "x.hex: line 1: record type 06 (expected 00 to 05)");
    CHECK(hex_error(":0100000400FB\n") ==
          "x.hex: line 1: a record of type 04 with 1 data bytes (expected 2)");
    CHECK(hex_error(":020000020000FC\n:02FFFF001122CD\n") ==
          "x.hex: line 2: a data record runs past the end of its 64 KB segment (expected a further segment "
          "record)");
}

TEST_CASE("What the writer writes, the reader reads back") {
    std::vector<ByteSegment> segments(3);
    segments[0].address = 5;
    segments[0].bytes.assign(40, 0x5A);
    segments[1].address = 0xFFF8;  // across a bank
    for (int i = 0; i < 300; ++i)
        segments[1].bytes.push_back(static_cast<std::uint8_t>(i));
    segments[2].address = 0x1F00000;
    segments[2].bytes = {1, 2, 3, 0};
    const auto read = parse_intel_hex(write_intel_hex(segments), "x.hex");
    REQUIRE(read.size() == 3);
    for (std::size_t i = 0; i < 3; ++i) {
        CHECK(read[i].address == segments[i].address);
        CHECK(read[i].bytes == segments[i].bytes);
    }
}
