// One file with page and data.

#include "base/error.h"
#include "tests/view/results.h"
#include "view/export_page.h"
#include "view/page_parts.h"

#include <catch2/catch.hpp>

#include <zlib.h>

using namespace puckloop;
using namespace puckloop::tests;
using namespace puckloop::view;

namespace {

std::string unpacked(const std::string& packed, std::size_t size) {
    z_stream stream{};
    REQUIRE(inflateInit2(&stream, 15 + 16) == Z_OK);
    std::string out(size, '\0'), in = packed;
    stream.next_in = reinterpret_cast<Bytef*>(in.data());
    stream.avail_in = static_cast<uInt>(in.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    CHECK(inflate(&stream, Z_FINISH) == Z_STREAM_END);
    out.resize(size - stream.avail_out);
    inflateEnd(&stream);
    return out;
}

}  // namespace

TEST_CASE("base 64 is that of RFC 4648") {
    const std::pair<const char*, const char*> vectors[] = {{"", ""},
                                                           {"f", "Zg=="},
                                                           {"fo", "Zm8="},
                                                           {"foo", "Zm9v"},
                                                           {"foob", "Zm9vYg=="},
                                                           {"fooba", "Zm9vYmE="},
                                                           {"foobar", "Zm9vYmFy"}};
    for (const auto& [bytes, text] : vectors)
        CHECK(base64(bytes) == text);
    CHECK(base64(std::string("\xff\x00\xfe", 3)) == "/wD+");
}

TEST_CASE("what is compressed comes back") {
    std::string text;
    for (int i = 0; i < 300'000; ++i)
        text += static_cast<char>((i * i) >> 3);
    CHECK(unpacked(compressed(text), text.size() + 10) == text);
    CHECK(unpacked(compressed(""), 10).empty());
}

TEST_CASE("the exported file has everything in it and asks for nothing") {
    const Recording recording(write_results("view_export"));
    EventReader events(recording);
    const std::string page = exported_page(recording, events);
    for (const char* part : {"data-head", "data-poses", "data-status", "data-beams", "data-leds",
                             "data-events", "data-texts", "data-sensors-0", "class ArenaView", "--failed"}) {
        INFO(part);
        CHECK(page.find(part) != std::string::npos);
    }
    for (const char* part : {"src=\"page.js\"", "href=\"page.css\"", "https://", "data-sensors-1"}) {
        INFO(part);
        CHECK(page.find(part) == std::string::npos);
    }
    EventReader again(recording);
    CHECK(exported_page(recording, again) == page);
}

TEST_CASE("a page that would be too large is refused with the remedy") {
    const Recording recording(write_results("view_large"));
    EventReader events(recording);
    try {
        exported_page(recording, events, 100);
        FAIL("it was made");
    } catch (const RunError& error) {
        CHECK(std::string(error.what()).find("without --export") != std::string::npos);
    }
}
