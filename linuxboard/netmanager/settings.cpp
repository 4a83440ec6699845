#include "linuxboard/netmanager/settings.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <vector>

namespace puckloop::netmanager {

namespace {

std::vector<std::string_view> words_in(std::string_view line) {
    std::vector<std::string_view> words;
    constexpr std::string_view kSpace = " \t\r\n";
    for (std::size_t begin = line.find_first_not_of(kSpace); begin != std::string_view::npos;) {
        const std::size_t end = std::min(line.find_first_of(kSpace, begin), line.size());
        words.push_back(line.substr(begin, end - begin));
        begin = line.find_first_not_of(kSpace, end);
    }
    return words;
}

template <typename T>
std::optional<T> number_in(std::string_view word, T low, T high) {
    T value{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || !(value >= low && value <= high))
        return std::nullopt;
    return value;
}

std::string wrong(std::string_view word, const char* expected) {
    return "'" + std::string(word.substr(0, 40)) + "' (expected " + expected + ")";
}

std::string set_loss(const std::vector<std::string_view>& words, Settings& settings) {
    const auto share = number_in(words[1], 0.0, 1.0);
    if (!share) return wrong(words[1], "a chance from 0 to 1");
    if (words.size() == 2) {
        settings.loss = *share;
        return {};
    }
    const auto from = number_in(words[2], 0, kMostNumber);
    const auto to = words.size() == 4 ? number_in(words[3], 0, kMostNumber) : std::nullopt;
    if (!from || !to) return wrong(words.back(), "numbers of two robots");
    settings.loss_of_link[{*from, *to}] = *share;
    return {};
}

}  // namespace

std::string apply_words(std::string_view line, Settings& settings) {
    const std::vector<std::string_view> words = words_in(line);
    constexpr const char* kKnown = "range M, hops N, delay S, loss P [FROM TO] or show";
    if (words.empty()) return wrong("", kKnown);
    const std::string_view what = words[0];
    if (what == "show" && words.size() == 1) return {};
    const bool of_link = what == "loss" && words.size() > 2 && words.size() <= 4;
    if (words.size() != 2 && !of_link) return wrong(line, kKnown);
    if (what == "loss") return set_loss(words, settings);
    if (what == "range") {
        const auto range = number_in(words[1], 0.0, kFarthest);
        if (!range && words[1] != "none") return wrong(words[1], "metres, or none");
        settings.limits.range = range;
        return {};
    }
    if (what == "hops") {
        const auto hops = number_in(words[1], 1, kMostNumber);
        if (!hops) return wrong(words[1], "1 to 9998 hops");
        settings.limits.hops = *hops;
        return {};
    }
    if (what == "delay") {
        const auto delay = number_in(words[1], 0.0, kLongestDelay);
        if (!delay) return wrong(words[1], "0 to 60 seconds");
        settings.hop_delay = std::chrono::microseconds(std::llround(*delay * 1e6));
        return {};
    }
    return wrong(what, kKnown);
}

}  // namespace puckloop::netmanager
