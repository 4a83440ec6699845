#include "view/events/event_cache.h"

#include "base/json.h"
#include "base/version/version.h"
#include "view/events/event_table.h"

#include <fmt/format.h>

#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <system_error>

namespace puckloop::view {

namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr int kCacheFormat = 3, kDecimal = 10;
constexpr std::size_t kLongestHeader = 8U << 20, kPiece = 1U << 20;
constexpr std::size_t kSumDigits = 10;  // a line of its own behind the header, so that it can be written last

struct FileCloser {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, FileCloser>;

template <class Number>
bool put(std::FILE* file, const std::vector<Number>& values) {
    return std::fwrite(values.data(), sizeof(Number), values.size(), file) == values.size();
}

template <class Number>
bool get(std::FILE* file, std::vector<Number>& values, std::size_t count) {
    values.resize(count);
    return std::fread(values.data(), sizeof(Number), count, file) == count;
}

bool put_leds(std::FILE* file, const LedEvents& leds) {
    return put(file, leds.times) && put(file, leds.robots) && put(file, leds.leds) && put(file, leds.values);
}
bool get_leds(std::FILE* file, LedEvents& leds, std::size_t count) {
    return get(file, leds.times, count) && get(file, leds.robots, count) && get(file, leds.leds, count) &&
           get(file, leds.values, count);
}
bool put_beams(std::FILE* file, const BeamEvents& beams) {
    return put(file, beams.begins) && put(file, beams.durations) && put(file, beams.senders) &&
           put(file, beams.receivers) && put(file, beams.fates);
}
bool get_beams(std::FILE* file, BeamEvents& beams, std::size_t count) {
    return get(file, beams.begins, count) && get(file, beams.durations, count) &&
           get(file, beams.senders, count) && get(file, beams.receivers, count) &&
           get(file, beams.fates, count);
}
constexpr std::size_t kLedBytes = sizeof(double) + sizeof(std::uint16_t) + 2,
                      kBeamBytes = sizeof(double) + sizeof(float) + 2 * sizeof(std::uint16_t) + 1;

/// Of all that follows the header, from where the file stands; it stands there again. Nothing: it cannot be
/// read.
std::optional<std::uint64_t> sum_of_rest(std::FILE* file) {
    const long begin = std::ftell(file);
    std::vector<unsigned char> piece(kPiece);
    uLong sum = ::crc32(0, nullptr, 0);
    for (std::size_t got = 0; (got = std::fread(piece.data(), 1, piece.size(), file)) > 0;)
        sum = ::crc32(sum, piece.data(), static_cast<uInt>(got));
    if (std::ferror(file) != 0 || std::fseek(file, begin, SEEK_SET) != 0) return std::nullopt;
    return sum;
}

/// The first line; empty: it has none of a fitting length.
std::string header_of(std::FILE* file) {
    std::string line;
    for (int c = 0; line.size() < kLongestHeader && (c = std::fgetc(file)) != EOF;) {
        if (c == '\n') return line;
        line += static_cast<char>(c);
    }
    return {};
}

bool load_from(std::FILE* file, std::uint64_t size, const std::string& sources, EventTable::Kept& kept,
               LedEvents& leds, BeamEvents& beams) {
    const std::string line = header_of(file);
    const auto header = ordered_json::parse(line, nullptr, false);
    if (!header.is_object() || header.value("format", 0) != kCacheFormat ||
        header.value("sources", "") != sources)
        return false;
    const auto events = header.at("events").get<std::uint64_t>(),
               led_count = header.at("leds").get<std::uint64_t>(),
               beam_count = header.at("beams").get<std::uint64_t>();
    kept.text_bytes = header.at("text_bytes").get<std::uint64_t>();
    // The sum of numbers that a file names may be anything: each has to fit by itself first.
    for (const std::uint64_t count : {events, led_count, beam_count, kept.text_bytes})
        if (count > size) return false;
    const std::uint64_t arrays =
        events * EventTable::Kept::kBytesOfEvent + led_count * kLedBytes + beam_count * kBeamBytes;
    if (line.size() + 1 + kSumDigits + 1 + arrays + kept.text_bytes != size) return false;
    const std::string sum = header_of(file);
    if (sum.size() != kSumDigits || sum_of_rest(file) != std::strtoull(sum.c_str(), nullptr, kDecimal))
        return false;
    kept.left_out = header.at("left_out").get<std::uint64_t>();
    leds.left_out = header.at("leds_left_out").get<std::uint64_t>();
    for (const ordered_json& track : header.at("tracks"))
        kept.names.push_back({track.at("name"), track.at("kind"), track.at("robot")});
    kept.texts_at = size - kept.text_bytes;
    const auto n = static_cast<std::size_t>(events);
    return get(file, kept.begins, n) && get(file, kept.durations, n) && get(file, kept.tracks, n) &&
           get(file, kept.flags, n) && get(file, kept.text_sizes, n) &&
           get_leds(file, leds, static_cast<std::size_t>(led_count)) &&
           get_beams(file, beams, static_cast<std::size_t>(beam_count));
}

bool save_to(std::FILE* file, const std::string& sources, const EventTable& table, const LedEvents& leds,
             const BeamEvents& beams) {
    EventTable::Kept kept = table.keep();
    ordered_json tracks = ordered_json::array();
    for (const Track& track : kept.names)
        tracks.push_back({{"name", track.name}, {"kind", track.kind}, {"robot", track.robot}});
    const ordered_json header{
        {"format", kCacheFormat},         {"sources", sources},           {"events", kept.begins.size()},
        {"text_bytes", kept.text_bytes},  {"left_out", kept.left_out},    {"leds", leds.times.size()},
        {"leds_left_out", leds.left_out}, {"beams", beams.begins.size()}, {"tracks", std::move(tracks)}};
    const std::string line = header.dump(-1, ' ', true, ordered_json::error_handler_t::replace) + "\n";
    const std::string no_sum = std::string(kSumDigits, '0') + "\n";
    bool good = std::fwrite(line.data(), 1, line.size(), file) == line.size() &&
                std::fwrite(no_sum.data(), 1, no_sum.size(), file) == no_sum.size() &&
                put(file, kept.begins) && put(file, kept.durations) && put(file, kept.tracks) &&
                put(file, kept.flags) && put(file, kept.text_sizes) && put_leds(file, leds) &&
                put_beams(file, beams);
    table.each_text([&](std::string_view text) {
        good = good && std::fwrite(text.data(), 1, text.size(), file) == text.size();
    });
    const auto behind_sum = static_cast<long>(line.size() + no_sum.size());
    if (!good || std::fflush(file) != 0 || std::fseek(file, behind_sum, SEEK_SET) != 0) return false;
    const auto sum = sum_of_rest(file);
    return sum && std::fseek(file, static_cast<long>(line.size()), SEEK_SET) == 0 &&
           std::fputs(fmt::format("{:0{}}", *sum, kSumDigits).c_str(), file) >= 0 && std::fflush(file) == 0;
}

}  // namespace

std::string event_sources(const fs::path& folder) {
    const Version& version = program_version();
    std::vector<std::string> files;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(folder, none)) {
        const std::string name = entry.path().filename().string(), ending = entry.path().extension().string();
        if (ending != ".log" && ending != ".csv" && ending != ".json") continue;
        struct stat info {};
        if (::stat(entry.path().c_str(), &info) != 0 || !S_ISREG(info.st_mode)) continue;
        files.push_back(
            fmt::format("{} {} {}.{:09}", name, info.st_size, info.st_mtim.tv_sec, info.st_mtim.tv_nsec));
    }
    std::sort(files.begin(), files.end());
    return fmt::format("{} {} {}; {}", version.number, version.commit, version.modified,
                       fmt::join(files, "; "));
}

