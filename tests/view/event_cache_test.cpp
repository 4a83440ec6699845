// Events that are kept beside a recording: the same to the page as when they were read, and never another
// run's.

#include "base/json.h"
#include "tests/view/results.h"
#include "view/events/event_cache.h"
#include "view/events/read_events.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <chrono>
#include <fstream>
#include <random>
#include <sstream>

#include <zlib.h>

using namespace puckloop::view;
using namespace puckloop::tests;
namespace fs = std::filesystem;

namespace {

constexpr std::chrono::milliseconds kAlways{-1}, kNever{1'000'000'000};

std::string bytes_of(const fs::path& file) {
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    return text.str();
}

/// A file of kept events with the sum that its bytes have now.
std::string with_its_sum(std::string bytes) {
    constexpr std::size_t kDigits = 10;
    const std::size_t sum = bytes.find('\n') + 1, rest = sum + kDigits + 1;
    const uLong now = ::crc32(0, reinterpret_cast<const Bytef*>(bytes.data() + rest),
                              static_cast<uInt>(bytes.size() - rest));
    return bytes.replace(sum, kDigits, fmt::format("{:010}", now));
}

/// All that a page gets.
std::string seen(const EventReader& events) {
    auto status = nlohmann::json::parse(events.status());
    const auto count = status["events"].get<std::size_t>();
    std::vector<std::size_t> numbers;
    for (std::size_t i = 0; i < count; ++i)
        numbers.push_back(i);
    std::string all =
        status["tracks"].dump() + events.table().block(0, count) + events.leds(0, 1000) + events.beams();
    for (const std::string& text : events.table().texts(numbers))
        all += text + "\n";
    for (const std::uint32_t number : events.table().find("e", 1000))
        all += std::to_string(number) + " ";
    return all;
}

std::string read_and_seen(const Recording& recording, std::chrono::milliseconds worth_keeping) {
    EventReader events(recording, EventTable::kMost, 0, worth_keeping);
    events.wait();
    return seen(events);
}

}  // namespace

TEST_CASE("what was kept is what was read, until a file changes") {
    const fs::path folder = write_results("view_kept"), kept = folder / kEventCacheFile;
    const Recording recording(folder);
    const std::string read = read_and_seen(recording, kNever);
    CHECK_FALSE(fs::exists(kept));
    CHECK(read_and_seen(recording, kAlways) == read);
    REQUIRE(fs::exists(kept));
    CHECK(read_and_seen(recording, kNever) == read);
    // It is what is shown: another text in the file is another text on the page.
    std::string bytes = bytes_of(kept);
    const std::size_t at = bytes.rfind("power-on, reset");
    REQUIRE(at != std::string::npos);
    bytes.replace(at, 8, "POWER-ON");
    std::ofstream(kept, std::ios::binary) << bytes;
    CHECK(read_and_seen(recording, kNever) == read);  // but not if it is damaged
    std::ofstream(kept, std::ios::binary) << with_its_sum(bytes);
    CHECK(read_and_seen(recording, kNever) != read);
    // Another file is another recording.
    std::ofstream(folder / "robot0.pic.log", std::ios::app) << "[    1.500000 s] one more\n";
    const std::string more = read_and_seen(recording, kNever);
    CHECK(more.find("one more") != std::string::npos);
    CHECK(more.find("POWER-ON") == std::string::npos);
    fs::remove_all(folder);
}

TEST_CASE("a run that goes on keeps nothing") {
    const fs::path folder = write_results("view_kept_live");
    const Recording recording(folder, true);
    read_and_seen(recording, kAlways);
    CHECK_FALSE(fs::exists(folder / kEventCacheFile));
    fs::remove_all(folder);
}

TEST_CASE("damage to what was kept is found, or is shown, and never more") {
    const fs::path folder = write_results("view_kept_damage"), kept = folder / kEventCacheFile;
    const Recording recording(folder);
    const std::string read = read_and_seen(recording, kAlways);
    const std::string whole = bytes_of(kept);
    std::mt19937 random(Catch::rngSeed());
    for (int round = 0; round < 300; ++round) {
        std::string bytes = whole;
        const std::size_t header = bytes.find('\n');
        const auto below = [&](std::size_t most) { return static_cast<std::size_t>(random() % most); };
        switch (round % 4) {
        case 0:
            bytes.resize(below(bytes.size()));
            break;
        case 1:
            bytes[below(header)] = static_cast<char>('0' + random() % 10);
            break;
        case 2:
            bytes[below(bytes.size())] = static_cast<char>(random());
            break;
        default:
            bytes.insert(below(bytes.size()), std::string(1 + below(20), static_cast<char>(random())));
        }
        std::ofstream(kept, std::ios::binary | std::ios::trunc) << bytes;
        EventReader events(recording, EventTable::kMost, 0, kNever);
        events.wait();
        const std::string shown = seen(events);
        if (bytes.size() < whole.size()) CHECK(shown == read);  // its writer was killed
    }
    fs::remove_all(folder);
}
