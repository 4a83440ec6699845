#include "gap/verdict/sentences.h"

#include "gap/kinds/columns.h"
#include "gap/stats/profile.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace puckloop::gap {

namespace {

constexpr std::size_t kMostListed = 10;  // values that fit as well, in words

std::string listed(const std::vector<std::string>& words, const char* last) {
    std::string text;
    for (std::size_t i = 0; i < words.size(); ++i)
        text += (i == 0 ? "" : i + 1 == words.size() ? fmt::format(" {} ", last) : ", ") + words[i];
    return text;
}

/// "; 25 ms, 50 ms and 29 other single values between fit as well"
std::string others_words(const FittedParameter& p) {
    std::vector<std::string> words;
    // The largest first: of a period's parts there are many.
    for (auto one = p.as_likely.rbegin(); one != p.as_likely.rend() && words.size() < kMostListed; ++one)
        words.push_back(quantity(*one, p.unit));
    if (words.empty()) return "";
    if (p.as_likely.size() > words.size())
        words.push_back(fmt::format("{} more single values", p.as_likely.size() - words.size()));
    return fmt::format("; {} fit{} as well", listed(words, "and"), p.as_likely.size() == 1 ? "s" : "");
}

/// "motion.turn" -> "turn"; of what the world has no place for the observable's own name.
std::string extended_words(const Extended& one) {
    const std::string name = plain_observable(one.observable);
    std::string text = fmt::format("the error of {} from {} to {}", name, quantity(one.named, one.unit),
                                   quantity(one.extended, one.unit, 0, one.named));
    if (!one.formula.empty())
        text += fmt::format(" (nearly {} = {}, in SI units)", one.quantity.empty() ? name : one.quantity,
                            one.formula);
    return text;
}

/// What would tell rivals apart.
std::string advice_sentence(const std::vector<Suggestion>& suggestions) {
    if (suggestions.empty()) return "None of the experiments that were looked at would.";
    const Suggestion& best = suggestions.front();
    if (best.bits >= kLeastBits) return fmt::format("This experiment would: {}.", best.what);
    return fmt::format("None of the experiments that were looked at would; the catalogue's advice is: {}.",
                       best.what);
}

/// What would measure what these data cannot.
std::string identify_sentence(const std::vector<Suggestion>& suggestions) {
    if (suggestions.empty()) return "No experiment was found that would identify it.";
    std::vector<std::string> whats;
    for (const Suggestion& one : suggestions)
        whats.push_back(one.what);
    return fmt::format("This would identify it: {}.", fmt::join(whats, "; "));
}

}  // namespace

std::string cause_sentence(const Cause& cause) {
    std::string text = cause.title;
    if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
    std::vector<std::string> figures;
    for (const FittedParameter& p : cause.parameters) {
        const double largest = std::max({std::abs(p.value), std::abs(p.low), std::abs(p.high)});
        const auto shown = [&](double value, int digits) { return quantity(value, p.unit, digits, largest); };
        const int more = stats::more_digits(p.low, (p.low + p.high) / 2, p.high, shown);
        figures.push_back(fmt::format("{} = {} ({} to {}{})", p.name, shown(p.value, more),
                                      shown(p.low, more), shown(p.high, more), others_words(p)));
    }
    if (!figures.empty()) text += ": " + listed(figures, "and");
    text += ".";
    if (!cause.form.empty()) text += fmt::format(" ({}.)", cause.form);
    return text;
}

std::string form_words(const FormVerdict& form) {
    if (!form.better.empty())
        return fmt::format("this family, another form: {} fits better by {:.3g} nats", form.better,
                           form.left);
    if (form.open.empty()) return "";
    return fmt::format("this family, form not distinguished from: {}", fmt::join(form.open, ", "));
}

std::string plain_remark(std::string remark) {
    for (std::size_t at = 0; (at = remark.find('|', at)) != std::string::npos;)
        remark.replace(at, 1, " or ");
    return remark;
}

