#include "run/expectations/judge_frames.h"

#include "traces/decoders/decode.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string>

namespace puckloop::tools {

namespace {

using scenarios::Expectation;

/// What was seen for one expectation.
struct Count {
    std::size_t index = 0;
    std::int64_t frames = 0;  ///< of the protocol, from the sender, in the time
    std::int64_t fitting = 0;
    double at = 0.0;     ///< s: the last one that was needed
    std::string last{};  ///< the last frame, for people
};

bool has_all(const DecodedFrame& frame, const Expectation& expected) {
    return std::all_of(expected.has.begin(), expected.has.end(), [&](const auto& wanted) {
        const auto field = frame.fields.find(wanted.first);
        if (field == frame.fields.end()) return false;
        return std::visit([&](const auto& value) { return *field == nlohmann::ordered_json(value); },
                          wanted.second);
    });
}

void look_at(const DecodedFrame& frame, const Expectation& expected, Count& count) {
    const double end = cosim::to_seconds(frame.end);
    if (frame.protocol != expected.subject || end < expected.after || end > expected.by) return;
    if (!expected.from.empty() && frame.from != expected.from) return;
    ++count.frames;
    count.last = to_text(frame);
    if (!has_all(frame, expected)) return;
    if (count.last.find(expected.text) == std::string::npos) return;
    if (++count.fitting == expected.at_least) count.at = end;
}

}  // namespace

void judge_frames(const std::filesystem::path& out, const std::vector<Expectation>& all,
                  std::vector<ExpectationResult>& results) {
    std::vector<Count> counts;
    for (std::size_t i = 0; i < all.size(); ++i)
        if (all[i].kind == Expectation::Kind::Frame) counts.push_back({.index = i});
    if (counts.empty()) return;
    TraceSelection selection;
    selection.warns = false;
    decode_trace(RecordedTrace(out, selection), [&](const DecodedFrame& frame) {
        for (Count& count : counts)
            look_at(frame, all[count.index], count);
    });
    for (const Count& count : counts) {
        const Expectation& expected = all[count.index];
        ExpectationResult& result = results[count.index];
        const bool seen = count.fitting >= expected.at_least;
        result.met = seen == expected.seen;
        if (seen) result.at = count.at;
        if (seen)
            result.why = fmt::format("{} at {:.6f} s, {} in all",
                                     expected.at_least == 1 ? "the first" : "the last that was needed",
                                     count.at, count.fitting);
        else if (count.frames == 0)
            result.why = fmt::format("no {} frame came", expected.subject);
        else
            result.why =
                fmt::format("{} of {} frames fit, the last was {}", count.fitting, count.frames, count.last);
    }
}

}  // namespace puckloop::tools
