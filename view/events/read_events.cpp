#include "view/events/read_events.h"

#include "base/error.h"
#include "base/files/text_file.h"
#include "base/json.h"
#include "base/text/csv.h"
#include "traces/decoders/decode.h"
#include "traces/rab_losses/results.h"
#include "view/recording/bytes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <span>

namespace puckloop::view {

namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr double kLatest = 9e6;  // s
// Shares of the work, for the progress.
constexpr double kFirstReading = 0.4, kSecondReading = 0.9;
constexpr std::size_t kMostLogBytes = 64U << 20;  // of one log

/// "[   17.630123 s] text": the time, and where the text begins.
std::optional<std::pair<double, std::size_t>> log_time(std::string_view line) {
    const std::size_t end = line.find(" s] ");
    double time = 0.0;
    if (line.empty() || line[0] != '[' || end == std::string_view::npos ||
        !csv_number(csv_trimmed(line.substr(1, end - 1)), time))
        return std::nullopt;
    return std::pair{time, end + 4};
}

bool has_word(std::string_view text, std::initializer_list<const char*> words) {
    return std::any_of(words.begin(), words.end(),
                       [&](const char* word) { return text.find(word) != std::string_view::npos; });
}

std::string joined(const tools::DecodedFrame& frame) {
    std::string text = fmt::format("{}: {}", frame.protocol, frame.text);
    for (const std::string& error : frame.errors)
        text += "  !! " + error;
    return text;
}

// Numbers of what is lit or sounds, beside those of the ring's LEDs, body and front.
constexpr std::uint8_t kTurret = 10, kSpeaker = 19;
constexpr std::array<std::string_view, 3> kColours{"red", "green", "blue"};

/// LED of a signal's name; nothing for other signals.
std::optional<std::uint8_t> led_of(std::string_view signal) {
    if (signal == "led_body") return std::uint8_t{8};
    if (signal == "led_front") return std::uint8_t{9};
    if (signal == "speaker") return kSpeaker;
    // "rgb0_red" .. "rgb2_blue"
    if (signal.size() > 5 && signal.starts_with("rgb") && signal[3] >= '0' && signal[3] <= '2' &&
        signal[4] == '_')
        for (std::size_t colour = 0; colour < kColours.size(); ++colour)
            if (signal.substr(5) == kColours[colour])
                return static_cast<std::uint8_t>(kTurret + 3 * (signal[3] - '0') + static_cast<int>(colour));
    if (signal.size() == 4 && signal.starts_with("led") && signal[3] >= '0' && signal[3] <= '7')
        return static_cast<std::uint8_t>(signal[3] - '0');
    return std::nullopt;
}

/// What nothing on the page is made of: the coils of motors above all, most rows of a trace.
bool is_no_event(std::string_view signal) {
    return !tools::is_of_frames(signal) && !led_of(signal);
}

}  // namespace

EventReader::EventReader(const Recording& recording, std::size_t most, std::uint32_t generation,
                         std::chrono::milliseconds worth_keeping)
    : recording_(recording),
      worth_keeping_(worth_keeping),
      table_(most, generation),
      thread_([this] { run(); }) {}

EventReader::~EventReader() {
    stop_ = true;
    thread_.join();
}

void EventReader::wait() {
    while (!done_)
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    const std::lock_guard lock(mutex_);
    if (error_) std::rethrow_exception(error_);
}

void EventReader::run() noexcept {
    try {
        read_all();
    } catch (const Stopped&) {
    } catch (const std::exception& error) {
        const std::lock_guard lock(mutex_);
        trouble_ = error.what();
        error_ = std::current_exception();
    }
    done_ = true;
}

void EventReader::read_all() {
    const auto begin = [&](const char* phase, double progress) {
        check_stop();
        const std::lock_guard lock(mutex_);
        phase_ = phase;
        progress_ = progress;
    };
    using Clock = std::chrono::steady_clock;
    const auto begun = Clock::now();
    const std::string sources = recording_.live() ? std::string() : event_sources(recording_.folder());
    if (!recording_.live() && load_kept(sources)) return begin("", 1.0);
    begin("logs", 0.0);
    read_logs();
    read_resets();
    begin("trace.csv", 0.0);
    if (fs::exists(recording_.folder() / "trace.csv")) read_trace();
    begin("ir.csv", kSecondReading);
    if (fs::exists(recording_.folder() / "ir.csv") && fs::exists(recording_.folder() / "trace.csv"))
        read_rab();
    begin("ircom.csv", 1.0);
    if (fs::exists(recording_.folder() / "ircom.csv")) read_ircom();
    begin("", 1.0);
    done_ = true;
    if (!recording_.live() && Clock::now() - begun > worth_keeping_)
        save_events(recording_.folder(), sources, table_, leds_, beams_);
}

