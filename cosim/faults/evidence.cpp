#include "cosim/faults/evidence.h"

#include <algorithm>
#include <tuple>

namespace puckloop::cosim {

void Evidence::fire(Firing firing, Time known) {
    ++fired_;
    late_.push_back({firing.time, known});
    while (late_.front().known < known - kMemory) {
        last_ = std::max(last_, late_.front().time);
        late_.pop_front();
    }
    if (kept_.size() < kMostKept) kept_.push_back({std::move(firing), known});
}

void Evidence::foresee(Firing firing, Time known) {
    foreseen_.push_back({std::move(firing), known});
}

std::uint64_t Evidence::fired(Time end) const {
    const auto beyond =
        std::count_if(late_.begin(), late_.end(), [end](const Late& one) { return one.known >= end; });
    const auto foreseen =
        std::count_if(foreseen_.begin(), foreseen_.end(), [end](const Kept& one) { return one.known < end; });
    return fired_ - static_cast<std::uint64_t>(beyond) + static_cast<std::uint64_t>(foreseen);
}

std::vector<Firing> Evidence::firings(Time end) const {
    std::vector<Firing> firings;
    for (const auto* list : {&foreseen_, &kept_})
        for (const Kept& one : *list)
            if (one.known < end) firings.push_back(one.firing);
    return firings;
}

std::optional<Time> Evidence::last(Time end) const {
    if (fired(end) == 0) return std::nullopt;
    Time last = last_;
    for (const Late& one : late_)
        if (one.known < end) last = std::max(last, one.time);
    for (const Kept& one : foreseen_)
        if (one.known < end) last = std::max(last, one.firing.time);
    return last;
}

FaultReport report_of(const FaultSpec& spec) {
    FaultReport report{spec.name, describe(spec), spec.kind, spec.link.empty() ? spec.node : spec.link};
    report.may_not_fire = spec.may_not_fire;
    return report;
}

void FaultReport::add(const Evidence& evidence, Time end) {
    add(evidence.fired(end), evidence.last(end), evidence.firings(end));
}

void FaultReport::add(std::uint64_t more, std::optional<Time> newest, std::vector<Firing> others) {
    fired += more;
    if (newest) last = std::max(last.value_or(*newest), *newest);
    firings.insert(firings.end(), others.begin(), others.end());
    const auto key = [](const Firing& one) { return std::tie(one.time, one.from, one.index); };
    std::stable_sort(firings.begin(), firings.end(),
                     [&](const Firing& a, const Firing& b) { return key(a) < key(b); });
    if (firings.size() > Evidence::kMostKept) firings.resize(Evidence::kMostKept);
}

}  // namespace puckloop::cosim