std::string gain_sentence(const Held& held) {
    if (held.runs == 0) return "Nothing was held out.";
    const std::string error =
        fmt::format("held-out error {:.0f} % of what it was (90 % interval {:.0f} to {:.0f} %)",
                    100 * held.ratio, 100 * held.low, 100 * held.high);
    const std::string score = fmt::format("log score {:+.3g} a row, better in {} of {} blocks",
                                          held.score_after - held.score_before, held.runs_better, held.runs);
    if (!held.gain && held.score_after == held.score_before)
        return "No gain is claimed: nothing was added to the simulator.";
    if (!held.gain) return fmt::format("No gain is claimed: {}, {}.", error, score);
    if (held.error_may_stay())
        return fmt::format("Gain on data that was not fitted: what readings are likely is predicted "
                           "better, {} (90 % interval {:+.3g} to {:+.3g}); errors are not "
                           "smaller for sure: {}.",
                           score, held.score_low, held.score_high, error);
    return fmt::format("Gain on data that was not fitted: {}, {}.", error, score);
}

std::string summary_of(const Verdict& verdict) {
    std::vector<std::string> titles, names_of;
    for (const Cause& cause : verdict.causes) {
        titles.push_back(cause.title);
        if (verdict.decision != Decision::Named) continue;
        for (const Rival& rival : verdict.rivals)
            if (rival.instead_of == cause.name)
                titles.back() +=
                    fmt::format(" (or {}: a small part, and the data cannot tell)", rival.cause.title);
    }
    switch (verdict.decision) {
    case Decision::NoEffect:
        return "No effect found: what differs from the simulation is not more than the noise. " +
               verdict.heldout.sentence;
    case Decision::Named:
        return fmt::format("The simulation is wrong because {}. {}", listed(titles, "and"),
                           verdict.heldout.sentence);
    case Decision::CannotTell: {
        std::vector<std::string> sure, names;
        for (const Cause& cause : verdict.causes) {
            const bool open = std::any_of(verdict.rivals.begin(), verdict.rivals.end(),
                                          [&](const Rival& rival) { return rival.instead_of == cause.name; });
            (open ? names : sure).push_back(cause.title);
        }
        for (const Rival& rival : verdict.rivals)
            names.push_back(rival.cause.title);
        const std::string known =
            sure.empty() ? "" : fmt::format("The simulation is wrong because {}. ", listed(sure, "and"));
        return fmt::format("{}Cannot tell whether {}. {} {}", known, listed(names, "or"),
                           advice_sentence(verdict.suggestions), verdict.heldout.sentence);
    }
    case Decision::NotIdentifiable: {
        for (const Cause& cause : verdict.nearest)
            names_of.push_back(cause.title);
        return fmt::format("What differs cannot be put down to a cause by these data. What comes nearest is "
                           "that {}, but {}. {}",
                           listed(names_of, "and"), verdict.doubt, identify_sentence(verdict.suggestions));
    }
    case Decision::Unexplained:
        break;
    }
    std::string text = "Structure remains that nothing in the catalogue explains";
    if (const auto form = std::find_if(verdict.free_forms.begin(), verdict.free_forms.end(),
                                       [](const FreeForm& one) { return one.clear; });
        form != verdict.free_forms.end())
        text += fmt::format(": {}: {}", plain_observable(form->observable), form->shape);
    else if (!verdict.leftovers.empty())
        text += fmt::format(": {} {}", plain_observable(verdict.leftovers.front().observable),
                            verdict.leftovers.front().shape);
    text += ".";
    titles.clear();
    for (const Cause& cause : verdict.nearest)
        titles.push_back(cause.title);
    if (!titles.empty())
        text += fmt::format(" What comes nearest, but {}: {}.", verdict.doubt, listed(titles, "and"));
    return text;
}

std::string extension_sentence(const Extension& extension) {
    if (!extension.not_asked.empty()) return {};
    std::vector<std::string> lowered, outside;
    for (const Extended& one : extension.observables)
        if (one.kept) (one.quantity.empty() ? outside : lowered).push_back(extended_words(one));
    const std::string where =
        extension.by_runs ? "runs that had no part in it" : "stretches of runs that had no part in it";
    if (lowered.empty() && outside.empty())
        return fmt::format(
            "A term without a mechanism, learnt from what remains, gains nothing for sure on {}: "
            "none is written.",
            where);
    std::string text;
    if (!lowered.empty())
        text =
            fmt::format("A term without a mechanism, learnt from what remains, lowers on {} {}; it is in the "
                        "overlay.",
                        where, listed(lowered, "and"));
    if (!outside.empty())
        text += fmt::format("{}Such a term lowers on {} {}, but it is not written: a run has no "
                            "place for it, or it rests on what nobody measured.",
                            text.empty() ? "" : " ", where, listed(outside, "and"));
    return text;
}

}  // namespace puckloop::gap