bool EventReader::load_kept(const std::string& sources) {
    LedEvents leds;
    BeamEvents beams;
    if (!load_events(recording_.folder(), sources, table_, leds, beams)) return false;
    const std::lock_guard lock(mutex_);
    leds_ = std::move(leds);
    beams_ = std::move(beams);
    return true;
}

std::string EventReader::robot_of(const std::string& name) const {
    const std::string first = name.substr(0, name.find('.'));
    const auto& all = recording_.stations();
    return std::find(all.begin(), all.end(), first) != all.end() ? first : std::string();
}

std::size_t EventReader::station(const std::string& name) const {
    const auto& all = recording_.stations();
    return static_cast<std::size_t>(std::find(all.begin(), all.end(), name) - all.begin());
}

void EventReader::read_logs() {
    std::vector<fs::path> logs;
    for (const auto& entry : fs::directory_iterator(recording_.folder()))
        // What a Linux program prints is its own, and so are the times in it.
        if (entry.path().extension() == ".log" && entry.path().stem().extension() != ".linux" &&
            entry.is_regular_file())
            logs.push_back(entry.path());
    std::sort(logs.begin(), logs.end());
    for (const fs::path& log : logs) {
        std::ifstream in(log);
        const std::string node = log.stem().string();
        std::optional<std::uint16_t> track;
        std::size_t bytes = 0;
        for (std::string line; bytes < kMostLogBytes && std::getline(in, line); bytes += line.size()) {
            check_stop();
            const auto time = log_time(line);
            if (!time) continue;
            if (!track) track = table_.track({node + " log", "log", robot_of(node)});
            const std::string_view text = std::string_view(line).substr(time->second);
            const bool wrong = has_word(text, {"trap ", "brown-out", "bus lost by", "battery low"}) &&
                               !text.starts_with("end:");
            table_.add(*track, time->first, 0.0, static_cast<std::uint8_t>(kRare | (wrong ? kFailed : 0)),
                       text);
        }
    }
}

void EventReader::read_resets() {
    const std::string text = read_whole_file(recording_.folder() / "report.json").value_or("");
    const auto report = ordered_json::parse(text, nullptr, false);
    if (!report.is_object()) return;  // Recording has noted it
    const auto nodes = report.find("nodes");
    if (nodes == report.end() || !nodes->is_object()) return;
    for (const auto& [name, node] : nodes->items())
        for (const char* what : {"resets", "traps"}) {
            if (!node.is_object()) continue;
            const auto list = node.find(what);
            if (list == node.end() || !list->is_array()) continue;
            for (const auto& one : *list) {
                const auto time = one.is_object() ? one.find("time_s") : one.end();
                if (!one.is_object() || time == one.end() || !time->is_number()) continue;
                const double at = time->get<double>();
                const bool wrong = at > 0.5 || what[0] == 't';  // the first is the power-up
                table_.add(table_.track({name + " resets", "reset", robot_of(name)}), at, 0.0,
                           static_cast<std::uint8_t>(kRare | (wrong ? kFailed : 0)),
                           fmt::format("{} {}", what[0] == 't' ? "trap" : "reset", one.dump()));
            }
        }
}

void EventReader::led(const std::string& from, const std::string& signal, double time, double value) {
    const auto led = led_of(signal);
    const bool turret = led && *led >= kTurret && *led != kSpeaker;
    if (!led || !from.ends_with(turret ? ".i2c" : ".pic")) return;
    const std::size_t robot = station(robot_of(from));
    if (robot >= recording_.robots()) return;
    if (*led == kSpeaker) return speaker(robot, time, value);
    constexpr double kBrightest = 255;
    add_led(robot, *led, time,
            turret ? static_cast<std::uint8_t>(std::clamp(value, 0.0, kBrightest))
                   : std::uint8_t{value != 0.0});
}

