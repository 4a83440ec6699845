#include "selftest/grammar/curves.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace puckloop::gap::selftest::grammar {

namespace {

constexpr std::array kClasses{Class::Unknown, Class::NearMiss, Class::Known, Class::Null};

template <class Where>
Curve counted(Curve bands, const std::vector<Outcome>& cases, Class of, const Where& where) {
    for (Band& band : bands)
        for (const Outcome& one : cases) {
            const double at = where(one);
            const bool inside = band.low < band.high ? at >= band.low && at < band.high : at == band.low;
            if (one.of != of || !inside) continue;
            ++band.count[static_cast<std::size_t>(said_of(one))];
            ++band.of;
            band.right += rightly(one) ? 1 : 0;
        }
    return bands;
}

Curve bands_between(const std::array<double, 5>& ends) {
    Curve bands;
    for (std::size_t b = 0; b + 1 < ends.size(); ++b)
        bands.push_back({ends[b], ends[b + 1]});
    return bands;
}

/// 0 of what is too weak to be asked for.
double runs_of(const Outcome& one) {
    return one.of == Class::Null || one.ratio >= 1 ? static_cast<double>(one.runs) : 0.0;
}

std::string table(const Curve& bands, Class of) {
    std::string text;
    for (const Band& band : bands) {
        if (band.of == 0) continue;
        text += fmt::format("  {:<10}{:>4g}{:<9}{:>4}", class_name(of), band.low,
                            band.low < band.high ? fmt::format(" to {:g}", band.high) : "", band.of);
        for (const int count : band.count) {
            const Rate rate = rate_of(count, band.of);
            text += fmt::format("{:>5.0f} ({:>2.0f}..{:>3.0f})", 100 * rate.share(), 100 * rate.low,
                                100 * rate.high);
        }
        text += "\n";
    }
    return text;
}

std::string heading(const char* by) {
    std::string text = fmt::format("\n% of what was said, by {}\n  {:<10}{:<13}{:>4}", by, "", "", "of");
    for (std::size_t s = 0; s < kSaid; ++s)
        text += fmt::format("{:>14}", said_name(static_cast<Said>(s)));
    return text + "\n";
}

/// Named first of all, band by band.
std::string by_effect(const std::vector<Outcome>& cases) {
    std::map<std::string, std::vector<Outcome>> effects;
    for (const Outcome& one : cases)
        if (one.of == Class::Known) effects[one.kind + " " + one.effect].push_back(one);
    if (effects.empty()) return {};
    std::string text = fmt::format("\nknown effects named first, by strength\n  {:<44}", "");
    for (std::size_t b = 0; b + 1 < kStrengths.size(); ++b)
        text += fmt::format("{:>12}", fmt::format("{:g} to {:g}", kStrengths[b], kStrengths[b + 1]));
    text += "\n";
    for (const auto& [effect, own] : effects) {
        text += fmt::format("  {:<44}", effect);
        for (const Band& band : by_strength(own, Class::Known))
            text += fmt::format("{:>12}", band.of == 0 ? "-" : fmt::format("{} of {}", band.right, band.of));
        text += "\n";
    }
    return text;
}

}  // namespace

const char* said_name(Said said) {
    constexpr const char* names[] = {"right name",  "other name", "unexplained",
                                     "cannot tell", "no effect",  "failed"};
    return names[static_cast<int>(said)];
}

Said said_of(const Outcome& one) {
    if (one.said == "named") {
        const bool right =
            one.of == Class::Known ? one.right : one.of == Class::NearMiss && !one.wrong_family;
        return right ? Said::RightName : Said::OtherName;
    }
    if (one.said == "unexplained" || one.said == "not_identifiable") return Said::Unexplained;
    if (one.said == "cannot_tell") return Said::CannotTell;
    return one.said == "no_effect" ? Said::NoEffect : Said::Failed;
}

bool rightly(const Outcome& one) {
    const Said said = said_of(one);
    const bool open = said == Said::Unexplained || said == Said::CannotTell;
    switch (one.of) {
    case Class::Null:
        return said == Said::NoEffect;
    case Class::Known:
        return said == Said::RightName;
    case Class::NearMiss:
        return open || said == Said::RightName;
    case Class::NoisyInput:
        return open || said == Said::NoEffect;
    default:
        return open;
    }
}

Curve by_strength(const std::vector<Outcome>& cases, Class of) {
    return counted(bands_between(kStrengths), cases, of, [](const Outcome& one) { return one.ratio; });
}

Curve by_runs(const std::vector<Outcome>& cases, Class of) {
    return counted(bands_between(kRuns), cases, of, runs_of);
}

Curve power(const std::vector<Outcome>& cases, Class of) {
    Curve numbers;
    for (const std::size_t runs : kPowerRuns)
        numbers.push_back({static_cast<double>(runs), static_cast<double>(runs)});
    return counted(std::move(numbers), cases, of,
                   [](const Outcome& one) { return static_cast<double>(one.runs); });
}

std::string power_text(const std::vector<Outcome>& cases, const std::string& seeds) {
    std::string text =
        fmt::format("{} analyses of drawn cases with some of their runs, seed {}; 95 % binomial "
                    "intervals\n\nrightly called\n  {:<10}",
                    cases.size(), seeds, "");
    for (const std::size_t runs : kPowerRuns)
        text += fmt::format("{:>26}", fmt::format("{} runs", runs));
    text += "\n";
    for (const Class of : kClasses) {
        const Curve bands = power(cases, of);
        if (std::all_of(bands.begin(), bands.end(), [](const Band& band) { return band.of == 0; })) continue;
        text += fmt::format("  {:<10}", class_name(of));
        for (const Band& band : bands) {
            const Rate rate = rate_of(band.right, band.of);
            text +=
                fmt::format("{:>26}", fmt::format("{:.0f} % ({:.0f}..{:.0f}, {} of {})", 100 * rate.share(),
                                                  100 * rate.low, 100 * rate.high, rate.hits, rate.of));
        }
        text += "\n";
    }
    text += heading("number of runs (right name: the effect, of a near miss its family)");
    for (const Class of : kClasses)
        text += table(power(cases, of), of);
    return text;
}

std::string curves_text(const std::vector<Outcome>& cases) {
    std::string text = heading("strength over noise (right name: the effect, of a near miss its family)");
    for (const Class of : kClasses)
        if (of != Class::Null) text += table(by_strength(cases, of), of);
    text += heading("number of runs, strength 1 and above");
    for (const Class of : kClasses)
        text += table(by_runs(cases, of), of);
    return text + by_effect(cases);
}

}  // namespace puckloop::gap::selftest::grammar
