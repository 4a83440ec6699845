// What robots and users write to puckloop-netmanager: the input is a robot's line, and words for its
// settings.

#include "linuxboard/netmanager/message.h"
#include "linuxboard/netmanager/settings.h"
#include "tests/fuzz/target.h"

#include <cmath>

void puckloop::fuzz::run_input(Input input) {
    using namespace netmanager;
    const std::string_view text = text_of(input);
    if (const auto message = parse_message(text)) {
        require(message->to == kEverybody || (message->to >= 0 && message->to <= kMostNumber),
                "a robot's number");
        require(!message->place || (std::isfinite(message->place->x) && std::isfinite(message->place->y)),
                "a place that is one");
        require(message->data.find('\r') == std::string::npos || text.find('\r') != std::string_view::npos,
                "no end in the data that was none");
        // What is passed on is a line.
        require(line_from(3, message->data).ends_with("\r"), "a line with its end");
    }
    Settings settings;
    const std::string wrong = apply_words(text, settings);
    require(wrong.find('\n') == std::string::npos || text.find('\n') != std::string_view::npos,
            "a refusal of one line");
    require(settings.loss >= 0 && settings.loss <= 1 && settings.limits.hops >= 1, "settings in their range");
    require(!settings.limits.range || (*settings.limits.range >= 0 && *settings.limits.range <= kFarthest),
            "a range that is one");
    require(settings.hop_delay.count() >= 0, "no delay below zero");
}