void EventReader::speaker(std::size_t robot, double time, double value) {
    speakers_[robot].sample(time, value == 0.0, [&](double at, bool plays) {
        add_led(robot, kSpeaker, at, std::uint8_t{plays});
    });
}

void EventReader::add_led(std::size_t robot, std::uint8_t led, double time, std::uint8_t value) {
    const std::lock_guard lock(mutex_);
    if (leds_.leds.size() >= kMostLeds) {
        ++leds_.left_out;
        return;
    }
    leds_.times.push_back(time);
    leds_.robots.push_back(static_cast<std::uint16_t>(robot));
    leds_.leds.push_back(led);
    leds_.values.push_back(value);
}

void EventReader::read_trace() {
    tools::TraceSelection all;
    all.warns = !recording_.live();
    all.passes_over = is_no_event;
    const tools::RecordedTrace trace(recording_.folder(), all);
    const double duration = std::max(recording_.duration_s(), 1e-3);
    const auto share = [&](const cosim::TraceRow& row) {
        return std::min(cosim::to_seconds(row.time) / duration, 1.0);
    };
    std::map<std::pair<std::string, std::string>, std::uint16_t> tracks;
    const auto take = [&](const tools::DecodedFrame& frame) {
        const auto key = std::pair{frame.link, frame.from};
        auto track = tracks.find(key);
        if (track == tracks.end()) {
            const std::string name = frame.from.empty() ? frame.link : frame.link + " " + frame.from;
            const std::string robot = robot_of(frame.link);
            track = tracks.emplace(key, table_.track({name, frame.protocol, robot})).first;
        }
        const bool fault = frame.protocol == "fault";
        const auto flags =
            static_cast<std::uint8_t>((frame.errors.empty() && !fault ? 0 : kFailed) | (fault ? kRare : 0));
        table_.add(track->second, cosim::to_seconds(frame.begin),
                   cosim::to_seconds(std::max<cosim::Time>(frame.end - frame.begin, 0)), flags,
                   joined(frame));
    };
    decode_trace(trace, take,
                 {[&](const cosim::TraceRow& row) {
                      check_stop();
                      progress_ = kFirstReading * share(row);
                  },
                  [&](const cosim::TraceRow& row) {
                      check_stop();
                      progress_ = kFirstReading + (kSecondReading - kFirstReading) * share(row);
                      if (const auto* signal = std::get_if<cosim::Signal>(&row.payload))
                          led(row.from, row.signal, cosim::to_seconds(row.time), signal->value);
                  }});
    for (auto& [robot, spells] : speakers_)
        spells.settle(duration, [&, robot = robot](double at, bool plays) {
            add_led(robot, kSpeaker, at, std::uint8_t{plays});
        });
}

void EventReader::read_rab() {
    const tools::RabResults results = tools::read_rab_results(recording_.folder(), 0.0, kLatest);
    std::map<std::string, std::uint16_t> tracks;
    for (const tools::Fate& fate : results.losses.fates) {
        check_stop();
        const tools::HeardFrame& frame = fate.frame;
        auto track = tracks.find(frame.receiver);
        if (track == tracks.end())
            track = tracks
                        .emplace(frame.receiver, table_.track({frame.receiver + " range and bearing", "light",
                                                               robot_of(frame.receiver)}))
                        .first;
        const double begin = cosim::to_seconds(frame.start);
        const double duration = cosim::to_seconds(frame.end - frame.start);
        // Out of reach is nobody's failure.
        const bool failed = !fate.delivered && fate.cause != tools::Cause::BelowThreshold;
        table_.add(track->second, begin, duration, failed ? kFailed : std::uint8_t{0},
                   fmt::format("from {}, {:.1f} cm: {}", frame.sender, 100 * frame.distance,
                               fate.delivered ? fmt::format("delivered, fetched at {:.6f} s",
                                                            cosim::to_seconds(fate.fetched))
                                              : fmt::format("lost: {}", name_of(fate.cause))));
        const std::size_t sender = station(frame.sender), receiver = station(frame.receiver);
        if (sender >= recording_.stations().size() || receiver >= recording_.stations().size()) continue;
        add_beam(begin, duration, sender, receiver,
                 fate.delivered ? kDelivered : static_cast<std::uint8_t>(1 + static_cast<int>(fate.cause)));
    }
}