bool load_events(const fs::path& folder, const std::string& sources, EventTable& table, LedEvents& leds,
                 BeamEvents& beams) {
    File file(std::fopen((folder / kEventCacheFile).c_str(), "rbe"));
    struct stat info {};
    if (!file || ::fstat(::fileno(file.get()), &info) != 0 || !S_ISREG(info.st_mode)) return false;
    EventTable::Kept kept;
    LedEvents found_leds;
    BeamEvents found_beams;
    try {
        if (!load_from(file.get(), static_cast<std::uint64_t>(info.st_size), sources, kept, found_leds,
                       found_beams) ||
            !table.take(std::move(kept), file.get()))
            return false;
    } catch (const std::exception&) {  // a header of another kind
        return false;
    }
    static_cast<void>(file.release());  // the table's now: it reads texts from it
    leds = std::move(found_leds);
    beams = std::move(found_beams);
    return true;
}

void save_events(const fs::path& folder, const std::string& sources, const EventTable& table,
                 const LedEvents& leds, const BeamEvents& beams) {
    const fs::path part = folder / fmt::format("{}.{}.part", kEventCacheFile, ::getpid());
    bool good = false;
    if (const File file{std::fopen(part.c_str(), "w+bxe")}) {
        try {
            good = save_to(file.get(), sources, table, leds, beams);
        } catch (const std::exception&) {
        }
    }
    std::error_code none;
    // What was read may be another's by now.
    if (good && event_sources(folder) == sources)
        fs::rename(part, folder / kEventCacheFile, none);
    else
        good = false;
    if (!good || none) fs::remove(part, none);
}

}  // namespace puckloop::view