void EventReader::add_beam(double begin, double duration, std::size_t sender, std::size_t receiver,
                           std::uint8_t fate) {
    const std::lock_guard lock(mutex_);
    beams_.begins.push_back(begin);
    beams_.durations.push_back(static_cast<float>(duration));
    beams_.senders.push_back(static_cast<std::uint16_t>(sender));
    beams_.receivers.push_back(static_cast<std::uint16_t>(receiver));
    beams_.fates.push_back(fate);
}

void EventReader::read_ircom() {
    const fs::path file = recording_.folder() / "ircom.csv";
    std::ifstream in(file);
    std::string line;
    constexpr std::size_t kCells = 9;
    std::getline(in, line);
    for (std::size_t number = 2; std::getline(in, line); ++number) {
        check_stop();
        const auto cells = csv_cells(line, ',');
        double begin = 0.0, end = 0.0;
        if (cells.size() != kCells || !csv_number(cells[0], begin) || !csv_number(cells[1], end)) {
            if (in.peek() == std::ifstream::traits_type::eof()) break;
            throw InputError(file.string(), fmt::format("line {}", number), "not a row of IRcom words",
                             "run the scenario again");
        }
        const std::string sender(cells[2]), receiver(cells[5]);
        const std::size_t from = station(sender), to = station(receiver);
        if (from >= recording_.stations().size() || to >= recording_.stations().size()) continue;
        add_beam(begin, end - begin, from, to, kIrcomWord);
        const bool wrong = cells[4] != "none";
        table_.add(table_.track({sender + " IRcom", "light", robot_of(sender)}), begin, end - begin,
                   wrong ? kFailed : std::uint8_t{0},
                   fmt::format("IRcom word {} reaches {} with {} counts{}{}", cells[3], receiver, cells[6],
                               wrong ? ", fault " : "", wrong ? cells[4] : std::string_view()));
    }
}

std::string EventReader::status() const {
    const bool done = done_;
    const EventTable::Status now = table_.status();
    ordered_json tracks = ordered_json::array();
    for (const Track& track : now.tracks)
        tracks.push_back({{"name", track.name}, {"kind", track.kind}, {"robot", track.robot}});
    const std::lock_guard lock(mutex_);
    const ordered_json json{{"generation", now.generation},
                            {"events", now.events},
                            {"left_out", now.left_out},
                            {"leds", leds_.leds.size()},
                            {"leds_left_out", leds_.left_out},
                            {"beams", beams_.fates.size()},
                            {"done", done},
                            {"progress", progress_.load()},
                            {"reading", phase_},
                            {"trouble", trouble_},
                            {"tracks", tracks}};
    return json.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

std::string EventReader::leds(std::size_t first, std::size_t most) const {
    const std::lock_guard lock(mutex_);
    first = std::min(first, leds_.leds.size());
    const std::size_t count = std::min(most, leds_.leds.size() - first);
    std::string out;
    for (const std::size_t number : {first, count, leds_.leds.size()})
        append_number(out, static_cast<std::uint32_t>(number));
    append_number(out, std::uint32_t{0});  // so that what follows begins at a multiple of eight
    append_numbers(out, std::span(leds_.times).subspan(first, count));
    append_numbers(out, std::span(leds_.robots).subspan(first, count));
    append_numbers(out, std::span(leds_.leds).subspan(first, count));
    append_numbers(out, std::span(leds_.values).subspan(first, count));
    return out;
}

std::string EventReader::beams() const {
    const std::lock_guard lock(mutex_);
    std::string out;
    append_number(out, static_cast<std::uint32_t>(beams_.fates.size()));
    append_number(out, std::uint32_t{0});
    append_numbers(out, std::span(beams_.begins));
    append_numbers(out, std::span(beams_.durations));
    append_numbers(out, std::span(beams_.senders));
    append_numbers(out, std::span(beams_.receivers));
    append_numbers(out, std::span(beams_.fates));
    return out;
}

}  // namespace puckloop::view
